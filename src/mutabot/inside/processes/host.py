"""The test process's side: what it gives to processes below it, and what it makes of what they tell."""

from __future__ import annotations

import os

from mutabot.border.fold import Children
from mutabot.border.job import Job
from mutabot.border.processes import FOLDER
from mutabot.extensions import brought

from .carried import carry
from .exits import Exits
from .now import Now
from .wake import write_wake

#: what processes of interest load
_JOIN = "mutabot.inside.processes.member"


class Host:
    """The processes below a test process.

    Args:
        home: the home of the test process.
        job: its job.

    Attributes:
        children: what members have written.
        exits: how processes ended, as far as the test process knows.
        number: the running test's.
    """

    def __init__(self, home: str, job: Job) -> None:
        self.folder = os.path.join(home, FOLDER)
        os.makedirs(self.folder, exist_ok=True)
        self._write_wake(job)
        self._now = Now(self.folder, is_host=True)
        self.children = Children(home, job.key)
        self.exits = Exits()

    @property
    def number(self) -> int:
        """The number of the running test."""
        return self._now.number

    def open(self) -> None:
        """Let every Python process that is started from now on find its way here."""
        carry(self.folder)
        self.exits.watch()

    def start_test(self, test: str) -> None:
        """A test begins."""
        self._now.begin(test)

    def _write_wake(self, job: Job) -> None:
        names: set[str] = set()
        nodes = {_top(module) for module in brought("middlewares")}  # what any node imports
        for operation in job.vocabulary.operations:
            names.update(nodes if operation.named is not None else [_top(operation.target)])
        if job.vocabulary.clock is not None:
            names.add(_top(job.vocabulary.clock.tick))
        files = [os.path.realpath(os.path.join(job.root, path)) for path in (*job.program, *job.oracle)]
        for path in (*job.program, *job.oracle):
            names.update(part.removesuffix(".py") for part in path.split("/") if part not in (".", "..", ""))
        write_wake(self.folder, _JOIN, names, files)


def _top(target: str) -> str:
    return target.partition(":")[0].partition(".")[0]
