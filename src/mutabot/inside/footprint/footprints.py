"""The footprint of each test: what it shares with others, leaves behind in the process, and does to files."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import pytest

from mutabot.border.footprint import Footprint, SharedFixture
from mutabot.border.job import Job
from mutabot.inside.calls.locate import Locator
from mutabot.inside.fork.forkable import subprocesses
from mutabot.inside.fork.private_files import is_below, make_private, private_folders

from .deeds import Deed, Deeds
from .leftovers import Leftovers
from .shared_fixtures import SharedFixtures

#: folders of a project in which no code of the user's lies
_NOT_THE_USERS = ("site-packages", "dist-packages", ".venv", ".mutabot", ".tox", ".nox")


@dataclass(slots=True)
class Footprints:
    """What the tests of a session leave, one after the other.

    Args:
        job: the job at hand.
        locator: whose file is whose.

    Attributes:
        files: what the running test does to files.
        has_others: whether the suite has more tests than one; else nobody is there to find what is left.
    """

    job: Job
    locator: Locator
    files: Deeds = field(init=False)
    _leftovers: Leftovers = field(init=False)
    _fixtures: SharedFixtures = field(init=False)
    _private: tuple[str, ...] = ()
    has_others: bool = True
    _used: tuple[SharedFixture, ...] = ()
    _folder: str | None = None
    _begun: bool = False

    def __post_init__(self) -> None:
        vocabulary = self.job.vocabulary
        targets = {operation.module for operation in vocabulary.operations}
        self._leftovers = Leftovers(self._is_project, frozenset(targets))
        self._fixtures = SharedFixtures(lambda file: self.locator.role(file) is not None)
        self.files = Deeds((os.path.join(os.path.realpath(self.job.root), ".mutabot"),))

    def make_private(self, home: str) -> str | None:
        """Keep to this process what it does to files; why that is not possible, in words, if it is not."""
        root = os.path.realpath(self.job.root)
        reason = make_private(root, os.path.realpath(home), os.path.join(root, ".mutabot"))
        self._private = private_folders(root) if reason is None else ()
        return reason

    def start_test(self) -> None:
        """A test begins, before its fixtures."""
        if not self._begun:
            self._begun = True
            if self.has_others:
                self._leftovers.start()
            self.files.install()
        self._used, self._folder = (), None
        self.files.start()

    def take_fixtures(self, item: pytest.Item) -> None:
        """The test has run, and its fixtures are still there."""
        self._used = self._fixtures.used_by(item)
        folder = getattr(item, "funcargs", {}).get("tmp_path")
        self._folder = os.path.abspath(folder) if folder is not None else None

    @contextmanager
    def setting_up(self, fixture: Any) -> Iterator[None]:
        """While a shared fixture is set up."""
        with self._fixtures.setting_up(fixture):
            yield

    def of_test(self) -> Footprint:
        """The footprint of the test that has just ended, its fixtures taken down."""
        self.files.stop(self._folder)
        left, replaced, unseen = self._leftovers.since() if self.has_others else ([], [], [])
        done = sorted(self.files.done.items(), key=lambda item: not item[1])
        return Footprint(
            fixtures=self._used,
            left=tuple(left),
            replaced=tuple(replaced),
            unseen=tuple(unseen),
            files=tuple(str(deed) for deed, _ in done),
            outlives=any(outlives for _, outlives in done) or self._runs_on(),
            exclusive=next((str(deed) for deed, _ in done if self._is_exposed(deed)), None),
        )

    def _runs_on(self) -> bool:
        """Whether a process that the test started is still there."""
        return (
            self.files.has_started_processes and self.job.branching is None and subprocesses(()) is not None
        )

    def _is_exposed(self, deed: Deed) -> bool:
        """Whether processes that do this at the same time get in each other's way."""
        if not deed.path:
            return deed.verb.startswith("waits")
        own = self._folder is not None and is_below(deed.path, self._folder)
        return not own and not any(is_below(deed.path, folder) for folder in self._private)

    def _is_project(self, file: str) -> bool:
        relative = self.locator.relative(file)
        return not relative.startswith("..") and not any(
            part in _NOT_THE_USERS for part in relative.split("/")
        )
