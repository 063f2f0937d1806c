"""A pytest plug-in that watches one plain run of a suite: ``-p mutabot.runtime.observation_plugin``."""

from __future__ import annotations

import os
import re
import time
from typing import Any

import pytest

from mutabot.errors import MutabotError
from mutabot.model.observation import TESTS, VARIABLE
from mutabot.runtime.observer import ProcessObservation
from mutabot.runtime.targets.target import prepare

#: least seconds between two writings of what was found so far
_PAUSE = 2.0
#: what a file that is no Python raises, and where a traceback says so
_MISTAKE, _PLACE = re.compile(r"(?:Syntax|Indentation|Tab)Error: "), re.compile(r'File "([^"]+)", line (\d+)')
#: problems that are kept
_MOST_PROBLEMS = 20


class _ObservationHooks:
    """Pytest's hooks: when to write down what was found, and what became of the tests."""

    def __init__(self, observation: ProcessObservation, problems: list[str]) -> None:
        self._observation, self._problems = observation, problems
        self._outcomes: dict[str, str] = {}
        self._written = time.monotonic()

    def pytest_collectreport(self, report: Any) -> None:
        """A file that cannot be collected."""
        self._note(report)

    def pytest_runtest_logreport(self, report: Any) -> None:
        """A phase of a test is over."""
        self._note(report)
        if report.when == "call" or report.outcome != "passed":
            self._outcomes[report.nodeid] = report.outcome

    def _note(self, report: Any) -> None:
        problem = f"{report.nodeid}: {_last_line(report.longreprtext)}" if report.failed else ""
        if problem and problem not in self._problems:
            self._problems.append(problem)

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
        problems = self._problems[:_MOST_PROBLEMS]
        self._observation.write(TESTS, outcomes=counts, problems=problems)
        self._written = time.monotonic()


def _last_line(text: str) -> str:
    """The line of a traceback that says what went wrong; for a mistake in a file, with its file and line."""
    lines = [line.strip().removeprefix("E").strip() for line in text.splitlines() if line.startswith("E ")]
    plain = [line.strip() for line in text.splitlines() if line.strip()]
    last = (lines or plain[-1:] or ["no message"])[-1][:300]
    places = _PLACE.findall(text) if _MISTAKE.match(last) else []
    return f"{os.path.relpath(places[-1][0])}:{places[-1][1]}: {last}" if places else last


@pytest.hookimpl(tryfirst=True)
def pytest_load_initial_conftests(early_config: Any) -> None:
    """Start to observe, before any of the user's code is imported."""
    folder = os.environ.pop(VARIABLE, None)
    if folder is None:
        return
    observation = ProcessObservation(folder)
    observation.wake()
    observation.install()
    problems = []
    try:
        prepare(observation.job.root, os.path.dirname(folder), None)
    except MutabotError as error:  # what the tests see all the same is worth having
        problems.append(str(error))
    early_config.pluginmanager.register(_ObservationHooks(observation, problems), "mutabot-observation")
