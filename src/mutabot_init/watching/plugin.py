"""Watching one plain run of the suite for ``mutabot init``: which calls the program makes, with which values.

A pytest plug-in of its own: ``-p mutabot_init.watching.plugin``, told by the environment what to look at.
What it found is written to a file as JSON, together with what processes below the tests have seen.
"""

from __future__ import annotations

import os
import time
from typing import Any

import pytest

from mutabot import extensions
from mutabot.errors import MutabotError
from mutabot.model.codec import to_data
from mutabot.runtime.targets.target import prepare
from mutabot_init.watched import WATCH_VARIABLE
from mutabot_init.watching.elsewhere import read, seen_elsewhere, watch_elsewhere, write
from mutabot_init.watching.watch import Watch

#: least seconds between two writings of what was found so far
_PAUSE = 2.0


class _Plugin:
    """Pytest's hooks: when to write down what was found, and what became of the tests."""

    def __init__(self, watch: Watch, output: str, folder: str, problems: list[str]) -> None:
        self._watch, self._output, self._folder, self._problems = watch, output, folder, problems
        self._outcomes: dict[str, str] = {}
        self._written = time.monotonic()

    def pytest_collectreport(self, report: Any) -> None:
        """A file that cannot be collected."""
        if report.failed:
            self._problems.append(f"{report.nodeid}: {_last_line(report.longreprtext)}")

    def pytest_runtest_logreport(self, report: Any) -> None:
        """A phase of a test is over."""
        if report.failed:
            self._problems.append(f"{report.nodeid}: {_last_line(report.longreprtext)}")
        if report.when == "call" or report.outcome != "passed":
            self._outcomes[report.nodeid] = report.outcome

    def pytest_runtest_logfinish(self) -> None:
        """A test is over: the run may be cut short in the next one."""
        if time.monotonic() - self._written > _PAUSE:
            self._write()

    def pytest_sessionfinish(self) -> None:
        """All tests are over."""
        self._write()

    def _write(self) -> None:
        outcomes = list(self._outcomes.values())
        counts = {one: outcomes.count(one) for one in dict.fromkeys(outcomes)}
        found = {**to_data(self._watch.data()), "outcomes": counts, "problems": self._problems[:20]}
        for other in seen_elsewhere(self._folder):
            for key in ("calls", "uses"):
                found[key] += other[key]
        write(self._output, found)
        self._written = time.monotonic()


def _last_line(text: str) -> str:
    """The line of a traceback that says what went wrong."""
    lines = [line.strip().removeprefix("E").strip() for line in text.splitlines() if line.startswith("E ")]
    plain = [line.strip() for line in text.splitlines() if line.strip()]
    return (lines or plain[-1:] or ["no message"])[-1][:300]


@pytest.hookimpl(tryfirst=True)
def pytest_load_initial_conftests(early_config: Any) -> None:
    """Before any of the user's code is imported."""
    path = os.environ.pop(WATCH_VARIABLE, None)
    if path is None:
        return
    order = read(path)
    extensions.use(order["extensions"])
    watch = Watch.of(order)
    watch.install()
    folder = watch_elsewhere(path, order)
    problems = []
    try:
        prepare(order["root"], os.path.dirname(path), None)
    except MutabotError as error:  # what the tests see all the same is worth having
        problems.append(str(error))
    early_config.pluginmanager.register(_Plugin(watch, order["output"], folder, problems), "mutabot-watch")
