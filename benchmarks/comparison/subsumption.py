"""Redundancy: which mutants tell nothing that others do not tell as well.

Two notions, both from what tests really did, so about this suite and these rounds: *dominators*
(``mutabot_minimal.subsumption``), and *alike* ones, which die in exactly the same tests and rounds with the
same messages. Both need every test that reaches a mutant to have been run (``Outcome.complete``).
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from mutabot.model import Outcome
from mutabot.model.outcome_text import without_accidents
from mutabot_minimal.subsumption import dominators


@dataclass(frozen=True, slots=True)
class Redundancy:
    """What a set of mutants repeats.

    Attributes:
        alike: groups of at least two mutants that die in the same tests, rounds and messages.
        dominators: classes that no other one subsumes; any one mutant of each will do.
        killed: mutants that were killed at all, and about which everything is known.
        unknown: killed mutants of which not every test was run; they are in no group and no class.
    """

    alike: tuple[tuple[str, ...], ...]
    dominators: tuple[tuple[str, ...], ...]
    killed: int
    unknown: int

    @property
    def redundant(self) -> int:
        """Mutants that could be left out because another one is like them."""
        return sum(len(group) - 1 for group in self.alike)

    @classmethod
    def of(cls, mutants: Mapping[str, Sequence[Outcome]]) -> Redundancy:
        """That of these mutants, given the outcomes of each."""
        killed = {
            name: [outcome for outcome in those if outcome.verdict.is_killed]
            for name, those in mutants.items()
        }
        killed = {name: those for name, those in killed.items() if those}
        known = {name: those for name, those in killed.items() if all(outcome.complete for outcome in those)}
        return cls(
            alike=tuple(group for group in _grouped_by_manner(known) if len(group) > 1),
            dominators=dominators({name: _killers(those) for name, those in known.items()}),
            killed=len(known),
            unknown=len(killed) - len(known),
        )


def _killers(outcomes: Iterable[Outcome]) -> frozenset[tuple[str, int]]:
    return frozenset((test, outcome.round) for outcome in outcomes for test in outcome.noticing_tests)


def _grouped_by_manner(mutants: Mapping[str, Sequence[Outcome]]) -> list[tuple[str, ...]]:
    groups: dict[frozenset[Hashable], list[str]] = {}
    for name, outcomes in mutants.items():
        groups.setdefault(frozenset(_manner(outcomes)), []).append(name)
    return [tuple(group) for group in groups.values()]


def _manner(outcomes: Iterable[Outcome]) -> Iterator[Hashable]:
    """How a mutant dies, test by test and round by round."""
    for outcome in outcomes:
        if outcome.test not in {kill.test for kill in outcome.kills}:  # a time-out
            yield (
                outcome.round,
                outcome.test,
                outcome.verdict,
                outcome.exception,
                without_accidents(outcome.message),
            )
        for kill in outcome.kills:
            yield outcome.round, kill.test, kill.by, kill.exception, without_accidents(kill.message)
