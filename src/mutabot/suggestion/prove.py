"""The proof: real runs of plain tests with the check, on the original and on the survivors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from mutabot.border.test_end import TestEnd
from mutabot.campaign.beginning import open_executor
from mutabot.campaign.engines.choice import first_engine
from mutabot.campaign.request import Progress, Request
from mutabot.campaign.run import run_campaign
from mutabot.campaign.workers.task import Task, death
from mutabot.errors import MutabotError
from mutabot.journal.reader import JournalReader
from mutabot.model import By, Verdict
from mutabot.suggestion.choosing.checks import Check
from mutabot.suggestion.sources.workspace import copy_of

from .forms import Form


@dataclass(slots=True)
class Proof:
    """What is known of checks, by their statements and tests.

    Attributes:
        request: for the rounds of the campaign.
        form: how checks are put into the project.
        progress: is told.
        failed: checks that failed, with the reason.
        kills: of each check that was run on the survivors: mutant id to the rounds in which it killed.
    """

    request: Request
    form: Form
    progress: Progress
    failed: dict[Check, str] = field(default_factory=dict)
    kills: dict[Check, dict[str, tuple[int, ...]]] = field(default_factory=dict)

    def on_original(self, checks: Sequence[Check], rounds: Sequence[int]) -> list[Check]:
        """Those of these checks with which the original passes in all of these rounds."""
        left = [one for one in checks if one not in self.failed]
        while left:
            alarms = self._alarms(left, rounds)
            if not alarms:
                return left
            self.failed.update(alarms)
            left = [one for one in left if one not in alarms]
        return []

    def _alarms(self, checks: Sequence[Check], rounds: Sequence[int]) -> dict[Check, str]:
        texts = self.form.texts(checks)
        found: dict[Check, str] = {}
        with copy_of(self.request, texts) as copied:
            these = _only(copied, self.form.tests(checks))
            self.progress.stage("proof on the original", len(rounds))
            with open_executor(these, self.progress) as opened:
                share = first_engine(these).may_share
                tasks = (Task(round, these.job(round), startup=300.0, may_share=share) for round in rounds)
                for result in opened.run(tasks):
                    self.progress.advance(f"round {result.task.key + 1}")
                    where = f"round {result.task.key + 1} of the original"
                    if result.end is None or result.end.errors or not result.ends:
                        why = death(result) if result.end is None else "; ".join(result.end.errors)
                        return dict.fromkeys(checks, f"the tests cannot be run with it: {why or 'none ran'}")
                    for end in result.ends:
                        if end.outcome == "failed":
                            text = f"fails in {where}: {(end.message or 'no message').splitlines()[0]}"
                            for one in _blamed(checks, end, texts):
                                found.setdefault(one, text)
        return found

    def on_survivors(self, check: Check, mutants: Sequence[str]) -> None:
        """Run a campaign of these mutants with this check alone."""
        if check in self.kills or check in self.failed:
            return
        with copy_of(self.request, self.form.texts([check])) as copied:
            request = replace(_only(copied, self.form.tests([check])), only=tuple(mutants))
            try:
                path = run_campaign(request, self.progress)
            except MutabotError as error:
                self.failed[check] = f"a campaign with it ends: {str(error).splitlines()[0]}"
                return
            with JournalReader.open(path) as journal:
                outcomes = journal.outcomes()
        found: dict[str, list[int]] = {}
        for one in outcomes:
            if one.verdict is Verdict.KILLED and one.by is By.CHECK:
                found.setdefault(one.mutant, []).append(one.round)
        self.kills[check] = {mutant: tuple(sorted(rounds)) for mutant, rounds in found.items()}
        if not found:
            self.failed[check] = "kills no survivor when it is run"


def _only(request: Request, tests: tuple[str, ...]) -> Request:
    return replace(request, configuration=request.configuration.model_copy(update={"tests": tests}))


def _blamed(checks: Sequence[Check], end: TestEnd, texts: Mapping[str, str]) -> list[Check]:
    """The checks that let a test fail: that at the place of the failure, else all that it makes."""
    file, _, line = (end.place or "").rpartition(":")
    lines = texts.get(file, "").splitlines()
    if line.isdigit() and 0 < int(line) <= len(lines):
        found = [one for one in checks if one.statement == lines[int(line) - 1].strip()]
        if found:
            return found
    node = end.test.partition("[")[0]
    return [one for one in checks if one.place.node == node] or list(checks)
