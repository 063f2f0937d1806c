"""Alternatives: what a place in the program text could read instead.

Made outside, where the program text is looked at; put in place inside, where the program runs. Plain data
that crosses the process border as JSON.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from mutabot.frozen import frozen

from .mutant import Role, Site, Span

#: first line (1-based), first column, last line, last column (0-based, in UTF-8 bytes), as in ``ast``
Extent = tuple[int, int, int, int]

#: the name by which instrumented program text finds its switches; in a template, ``RUNTIME[0]`` is the helper
RUNTIME = "__mutabot__"


#: indexes of the controls: the original goes on as it is; the place raises
IDENTITY, FATAL = -1, -2
#: stands for a mutant that is more than one alternative
AT_ONCE = -3


def kept_name(index: int) -> str:
    """The name that stands in a template for a kept part of the original."""
    return f"__kept_{index}__"


@frozen
class Alternative:
    """One other reading of a place.

    Attributes:
        operator: name of the operator that makes it.
        variant: which of the operator's alternatives here; empty if there is only one.
        template: Python text of it, in which ``__kept_0__`` … stand for parts of the original that are kept.
        text: how the place would read in the program text.
        needs: kind of value that it takes: ``number``, ``integer``, ``truth``, ``bits``; empty for any.
        family: the family of its operator.
        raises: whether a statement raises whatever happens, so that the original never follows it.

    Example: ``Alternative("AOR", "sub", "__kept_0__ - __kept_1__", "x - y", needs="number")``.
    """

    operator: str
    variant: str
    template: str
    text: str
    needs: str = ""
    family: str = ""
    raises: bool = False


@frozen
class TextPlace:
    """An expression or statement of the program text with its alternatives.

    Attributes:
        number: 1, 2, 3 … over all files of a plan; how the running program names it.
        span: its exact place.
        text: how it reads, shortened.
        occurrence: 1-based number among the places with this text in this function.
        node: class of its node in ``ast``.
        statement: whether it is a statement rather than an expression.
        kept: extents of the parts of the original that templates keep, by their number there.
        alternatives: what it could read instead.
        variable: whether it is a variable that another of the same type could stand for.
        at_import: whether it is evaluated while its module is imported.
    """

    number: int
    span: Span
    text: str
    occurrence: int
    node: str
    statement: bool = False
    kept: tuple[Extent, ...] = ()
    alternatives: tuple[Alternative, ...] = ()
    variable: bool = False
    at_import: bool = False

    @property
    def extent(self) -> Extent:
        """Where it stands in its file."""
        span = self.span
        return (span.line, span.column, span.end_line, span.end_column)

    @property
    def site(self) -> Site:
        """The place as a site."""
        return Site(self.span, self.text, self.occurrence, Role.PROGRAM)


@frozen
class ProgramText:
    """A program file and the places in it.

    Attributes:
        file: path relative to the project's root, with forward slashes.
        digest: SHA-256 of the file's bytes, in hexadecimal digits: other text has other places.
        places: the places, in the order of the text.
        declared: names that a function declares ``global`` or ``nonlocal``, by function: they must not be
            mentioned there before, so they cannot stand for another variable.
    """

    file: str
    digest: str
    places: tuple[TextPlace, ...] = ()
    declared: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, order=True)
class Choice:
    """One alternative at one place.

    Attributes:
        place: number of the place.
        index: 0-based index of the alternative there; ``IDENTITY`` and ``FATAL`` are possible everywhere.
    """

    place: int
    index: int


@frozen
class Instrumentation:
    """What to put into the program while it is imported.

    Attributes:
        texts: the files and the places in them; fewer places cost less.
        record: whether to note the kinds of values instead of offering alternatives.
        active: alternatives in force from the start; none for the original.
    """

    texts: tuple[ProgramText, ...]
    record: bool = False
    active: tuple[Choice, ...] = ()

    def only(self, active: tuple[Choice, ...]) -> Instrumentation:
        """These alternatives in force, and no places but theirs."""
        places = {choice.place for choice in active}
        texts = (
            replace(text, places=tuple(place for place in text.places if place.number in places))
            for text in self.texts
        )
        return Instrumentation(tuple(text for text in texts if text.places), active=active)


@frozen
class Sighting:
    """What the baseline saw at a place.

    Attributes:
        place: number of the place.
        hits: evaluations that were looked at; no more than a few per test.
        kinds: kinds of the values it had, sorted: ``number``, ``integer``, ``truth``, ``text`` … or
            ``module:Type``.
        variables: for a variable: others in scope that had the same type each time, sorted.
    """

    place: int
    hits: int
    kinds: tuple[str, ...] = ()
    variables: tuple[str, ...] = ()
