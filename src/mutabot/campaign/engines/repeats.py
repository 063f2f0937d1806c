"""Repeats: kills that may be chance are run once more, and what ``--verify`` asks for.

A kill that does not come out again becomes ``unstable``. If one of a test's kills does not, all its other
kills are in doubt as well. Kills in doubt are repeated cheapest first, within a small share of the campaign's
time, and a larger one as soon as one does not come out again; how many were left is told.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from mutabot.border.codec import to_data
from mutabot.campaign.campaign import Campaign, Sink
from mutabot.campaign.request import Progress
from mutabot.journal.records import (
    FLAKY,
    REPEATS,
    VERIFICATION,
    Repeated,
    Repeats,
    Verification,
)
from mutabot.model import Mutant, Verdict

from .doubt import Doubts, Key
from .engine import Trial
from .second_look import Looker, choose, disagreement, flaky_of, unconfirmed

#: repeats of kills in doubt may take this share of the time that the campaign has taken, or so many seconds
SHARE, SECONDS = 0.05, 2.0
#: the same once a kill has not come out again, and for what is left to chance
MOST_SHARE, MOST_SECONDS = 0.2, 10.0
#: how often an outcome is repeated whose operator leaves to chance what happens
RACES = 3


def look_again(campaign: Campaign, mutants: Sequence[Mutant], sink: Sink, spent: float) -> None:
    """Verify and repeat, and write down what came of it, flaky tests included.

    ``spent``: seconds that the campaign has taken until now.
    """
    request, baseline, progress = campaign.request, campaign.baseline, campaign.progress
    journal = sink.journal
    journal.set_meta(FLAKY, to_data(flaky_of(baseline)))
    by_id = {mutant.id: mutant for mutant in mutants}
    outcomes = {(one.mutant, one.round): one for one in journal.outcomes() if one.mutant in by_id}
    looker = Looker(campaign)
    second = _SecondLook(Doubts(baseline, by_id, outcomes), looker, sink, progress)
    chosen = choose(outcomes.values(), request.verify, request.seed)
    second.run(chosen)
    if request.verify:
        found = [disagreement(by_id[key[0]], outcomes[key], looker.found[key]) for key in chosen]
        verification = Verification(request.verify, len(chosen), tuple(one for one in found if one))
        journal.set_meta(VERIFICATION, to_data(verification))
        progress.note(f"verify: {verification.agreed} of {verification.checked} outcomes agree")
    if request.repeats:
        most = max(MOST_SHARE * spent, MOST_SECONDS)
        second.repeat_raced(most)
        second.repeat_doubted(max(SHARE * spent, SECONDS), most)
    journal.set_meta(REPEATS, to_data(second.repeats()))


@dataclass(slots=True)
class _SecondLook:
    """The repeats of one campaign."""

    doubts: Doubts
    looker: Looker
    sink: Sink
    progress: Progress

    def run(self, keys: Iterable[Key], until: float | None = None) -> None:
        """Run these once more, as far as ``until`` (``Request.clock``) allows."""
        trials: list[Trial] = [(self.doubts.mutants[mutant], round) for mutant, round in keys]
        self.looker.look(trials, until)

    def repeat_raced(self, seconds: float) -> None:
        """Run what chance decides several times more; what does not always end alike becomes unstable."""
        until = self.looker.campaign.request.clock() + seconds
        keys = sorted(self.doubts.raced(), key=self.doubts.cost)
        due, changed, looked = list(keys), list[Key](), set[Key]()
        for again in range(RACES):
            for key in due:
                self.looker.found.pop(key, None)
            self.run(due, until)
            due = [key for key in due if key in self.looker.found]
            looked.update(due)
            for key in due:
                first = self.doubts.outcomes[key]
                if self._is_changed(key):
                    changed.append(key)
                    self.sink.add_outcome(unconfirmed(first, self.looker.found[key]))
                else:
                    self.sink.add_outcome(replace(first, repeats=first.repeats + again + 1))
            due = [key for key in due if key not in changed]
        if keys:
            left = f"; {len(keys) - len(looked)} were left" if len(looked) < len(keys) else ""
            again = len(looked) - len(changed)
            self.progress.note(
                f"repeats: {again} of {len(looked)} ends left to chance are always alike{left}"
            )

    def repeat_doubted(self, seconds: float, most: float) -> None:
        """Run the kills in doubt once more, and those which that puts in doubt.

        This takes so many ``seconds``, and at ``most`` as many if one does not come out again.
        """
        began = self.looker.campaign.request.clock()
        raced = set(self.doubts.raced())
        repeated: list[Key] = []
        changed: list[Key] = []
        while due := [key for key in self.doubts.in_doubt() if key not in raced.union(repeated)]:
            new = sorted((key for key in due if key not in self.looker.found), key=self.doubts.cost)
            seconds = max(seconds, most) if changed else seconds
            self.run(new, began + seconds)
            looked = [key for key in due if key in self.looker.found]
            if not looked:
                break
            repeated += looked
            changed += self._settle(looked)
            self.doubts.unreliable.update(self.doubts.outcomes[key].test or "" for key in changed)
        if repeated or due:
            left = f"; {len(due)} were left, as repeats may take {seconds:.0f} s" if due else ""
            again = len(repeated) - len(changed)
            self.progress.note(f"repeats: {again} of {len(repeated)} kills in doubt come out again{left}")

    def repeats(self) -> Repeats:
        """What is known now."""
        doubts = self.doubts
        kills = doubts.kills()
        certain = {key for key in kills if key not in self.looker.found and doubts.is_certain(key)}
        doubted = set(doubts.in_doubt())
        others = [key for key in kills if key not in certain and key not in doubted]
        survivors = [key for key, one in doubts.outcomes.items() if one.verdict is Verdict.SURVIVED]
        return Repeats(
            self._stratum(doubted - certain), self._stratum(others), len(certain), self._stratum(survivors)
        )

    def _stratum(self, keys: Iterable[Key]) -> Repeated:
        keys = list(keys)
        looked = [key for key in keys if key in self.looker.found]
        return Repeated(len(keys), len(looked), sum(map(self._is_changed, looked)))

    def _is_changed(self, key: Key) -> bool:
        return self.looker.found[key].verdict is not self.doubts.outcomes[key].verdict

    def _settle(self, keys: Iterable[Key]) -> list[Key]:
        """Write into the journal what their repeats say; returns those that came out otherwise."""
        changed = []
        for key in keys:
            first, second = self.doubts.outcomes[key], self.looker.found[key]
            if self._is_changed(key):
                changed.append(key)
                self.sink.add_outcome(unconfirmed(first, second))
            else:
                self.sink.add_outcome(replace(first, repeats=first.repeats + 1))
        return changed
