"""Places in the program text, and what could stand there instead.

Alternatives are made where the program text is examined, and put in place where the program runs; they cross
the process border as plain data.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import field, replace

from mutabot.frozen import frozen
from mutabot.model.mutant import Extent, Role, Site, Span

#: the name by which instrumented program text finds its switches; in a template, ``RUNTIME[0]`` is the helper
RUNTIME = "__mutabot__"


#: indexes of the controls: the original goes on as it is; the place raises
IDENTITY, FATAL = -1, -2


#: kinds of values that fit what an alternative needs
_FITTING: Mapping[str, frozenset[str]] = {
    "number": frozenset({"number", "integer"}),
    "integer": frozenset({"integer"}),
    "truth": frozenset({"truth"}),
    "bits": frozenset({"integer", "truth", "set", "flag"}),
}


def fits_kinds(need: str, kinds: Iterable[str]) -> bool:
    """Return whether a value of one of these kinds fits what an alternative needs."""
    return not _FITTING.get(need, frozenset()).isdisjoint(kinds)


@frozen
class Alternative:
    """Another expression or statement in the place of the original.

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

    @staticmethod
    def kept_name(index: int) -> str:
        """Return the name in a template that is replaced by a part of the original: ``TextPlace.kept``."""
        return f"__kept_{index}__"

    def fits(self, kinds: Iterable[str]) -> bool:
        """Return whether it takes a value of one of these kinds, which the original had."""
        return fits_kinds(self.needs, kinds) if self.needs else True


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
        """The extent of the place in its file."""
        span = self.span
        return (span.line, span.column, span.end_line, span.end_column)

    @property
    def site(self) -> Site:
        """The place as a site."""
        return Site(self.span, self.text, self.occurrence, Role.PROGRAM)


@frozen
class ProgramText:
    """A program file and its places.

    Attributes:
        file: path relative to the project's root, with forward slashes.
        digest: of the file's bytes: other text has other places.
        places: the places, in the order of the text.
        declared: names that a function declares ``global`` or ``nonlocal``, by function: they must not be
            mentioned there before, so they cannot stand for another variable.
    """

    file: str
    digest: str
    places: tuple[TextPlace, ...] = ()
    declared: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @classmethod
    def of(
        cls, file: str, content: bytes, places: Iterable[TextPlace], declared: Mapping[str, tuple[str, ...]]
    ) -> ProgramText:
        """Return the text of a file with this content."""
        from mutabot.model.source_units import digest  # noqa: PLC0415  # slow, and only planning needs it

        return cls(file, digest(content), tuple(places), declared)


@frozen
class Instrumentation:
    """What is put into the program while it is imported.

    Attributes:
        texts: the files and the places in them; fewer places cost less.
        record: whether to note the kinds of values instead of offering alternatives.
    """

    texts: tuple[ProgramText, ...]
    record: bool = False

    def only(self, places: Collection[int]) -> Instrumentation:
        """Return a copy with these places only, given by number."""
        texts = (
            replace(text, places=tuple(place for place in text.places if place.number in places))
            for text in self.texts
        )
        return replace(self, texts=tuple(text for text in texts if text.places))


@frozen
class Sighting:
    """What the baseline observed at a place.

    Attributes:
        place: number of the place.
        hits: evaluations that were looked at; no more than a few per test.
        kinds: kinds of the values it had, sorted: ``number``, ``integer``, ``truth``, ``text`` … or
            ``module:Type``; there may be more once each alternative has had one that fits.
        variables: for a variable: others in scope that had the same type each time, sorted.
    """

    place: int
    hits: int
    kinds: tuple[str, ...] = ()
    variables: tuple[str, ...] = ()

    def with_others(self, other: Sighting) -> Sighting:
        """Return the merged observations of two sessions: all kinds, and the variables that both have."""
        kinds = tuple(sorted({*self.kinds, *other.kinds}))
        variables = tuple(name for name in self.variables if name in other.variables)
        return Sighting(self.place, self.hits + other.hits, kinds, variables)
