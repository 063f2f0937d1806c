"""Where mutants can act: a site with its operation and text command, or a place in the program text."""

from __future__ import annotations

from dataclasses import dataclass

from mutabot.model import Mutant, Site


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """Where and what a mutant can act on: a site, an operation, a text command.

    A place in the program text has no operation.
    """

    site: Site
    operation: str
    pattern: str | None = None

    @classmethod
    def of(cls, mutant: Mutant) -> Place:
        """Where a mutant of the first order acts."""
        return cls(mutant.site, mutant.operation, mutant.pattern)

    @property
    def is_text(self) -> bool:
        """Whether it is a place in the program text."""
        return not self.operation

    @property
    def key(self) -> str:
        """The same place in words, equal between processes."""
        span = self.site.span
        columns = f"{span.line}:{span.column}-{span.end_line}:{span.end_column}"
        return f"{span.file}:{columns} {self.operation} {self.pattern or ''}".rstrip()
