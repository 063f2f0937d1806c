"""A user's decisions about mutants: to accept a survivor, or to exclude a mutant.

A decision names one mutant by its id, or some by file, operator and text of the line. The line is compared as
well where an id is given: ids count equal calls of a function, so another one before it moves them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field
from enum import StrEnum
from typing import TYPE_CHECKING

from mutabot.frozen import frozen

from .mutant_pattern import is_like

if TYPE_CHECKING:
    from .mutant import Mutant, Span

#: returns the lines of a file; none if it is not known
LinesOf = Callable[[str], Sequence[str]]


class Action(StrEnum):
    """What is done with the mutants."""

    ACCEPT = "accept"
    EXCLUDE = "exclude"


@frozen
class Suppression:
    """A decision. A mutant has to match all given fields.

    Attributes:
        action: what becomes of the mutants.
        why: the reason.
        source: where it is written, ``file:line``.
        id: the id of a mutant; empty for any.
        file: path of a program file, in which ``*`` and ``?`` are wild; empty for any.
        operator: name of an operator, likewise.
        line: text of one of the lines that a place of the mutant takes, without blanks around it, likewise.
        numbers: first and last line that a place of the mutant has to meet; None for any.
        date: when it was made, as ``2026-01-31``; empty if it is not said.
        in_source: whether it is a comment in the program.
    """

    action: Action
    why: str
    source: str
    id: str = ""
    file: str = ""
    operator: str = ""
    line: str = ""
    numbers: tuple[int, int] | None = None
    date: str = ""
    in_source: bool = False

    def fits(self, mutant: Mutant, lines: LinesOf) -> bool:
        """Return whether a mutant matches; ``lines`` are those of a file."""
        places = self._places(mutant)
        return any(not self.line or self._has_line(span, lines(span.file)) for span in places)

    def names(self, mutant: Mutant) -> bool:
        """Return whether the decision names the mutant, regardless of its line's text."""
        return bool(self._places(mutant))

    def _places(self, mutant: Mutant) -> list[Span]:
        """Return the places of the mutant that the decision names; none if it names another mutant."""
        is_other = self.id not in ("", mutant.id)
        if is_other or (self.operator and not is_like(self.operator, mutant.operator)):
            return []
        return [span for span in mutant.site.spans if self._is_at(span)]

    def _is_at(self, span: Span) -> bool:
        first, last = self.numbers or (span.line, span.end_line)
        is_there = first <= span.end_line and span.line <= last
        return is_there and (not self.file or is_like(self.file, span.file))

    def _has_line(self, span: Span, lines: Sequence[str]) -> bool:
        """Return whether one of the lines of a place has the text."""
        return any(is_like(self.line, text.strip()) for text in lines[max(0, span.line - 1) : span.end_line])

    @property
    def mutants_text(self) -> str:
        """The mutants that it names, as a text: ``reverse in mission.py:22``."""
        if self.id:
            return self.id
        what = self.operator or "mutants"
        where = [f"in {self.file}"] if self.file else []
        return " ".join([what, *where, *([f"at {self.line!r}"] if self.line else [])])


@frozen
class Acceptance:
    """The reason and the date of accepting a survivor.

    Attributes:
        why: the reason.
        source: where that is written, ``file:line``.
        date: when it was accepted; empty if it is not said.
        in_source: whether it is a comment in the program.
    """

    why: str
    source: str
    date: str = ""
    in_source: bool = False


@frozen
class Accepted:
    """The accepted survivors of a campaign.

    Attributes:
        mutants: by the ids of mutants that are accepted if they survive.
        unmatched: decisions that fit no mutant, a line each with the reason.
    """

    mutants: Mapping[str, Acceptance] = field(default_factory=dict)
    unmatched: tuple[str, ...] = ()


def first_fitting(suppressions: Iterable[Suppression], mutant: Mutant, lines: LinesOf) -> Suppression | None:
    """Return the first decision that matches a mutant; None if there is none."""
    return next((suppression for suppression in suppressions if suppression.fits(mutant, lines)), None)
