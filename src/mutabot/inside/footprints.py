"""The footprint of each test: what it shares with others, leaves behind in the process, and does to files."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import pytest

from mutabot.model import Footprint, Job, SharedFixture

from .file_watch import FileWatch
from .leftovers import Leftovers
from .locate import Locator
from .shared_fixtures import SharedFixtures

#: folders of a project in which no code of the user's lies
_NOT_THE_USERS = ("site-packages", "dist-packages", ".venv", ".mutabot", ".tox", ".nox")


@dataclass(slots=True)
class Footprints:
    """What the tests of a session leave, one after the other.

    Args:
        job: the job at hand.
        locator: whose file is whose.
    """

    job: Job
    locator: Locator
    files: FileWatch = field(init=False)
    _leftovers: Leftovers = field(init=False)
    _fixtures: SharedFixtures = field(init=False)
    _used: tuple[SharedFixture, ...] = ()
    _folder: str | None = None
    _begun: bool = False

    def __post_init__(self) -> None:
        vocabulary = self.job.vocabulary
        targets = {operation.module for operation in vocabulary.operations}
        self._leftovers = Leftovers(self._is_project, frozenset(targets))
        self._fixtures = SharedFixtures(lambda file: self.locator.role(file) is not None)
        self.files = FileWatch((os.path.join(os.path.realpath(self.job.root), ".mutabot"),))

    def start_test(self) -> None:
        """A test begins, before its fixtures."""
        if not self._begun:
            self._begun = True
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
        left, unseen = self._leftovers.since()
        done = sorted(self.files.done.items(), key=lambda item: not item[1])
        return Footprint(
            fixtures=self._used,
            left=left,
            unseen=unseen,
            files=tuple(str(deed) for deed, _ in done),
            outlives=any(outlives for _, outlives in done),
        )

    def _is_project(self, file: str) -> bool:
        relative = self.locator.relative(file)
        return not relative.startswith("..") and not any(
            part in _NOT_THE_USERS for part in relative.split("/")
        )
