"""The contract of an engine: what gives mutants their outcomes.

An engine is one file in ``campaign/engines/kinds/`` that sets ``ENGINE``; ``choice`` asks all of them, in
their order. What one cannot judge goes to the next, by what the baseline knows of the tests that judge it, or
because something went wrong on the way. The last takes everything: replay, the reference.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Protocol

from mutabot.campaign.campaign import Campaign
from mutabot.journal.records import ControlEnd
from mutabot.model import Mutant, Outcome

#: what is run: a mutant in a round
Trial = tuple[Mutant, int]


@dataclass(slots=True)
class Remainder:
    """What an engine leaves to the next one.

    Attributes:
        trials: mutants and rounds.
        apart: mutants that need a process of their own from the start.
        why_apart: why, by their ids.
        reasons: test to why mutants cannot be judged in it by this engine.
        notes: what else went wrong, in words.
    """

    trials: list[Trial] = field(default_factory=list)
    apart: list[Trial] = field(default_factory=list)
    why_apart: dict[str, str] = field(default_factory=dict)
    reasons: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def set_apart(self, mutant: Mutant, round: int, reason: str) -> None:
        """Leave a mutant whatever its tests."""
        self.apart.append((mutant, round))
        self.why_apart[mutant.id] = reason

    @property
    def all(self) -> list[Trial]:
        """All that is left."""
        return [*self.trials, *self.apart]

    def why(self, mutant: Mutant) -> str:
        """Why a mutant is left, in words."""
        if mutant.id in self.why_apart:
            return f"it {self.why_apart[mutant.id]}"
        return "; ".join(dict.fromkeys([*self.reasons.values(), *self.notes]))


class Engine(Protocol):
    """Gives mutants their outcomes.

    Attributes:
        name: as ``--engine``, journals and outcomes have it.
        order: who is asked first; the one with the highest number takes everything.
        runs: how often the baseline runs the original in each round before this engine begins. One that runs
            the original itself, beside its mutants, needs one run less than one that does not.
        may_share: whether the baseline's runs may begin where the tests are collected already.
    """

    name: str
    order: int
    runs: int
    may_share: bool

    def run(self, campaign: Campaign, trials: list[Trial], left: Remainder) -> Iterator[Outcome | ControlEnd]:
        """Outcomes of mutants in rounds as they come, and before they are believed those of controls.

        ``left`` is filled with what could not be judged, and why. Raises ControlError for a control that ends
        wrongly, after it was yielded.
        """

    def try_controls(
        self, campaign: Campaign, mutants: Iterable[Mutant], left: Remainder
    ) -> Iterator[ControlEnd]:
        """The controls for these mutants alone; ``left`` as far as it is known without running them."""
