"""The proof: real runs of plain tests with the check, on the original and on the survivors."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from mutabot.campaign.request import Progress, Request
from mutabot.campaign.run import open_executor, run_campaign
from mutabot.errors import MutabotError
from mutabot.execution.task import Task, death
from mutabot.journal.journal import JournalReader
from mutabot.model import By, Verdict
from mutabot.model.events import TestEnd

from .checks import ProposedCheck, Trials
from .place import PlaceInTest, edited
from .project import ProjectFiles, copy_of


@dataclass(slots=True)
class Proof:
    """What is known of checks, by their statements and tests.

    Attributes:
        request: for the rounds of the campaign.
        project: into whose tests checks are put.
        progress: is told.
        failed: checks that failed, with the reason.
        kills: of each check that was run on the survivors: the mutants and rounds that it killed.
    """

    request: Request
    project: ProjectFiles
    progress: Progress
    failed: dict[ProposedCheck, str] = field(default_factory=dict)
    kills: dict[ProposedCheck, Trials] = field(default_factory=dict)

    def on_original(self, checks: Sequence[ProposedCheck], rounds: Sequence[int]) -> list[ProposedCheck]:
        """Those of these checks with which the original passes in all of these rounds."""
        left = [one for one in checks if one not in self.failed]
        while left:
            alarms = self._alarms(left, rounds)
            if not alarms:
                return left
            self.failed.update(alarms)
            left = [one for one in left if one not in alarms]
        return []

    def _alarms(self, checks: Sequence[ProposedCheck], rounds: Sequence[int]) -> dict[ProposedCheck, str]:
        texts = texts_with(self.project, checks)
        found: dict[ProposedCheck, str] = {}
        with copy_of(self.request, texts) as copied:
            these = _only(copied, checks)
            self.progress.stage("proof on the original", len(rounds))
            with open_executor(these, self.progress) as opened:
                share = these.forks
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

    def on_survivors(
        self, checks: Sequence[ProposedCheck], mutants: Mapping[PlaceInTest, Iterable[str]]
    ) -> None:
        """Run campaigns of the mutants that act in the tests of these checks, by the tests.

        A test has one of the checks at a time; those of several tests are run together.
        """
        left = [one for one in checks if one not in self.kills and one not in self.failed]
        while left:
            batch = list({_own_name(one.place.node): one for one in reversed(left)}.values())
            left = [one for one in left if one not in batch]
            try:
                self._run(batch, mutants)
            except MutabotError as error:
                if len(batch) > 1:
                    for one in batch:
                        self.on_survivors([one], mutants)
                else:
                    self.failed[batch[0]] = f"a campaign with it ends: {str(error).splitlines()[0]}"

    def _run(self, checks: Sequence[ProposedCheck], mutants: Mapping[PlaceInTest, Iterable[str]]) -> None:
        only = tuple(dict.fromkeys(mutant for one in checks for mutant in mutants[one.place]))
        with copy_of(self.request, texts_with(self.project, checks)) as copied:
            these = _only(copied, checks)
            path = run_campaign(replace(these, only=only, every_test=True, repeats=False), self.progress)
            with JournalReader.open(path) as journal:
                outcomes = journal.outcomes()
        killed: dict[str, set[tuple[str, int]]] = {}
        for outcome in outcomes:
            for kill in outcome.kills if outcome.verdict is Verdict.KILLED else ():
                if kill.by is By.CHECK:
                    killed.setdefault(_own_name(kill.test), set()).add((outcome.mutant, outcome.round))
        for one in checks:
            self.kills[one] = frozenset(killed.get(_own_name(one.place.node), ()))
            if not self.kills[one]:
                self.failed[one] = "kills no survivor when it is run"


def _own_name(node: str) -> str:
    """The name of a test within its file or class, without parameters."""
    return node.partition("[")[0].rpartition("::")[2]


def texts_with(project: ProjectFiles, checks: Sequence[ProposedCheck]) -> dict[str, str]:
    """The texts of the files that change when checks stand at the ends of their tests, by path."""
    return edited(project, (one.addition() for one in checks))


def _only(request: Request, checks: Sequence[ProposedCheck]) -> Request:
    tests = tuple(dict.fromkeys(one.place.node for one in checks))
    return replace(request, configuration=request.configuration.model_copy(update={"tests": tests}))


def _blamed(checks: Sequence[ProposedCheck], end: TestEnd, texts: Mapping[str, str]) -> list[ProposedCheck]:
    """The checks that let a test fail: that at the place of the failure, else all that it makes."""
    file, _, line = (end.place or "").rpartition(":")
    lines = texts.get(file, "").splitlines()
    if line.isdigit() and 0 < int(line) <= len(lines):
        found = [one for one in checks if one.statement == lines[int(line) - 1].strip()]
        if found:
            return found
    node = end.test.partition("[")[0]
    return [one for one in checks if one.place.node == node] or list(checks)
