"""Mutants: a fault at a site, and when it acts.

Without a moment a mutant acts at each call of its site. In a control loop no robot has such a fault: a policy
that is wrong at 300 of 300 steps is noticed by every test.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import field, replace
from enum import StrEnum
from typing import Any

from mutabot.errors import shortened
from mutabot.families import CALLS
from mutabot.frozen import frozen
from mutabot.model.notation import Notation


class When(StrEnum):
    """The kinds of moments, by the keywords that select them."""

    #: at the n-th call of a test alone
    NTH = "nth"
    #: at the n-th call of a test and all after it
    FROM = "from"
    #: at one call of a test, drawn anew for each round
    ONCE = "once"
    #: at the calls that begin in a window of the test's simulated time
    BETWEEN = "between"


#: the word for no moment
EVERY = "every"
_NUMBER = r"\d{1,9}(?:\.\d{0,9})?"
_FORMS: Mapping[When, re.Pattern[str]] = {
    When.NTH: re.compile(r"(?P<first>[1-9]\d{0,8})"),
    When.FROM: re.compile(r"from (?P<first>[1-9]\d{0,8})"),
    When.ONCE: re.compile(r"once"),
    When.BETWEEN: re.compile(rf"(?P<first>{_NUMBER}) ?s? ?(?:-|–|to) ?(?P<last>{_NUMBER}) ?s"),
}
#: how each is written, and how it stands in a sentence about what the mutant does
_TEXTS: Mapping[When, tuple[str, str]] = {
    When.NTH: ("{first:g}", "at call {first:g} only"),
    When.FROM: ("from {first:g}", "from call {first:g} on"),
    When.ONCE: ("once", "at one call, drawn for each round"),
    When.BETWEEN: ("{first:g}-{last:g} s", "from {first:g} to {last:g} s of simulated time"),
}


@frozen
class Moment:
    """The calls at which a mutant acts.

    Attributes:
        when: the kind of moment.
        first: the number of the call, from 1; or where the window begins, s after the test's first tick.
        last: where the window ends, s, that moment excluded; 0 for other kinds.
        calls: for a drawn call, how many calls the site has in the baseline, by round and test
            (``"0 tests/test_a.py::test"``).
    """

    when: When
    first: float = 0.0
    last: float = 0.0
    calls: Mapping[str, int] = field(default_factory=dict)

    @classmethod
    def parse(cls, text: str) -> Moment:
        """Parse a moment as a configuration writes it: ``3``, ``from 10``, ``once``, ``2-2.5 s``.

        Raises ValueError, which says what would be right.
        """
        for when, form in _FORMS.items():
            found = form.fullmatch(text.strip())
            if found is None:
                continue
            numbers = found.groupdict()
            moment = cls(when, float(numbers.get("first") or 0), float(numbers.get("last") or 0))
            if when is When.BETWEEN and not moment.first < moment.last:
                raise ValueError(f"{text!r} ends before it begins")
            return moment
        raise ValueError(
            f'{shortened(text)!r} is not a moment; write "every", the number of a call ("3"), "from 3", '
            '"once", or a window of simulated time ("2-2.5 s")'
        )

    @classmethod
    def parse_any(cls, text: str) -> Moment | None:
        """Parse a moment; None means every call."""
        return None if text.strip() == EVERY else cls.parse(text)

    @property
    def text(self) -> str:
        """The moment as configuration and command line write it."""
        return _TEXTS[self.when][0].format(first=self.first, last=self.last)

    @property
    def phrase(self) -> str:
        """The moment as part of a sentence about what the mutant does."""
        return _TEXTS[self.when][1].format(first=self.first, last=self.last)

    @property
    def asks_time(self) -> bool:
        """Whether the moment needs a clock."""
        return self.when is When.BETWEEN

    def drawn(self, round: int, test: str, seed: int) -> Moment:
        """Return the moment for a test, with a random call drawn from ``seed`` alone.

        A test in which the baseline made no such call has none.
        """
        if self.when is not When.ONCE:
            return self
        from random import Random  # noqa: PLC0415  # most processes below the tests draw nothing

        calls = self.calls.get(f"{round} {test}", 0)
        return replace(self, first=float(Random(seed).randint(1, calls)) if calls else 0.0)

    def holds(self, call: int, time: float | None) -> bool:
        """Return whether the mutant acts at the ``call``-th call of its site, at ``time`` (s, if known)."""
        if self.when is When.BETWEEN:
            return time is not None and self.first <= time < self.last
        return call >= self.first if self.when is When.FROM else call == self.first


class Role(StrEnum):
    """Whether a call belongs to the program or to the oracle; no score mixes the two."""

    PROGRAM = "program"
    ORACLE = "oracle"


#: first line (1-based), first column, last line, last column (0-based, in UTF-8 bytes), as in ``ast``
Extent = tuple[int, int, int, int]


@frozen(refuses=True, order=True)
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
        """``file:line``, or the file alone if there is no line."""
        return f"{self.file}:{self.line}" if self.line else self.file


@frozen(refuses=True, order=True)
class Site:
    """Where a fault acts: usually a call expression in the source.

    Attributes:
        span: its exact place.
        text: the callee as written, such as ``arm.translate``; or a name of its own.
        occurrence: 1-based number among the expressions with this text in this function; 0 if the text is a
            name that the file has once.
        role: whose call it is.
        other_spans: the other places of a fault that stands in several, such as further hunks of a patch.
    """

    span: Span
    text: str
    occurrence: int
    role: Role
    other_spans: tuple[Span, ...] = ()

    @classmethod
    def of_parameter(cls, owner: str, name: str) -> Site:
        """Return the site of a parameter, outside the program text: ``of_parameter("world", "gravity")``."""
        return cls(Span(owner, 0, 0, 0, 0, ""), name, 0, Role.PROGRAM)

    @classmethod
    def of_patch(cls, name: str, hunks: Iterable[tuple[str, Extent]]) -> Site:
        """Return the site of a fault in several places, in one file or in several, which may be data files.

        Args:
            name: of the patch, which the first of its files has once.
            hunks: the file and the extent of each, as ``in_program`` takes them; of a hunk that only adds
                lines, the extent of the line before it.

        Raises ValueError if there is no hunk.
        """
        spans = [Span(file, *extent, "") for file, extent in hunks]
        if not spans:
            raise ValueError(f"the patch {name!r} changes no place: give the file and extent of each hunk")
        return cls(spans[0], name, 0, Role.PROGRAM, tuple(spans[1:]))

    @classmethod
    def in_program(cls, file: str, extent: Extent, function: str, text: str, occurrence: int = 1) -> Site:
        """Return the site of an expression, a statement or a line of the program.

        Args:
            file: path relative to the project's root, with forward slashes.
            extent: first line (1-based), first column, last line, last column (0-based, in UTF-8 bytes).
            function: qualified name of the function it stands in; ``<module>`` at the top level.
            text: how it reads, shortened.
            occurrence: 1-based number among those with this text in this function.
        """
        return cls(Span(file, *extent, function), text, occurrence, Role.PROGRAM)

    @property
    def is_in_file(self) -> bool:
        """Whether the site is in a file; parameters are not."""
        return self.span.line > 0

    @property
    def spans(self) -> tuple[Span, ...]:
        """All places of the site."""
        return (self.span, *self.other_spans)

    @property
    def id(self) -> str:
        """The part of a mutant's id that names the site; stable under edits elsewhere."""
        if not self.occurrence:
            return f"{self.span.file}:{self.text}"
        return f"{self.span.file}:{self.span.function}:{self.text}#{self.occurrence}"

    @property
    def place(self) -> str:
        """``file:line:column`` with the 1-based column that editors show."""
        if not self.is_in_file:
            return f"{self.span.file}:{self.text}"
        return f"{self.span.file}:{self.span.line}:{self.span.column + 1}"


@frozen
class Mutant:
    """One planted fault.

    Attributes:
        number: 1, 2, 3 … in the order of the plan.
        family: the family of its operator (``mutabot.families``).
        operator: name of the operator.
        site: where it acts.
        operation: target of the operation whose calls it acts on; empty if it acts on none.
        pattern: notation of the text command it acts on; None where that does not apply.
        quantity: name of the quantity it changes; None if it concerns the call as a whole.
        variant: which of several mutants of the same operator here; empty if there is only one.
        description: one line that an engineer recognises.
        idle: for operators that ask, what the operation answers while the robot does nothing: a plain value,
            or the data of ``model.job.Idle``.
        magnitude: how big its fault is, in ``unit``; None for a fault without a size.
        unit: the unit of the magnitude; None where it has none.
        has_sizes: whether the same fault is planted in several magnitudes, of which a threshold is sought.
        direction: which way a fault with sizes goes: ``+``, ``-``, or empty if it goes one way only.
        moment: at which of its calls it acts; None for all of them.
        provider: name of the provider that made it (``mutabot.faults``).
        by_number: whether any other number is a change, also one that means the same to a robot.
    """

    number: int
    family: str
    operator: str
    site: Site
    operation: str
    pattern: str | None
    quantity: str | None
    variant: str
    description: str
    idle: Any = None
    magnitude: float | None = None
    unit: str | None = None
    direction: str = ""
    moment: Moment | None = None
    has_sizes: bool = False
    provider: str = CALLS
    by_number: bool = False

    @property
    def id(self) -> str:
        """Stable under edits elsewhere: file, function, text, occurrence, quantity, operator."""
        subject = "/".join(part for part in (self.pattern_name, self.quantity) if part) or "call"
        variant = f"={self.variant}" if self.variant else ""
        if self.moment is not None:
            variant += f"@{self.moment.text}"
        if not self.operation:
            return f"{self.site.id}:{self.operator}{variant}"
        return f"{self.site.id}:{subject}:{self.operator}{variant}"

    @property
    def ladder(self) -> str:
        """ID shared by all magnitudes of a graded fault; empty for other faults."""
        if not self.has_sizes:
            return ""
        return replace(self, variant=self.direction).id

    @property
    def pattern_name(self) -> str:
        """The pattern without format specifications; empty if there is none."""
        return Notation.compile(self.pattern).short if self.pattern is not None else ""


@frozen
class Place:
    """Where and what a mutant can act on.

    Attributes:
        site: where.
        operation: the operation that is called there; empty where the place is none of a call.
        pattern: the text command.
    """

    site: Site
    operation: str
    pattern: str | None = None

    @classmethod
    def of(cls, mutant: Mutant) -> Place:
        """Return the place at which a mutant acts."""
        return cls(mutant.site, mutant.operation, mutant.pattern)

    @property
    def key(self) -> str:
        """A text that is equal for equal places in all processes."""
        span = self.site.span
        columns = f"{span.line}:{span.column}-{span.end_line}:{span.end_column}"
        return f"{span.file}:{columns} {self.operation} {self.pattern or ''}".rstrip()
