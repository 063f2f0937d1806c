"""The thresholds of a campaign: its ladders, and what they cost."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from mutabot.analysis.results import Results
from mutabot.model.graded.ladder import seen

from .floor import Floor, floors_of
from .ladders import Ladder, ladders_of, looseness
from .rounds import LadderRound

_Key = Callable[[Ladder], Any]
#: orders of the table; the first is the usual one
SORTS: Mapping[str, _Key] = {
    "loosest": lambda one: tuple(-end for end in looseness(one)[:3]),
    "place": lambda one: (one.mutant.site.span.file, one.mutant.site.span.line, one.mutant.site.span.column),
    "operator": lambda one: (one.mutant.operator, *(-end for end in looseness(one)[:3])),
}


@dataclass(frozen=True)
class Thresholds:
    """The thresholds of a campaign.

    Attributes:
        ladders: those of which something is known, in the order that was asked for.
        unjudged: the others.
        rounds: number of rounds.
        state: how the campaign ended, as in ``Results``.
    """

    ladders: tuple[Ladder, ...]
    unjudged: tuple[Ladder, ...]
    rounds: int
    state: str

    @property
    def all(self) -> tuple[Ladder, ...]:
        """All ladders."""
        return (*self.ladders, *self.unjudged)

    @property
    def runs(self) -> int:
        """How many (magnitude, round) were run, without magnitude 0."""
        return sum(one.runs for one in self.all)

    @property
    def exhaustive(self) -> int:
        """How many there are."""
        return sum(one.exhaustive for one in self.all)

    @property
    def controls(self) -> int:
        """How many runs of magnitude 0 there were."""
        return sum(1 for one in self._zeros)

    @property
    def false_alarms(self) -> int:
        """How many of these were noticed."""
        return sum(1 for one in self._zeros if one.fails_without_fault)

    @cached_property
    def floors(self) -> tuple[Floor, ...]:
        """Offsets that are known in both directions."""
        return tuple(floors_of(self.ladders))

    @property
    def most_violated(self) -> float | None:
        """Largest share of such ladders that may be out of order (95 %), where none of them is.

        None if one is, or if they are too few to say anything.
        """
        count = len(self.ladders)
        if any(one.violations for one in self.ladders) or count <= 3:
            return None
        return 3.0 / count

    @property
    def _zeros(self) -> list[LadderRound]:
        known = (one for ladder in self.all for one in ladder.rounds if one.zero is not None)
        return [one for one in known if one.zero is not None and seen(one.zero).is_valid]


def thresholds_of(results: Results, sort: str = "loosest") -> Thresholds:
    """The thresholds of a campaign; ``sort`` is one of ``SORTS``."""
    ladders = ladders_of(results)
    judged = [one for one in ladders if not one.why_unjudged]
    return Thresholds(
        ladders=_sorted(judged, sort),
        unjudged=tuple(one for one in ladders if one.why_unjudged),
        rounds=results.rounds,
        state=results.state,
    )


def _sorted(ladders: Sequence[Ladder], sort: str) -> tuple[Ladder, ...]:
    return tuple(sorted(ladders, key=SORTS[sort]))
