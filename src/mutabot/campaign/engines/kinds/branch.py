"""Branch: the suite runs once as the original, and forks where a mutant differs; the fork goes on as that.

Mutants that are hit where it is not safe to fork are left to the next engine.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from mutabot.campaign.baseline.taking import REPETITIONS
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.controls import Control, controls_of, end_of
from mutabot.campaign.engines.engine import Engine, Remainder, Trial
from mutabot.campaign.engines.fork_parent import Trunks
from mutabot.campaign.engines.fresh import Hindered, replay_alone
from mutabot.campaign.engines.repeats import clear_up
from mutabot.journal.records import ControlEnd
from mutabot.model import Mutant, Outcome


@dataclass(frozen=True, slots=True)
class _Controls:
    """The controls of a campaign as branches."""

    by_id: Mapping[str, Control]

    @classmethod
    def of(cls, campaign: Campaign, trials: Iterable[Trial]) -> _Controls:
        """Those not proven yet."""
        found = controls_of(campaign.baseline, (mutant for mutant, _ in trials), forked=True)
        left = (one for one in found if (Branch.name, one.way) not in campaign.proven)
        return cls({one.mutant.id: one for one in left})

    @property
    def trials(self) -> list[Trial]:
        return [(control.mutant, control.round) for control in self.by_id.values()]


class Branch:
    """The engine; see ``Engine``. Its trunks are the second run of the original in each round."""

    name = "branch"
    order = 0
    runs = REPETITIONS - 1
    may_share = True

    def run(self, campaign: Campaign, trials: list[Trial], left: Remainder) -> Iterator[Outcome | ControlEnd]:
        """One trunk per round, with controls and mutants as its branches."""
        controls = _Controls.of(campaign, trials)
        campaign.progress.stage("mutants", len(trials))
        trunks = Trunks(campaign, left, self.name)
        by_id = {mutant.id: mutant for mutant, _ in trials}
        hindered = Hindered()
        for outcome in trunks.run([*controls.trials, *trials]):
            control = controls.by_id.get(outcome.mutant)
            why = trunks.hindered.get((outcome.mutant, outcome.round))
            if control is None and why is not None:
                hindered.add(by_id[outcome.mutant], outcome, why)
            elif control is None:
                yield outcome
            if control is None:
                continue
            end = end_of(campaign, control, outcome)
            yield end
            if not end.ok:
                raise control.error(end.detail)
            campaign.proven.add((self.name, control.way))
        _tell(campaign, left)
        clear_up(campaign, trunks.suspects)
        left.trials = [trial for trial in left.trials if trial[0].id not in controls.by_id]
        yield from replay_alone(campaign, hindered)

    def try_controls(
        self, campaign: Campaign, mutants: Iterable[Mutant], left: Remainder
    ) -> Iterator[ControlEnd]:
        """One pair for each way into the program."""
        mutants = list(mutants)
        controls = _Controls.of(campaign, [(mutant, 0) for mutant in mutants])
        baseline, progress = campaign.baseline, campaign.progress
        for mutant, round in ((one, round) for one in mutants for round in range(campaign.request.rounds)):
            why = baseline.why_apart(mutant)
            if why is not None:
                left.set_apart(mutant, round, why)
        progress.stage("controls", len(controls.by_id))
        for outcome in Trunks(campaign, left, self.name).run(controls.trials):
            control = controls.by_id[outcome.mutant]
            end = end_of(campaign, control, outcome)
            progress.advance(f"{control.name}, {control.subject}: {'as it must' if end.ok else end.detail}")
            if not end.ok:
                raise control.error(end.detail)
            yield end


def _tell(campaign: Campaign, left: Remainder) -> None:
    progress = campaign.progress
    tests: dict[str, list[str]] = {}
    for test, reason in left.reasons.items():
        tests.setdefault(reason, []).append(test)
    for reason, (first, *others) in tests.items():
        more = f" and {len(others)} more" if others else ""
        there = "mutants there run in processes of their own"
        if first:
            progress.note(f"no branches in {first}{more}: {reason}; {there}")
        else:
            progress.note(f"no branches while the program is imported: {reason}; {there}")
    for why, number in Counter(left.why_apart.values()).items():
        progress.note(f"{number} mutants: each {why}, in a process of its own")
    for note in left.notes:
        progress.note(note)


ENGINE: Engine = Branch()
