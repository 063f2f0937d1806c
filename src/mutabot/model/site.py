"""Sites: where in the source a call stands."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Role(StrEnum):
    """Whose call it is. The two are never mixed in one score."""

    PROGRAM = "program"
    ORACLE = "oracle"


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """The exact place of an expression, as the interpreter reports it.

    Attributes:
        file: path relative to the project's root, with forward slashes.
        line, end_line: 1-based; 0 for what does not stand in the program text, such as a parameter.
        column, end_column: 0-based, in UTF-8 bytes, as in ``ast`` and ``code.co_positions()``.
        function: qualified name of the enclosing code object (``<module>`` at the top level).
    """

    file: str
    line: int
    column: int
    end_line: int
    end_column: int
    function: str

    @property
    def place(self) -> str:
        """``file:line``; what stands in no line is told by its file alone."""
        return f"{self.file}:{self.line}" if self.line else self.file


@dataclass(frozen=True, slots=True, order=True)
class Site:
    """Where a fault acts: mostly a call expression in the source.

    Attributes:
        span: its exact place.
        text: the callee as written, such as ``arm.translate``.
        occurrence: 1-based number among the expressions with this text in this function.
        role: whose call it is.
    """

    span: Span
    text: str
    occurrence: int
    role: Role

    @classmethod
    def of_parameter(cls, owner: str, name: str) -> Site:
        """A parameter, which stands nowhere in the program text: ``of_parameter("world", "gravity")``."""
        return cls(Span(owner, 0, 0, 0, 0, ""), name, 1, Role.PROGRAM)

    @property
    def id(self) -> str:
        """The part of a mutant's id that names the site; stable under edits elsewhere."""
        if not self.span.line:
            return f"{self.span.file}:{self.text}"
        return f"{self.span.file}:{self.span.function}:{self.text}#{self.occurrence}"

    @property
    def place(self) -> str:
        """``file:line:column`` with the 1-based column that editors show."""
        if not self.span.line:
            return f"{self.span.file}:{self.text}"
        return f"{self.span.file}:{self.span.line}:{self.span.column + 1}"
