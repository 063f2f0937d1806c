"""The results of mutants in a campaign on a simulation of the same program: a rehearsal.

The order on hardware is by that, the most harmless first: what changed nothing visible, then
by how far the world was from the original's, and last what the simulated robot refused, what crashed or hung,
and what the rehearsal does not know.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from pathlib import Path

from mutabot.api.reports import MutabotError, MutantResult, Results, UsageError, Verdict

#: verdicts that say nothing harmless of a mutant
_BAD = frozenset({Verdict.REFUSED, Verdict.GUARDED, Verdict.TIMEOUT, Verdict.ERROR, Verdict.UNSTABLE})


@dataclass(frozen=True, slots=True)
class Rehearsed:
    """The results of a mutant in the rehearsal.

    Attributes:
        harm: 0 for none, larger for more; infinite for what is not known.
        text: description of the same.
    """

    harm: float
    text: str


UNKNOWN = Rehearsed(inf, "not known: no rehearsal has run it")


class Rehearsal:
    """The rehearsal of a project.

    Args:
        found: what became of each mutant, by its id.
    """

    def __init__(self, found: Mapping[str, Rehearsed]) -> None:
        self._found = found

    @classmethod
    def read(cls, journal: Path | None) -> Rehearsal:
        """Read the rehearsal in a journal; an empty one for None. Raises UsageError if it cannot be read."""
        if journal is None:
            return cls({})
        try:
            results = Results.read(journal)
        except MutabotError as error:
            raise UsageError(f"hardware.rehearsal: {error}") from error
        return cls({result.mutant.id: _of(result) for result in results.mutants})

    def of(self, mutant: str) -> Rehearsed:
        """Return the results of the mutant with this id."""
        return self._found.get(mutant, UNKNOWN)


def _of(result: MutantResult) -> Rehearsed:
    outcomes = [outcome for outcome in result.rounds if outcome is not None]
    if not outcomes:
        return UNKNOWN
    bad = [outcome for outcome in outcomes if outcome.verdict in _BAD]
    if bad:
        return Rehearsed(inf, f"{bad[0].verdict} in simulation")
    known = [outcome.deviation for outcome in outcomes]
    if any(deviation is None for deviation in known):
        return Rehearsed(inf, f"{outcomes[0].verdict} in simulation; how far it led is not known")
    worst = max(deviation or 0.0 for deviation in known)
    shown = (outcome.shown_difference for outcome in outcomes)
    story = next(
        (difference.story for difference in shown if difference is not None and difference.story),
        "",
    )
    text = story or f"{worst:.3g} times the original's own spread away"
    return Rehearsed(worst, f"{outcomes[0].verdict} in simulation: {text}")
