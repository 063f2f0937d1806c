"""Warm: like replay, but processes begin as forks of one that has imported what they import.

It is for tests that start processes: worker and nodes then begin in some ten milliseconds instead of several
hundred; and for mutants that act while the program is imported, since all that comes before that import is
the same for all of them. What ends as an error, or so that it says nothing, is run once more by replay.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from mutabot.campaign.baseline.taking import REPETITIONS
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.controls import run_controls
from mutabot.campaign.engines.engine import Engine, Remainder, Trial
from mutabot.campaign.engines.fresh import longest_first, replay
from mutabot.journal.records import ControlEnd
from mutabot.model import Mutant, Outcome, Verdict

#: ends of which the reference has the last word
_IN_DOUBT = {Verdict.ERROR, Verdict.UNSTABLE}
#: fewer than so many are not worth a process that others begin from
_LEAST = 3


class Warm:
    """The engine; see ``Engine``."""

    name = "warm"
    order = 60
    runs = REPETITIONS
    may_share = False

    def run(self, campaign: Campaign, trials: list[Trial], left: Remainder) -> Iterator[Outcome | ControlEnd]:
        """Controls first, then each mutant by itself, if it is one that this is for."""
        is_all = campaign.request.engine == self.name
        own = [trial for trial in trials if is_all or _gains(campaign, *trial)]
        if len(own) < _LEAST and not is_all:
            own = []
        chosen = {(mutant.id, round) for mutant, round in own}
        left.trials += [trial for trial in trials if (trial[0].id, trial[1]) not in chosen]
        if not own:
            return
        by_id = {mutant.id: mutant for mutant, _ in own}
        yield from run_controls(campaign, by_id.values(), warm=True)
        campaign.progress.stage("mutants by warm starts", len(own))
        doubtful: list[Trial] = []
        for outcome in replay(campaign, longest_first(campaign, own), self.name):
            if outcome.verdict in _IN_DOUBT and not is_all:
                doubtful.append((by_id[outcome.mutant], outcome.round))
            else:
                yield outcome
        yield from replay(campaign, doubtful)

    def try_controls(
        self, campaign: Campaign, mutants: Iterable[Mutant], left: Remainder
    ) -> Iterator[ControlEnd]:
        """Those of replay are enough, unless this engine is asked for."""
        if campaign.request.engine == self.name:
            yield from run_controls(campaign, mutants, warm=True)


def _gains(campaign: Campaign, mutant: Mutant, round: int) -> bool:
    """Whether it acts before any test, or tests that judge it have had processes below them."""
    baseline = campaign.baseline
    if baseline.is_early(mutant):
        return True
    ends = (baseline.ends[round, test] for test in baseline.judges(round, mutant))
    return any(end.processes for end in ends)


ENGINE: Engine = Warm()
