"""Proves checks: adds them to a copy of the project and runs it on the original and on survivors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from textwrap import shorten

from mutabot.api.processes import Request
from mutabot.api.reports import CampaignRun, MutabotError, Progress, Results, Verdict

from .checks import CheckProposal, Monitor, Trials
from .editing import edited
from .project import SuiteFiles, copy_of

#: characters of a failure that are said
_MOST = 100


@dataclass(slots=True)
class Proof:
    """The results of proving checks, by statement and test.

    Attributes:
        request: for the rounds of the campaign.
        project: into whose tests checks are put.
        progress: shows what is going on.
        needs_all: whether all tests are run, as those with checks need what others leave behind.
        failed: checks that failed, with the reason.
        kills: of each check that was run on the survivors: the mutants and rounds that it killed.
    """

    request: Request
    project: SuiteFiles
    progress: Progress
    needs_all: bool = False
    failed: dict[CheckProposal, str] = field(default_factory=dict)
    kills: dict[CheckProposal, Trials] = field(default_factory=dict)

    def on_original(self, checks: Sequence[CheckProposal], rounds: Sequence[int]) -> list[CheckProposal]:
        """Return the checks with which the original passes in all of these rounds."""
        left = [check for check in checks if check not in self.failed]
        while left:
            alarms = self._alarms(left, rounds)
            if not alarms:
                return left
            self.failed.update(alarms)
            left = [proposal for proposal in left if proposal not in alarms]
        return []

    def _alarms(self, checks: Sequence[CheckProposal], rounds: Sequence[int]) -> dict[CheckProposal, str]:
        texts = texts_with(self.project, checks)
        found: dict[CheckProposal, str] = {}
        with copy_of(self.request, texts) as copied:
            these = self._with_tests_of(checks, copied)
            self.progress.stage("proof on the original", len(rounds))
            with CampaignRun.of_original(these, rounds, self.progress) as results:
                for result in results:
                    self.progress.advance(f"round {result.task.key + 1}")
                    is_new = result.task.key >= self.request.rounds
                    where = (
                        "the original with a new seed"
                        if is_new
                        else f"round {result.task.key + 1} of the original"
                    )
                    if result.end is None or result.end.errors or not result.ends:
                        why = result.death() if result.end is None else "; ".join(result.end.errors)
                        return dict.fromkeys(checks, f"the tests cannot be run with it: {why or 'none ran'}")
                    for end in result.ends:
                        if end.outcome == "failed":
                            why = (end.message or "no message").splitlines()[0]
                            text = f"fails in {where}: {shorten(why, _MOST, placeholder=' …')}"
                            place, message = end.place or "", end.message or ""
                            own = failing(checks, place, message, texts)
                            for item in own or in_test(checks, end.test):
                                found.setdefault(item, text if own else f"its test {text}")
        return found

    def on_survivors(self, checks: Sequence[CheckProposal]) -> None:
        """Run campaigns of the mutants that these checks would notice, with all checks at once.

        A check of which the others leave nothing is run once more without them.
        """
        new = [check for check in checks if check not in self.kills and check not in self.failed]
        if new:
            self._try(new)
        for proposal in new:
            if not self.kills.get(proposal) and len(new) > 1:
                self._try([proposal])
            if not self.kills.get(proposal):
                self.failed.setdefault(proposal, "kills no survivor when it is run")

    def _try(self, checks: Sequence[CheckProposal]) -> None:
        """Run these checks together and keep what each kills."""
        try:
            found = self._run(checks)
        except MutabotError as error:
            if len(checks) == 1:
                self.failed[checks[0]] = f"a campaign with it ends: {str(error).splitlines()[0]}"
            return
        self.kills.update({proposal: trials for proposal, trials in found.items() if trials})

    def _run(self, checks: Sequence[CheckProposal]) -> dict[CheckProposal, Trials]:
        """Return what each of these checks kills if all of them are added."""
        only = tuple(dict.fromkeys(mutant for check in checks for mutant, _ in sorted(check.trials)))
        texts = texts_with(self.project, checks)
        with copy_of(self.request, texts) as copied:
            these = self._with_tests_of(checks, copied)
            these = replace(these, only=only, every_test=True, repeats=False, evidence=False)
            outcomes = Results.read(CampaignRun.to_end(these, self.progress)).outcomes
        found: dict[CheckProposal, set[tuple[str, int]]] = {check: set() for check in checks}
        for outcome in outcomes:
            for kill in outcome.kills if outcome.verdict is Verdict.KILLED else ():
                place = outcome.place if kill.test == outcome.test else None
                blamed = failing(checks, place or "", kill.message or "", texts)
                blamed = blamed or in_test(checks, kill.test)
                if kill.by == "check" and len(blamed) == 1:
                    found[blamed[0]].add((outcome.mutant, outcome.round))
        return {proposal: frozenset(trials) for proposal, trials in found.items()}

    def _with_tests_of(self, checks: Sequence[CheckProposal], request: Request) -> Request:
        """Return a request that runs the tests of these checks, and the others if they need them."""
        if self.needs_all:
            return request
        return request.changed(tests=tuple(dict.fromkeys(check.place.node for check in checks)))


def texts_with(project: SuiteFiles, checks: Sequence[CheckProposal]) -> dict[str, str]:
    """Return the changed texts of files to which checks are added, by path."""
    return edited(project, (check.addition() for check in checks))


def failing(
    checks: Sequence[CheckProposal], place: str, message: str, texts: Mapping[str, str]
) -> list[CheckProposal]:
    """Return the checks that failed: by a monitor's name, or at the place ``file:line``."""
    named = [check for check in checks if isinstance(check, Monitor) and check.name in message]
    if named:
        return [max(named, key=lambda value: len(value.name))]  # a short one may be part of a longer one
    file, _, line = place.rpartition(":")
    lines = texts.get(file, "").splitlines()
    if line.isdigit() and 0 < int(line) <= len(lines):
        return [check for check in checks if lines[int(line) - 1].strip() in check.lines]
    return []


def in_test(checks: Sequence[CheckProposal], test: str) -> list[CheckProposal]:
    """Return the checks in a test, or else all."""
    node = test.partition("[")[0]
    return [check for check in checks if check.place.node == node] or list(checks)
