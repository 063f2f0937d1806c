"""A pytest plug-in that observes one plain run of a suite: ``-p mutabot.runtime.observation_plugin``."""

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
    """Pytest's hooks, which write down observations and the outcomes of tests."""

    def __init__(self, observation: ProcessObservation, problems: list[str]) -> None:
        self._observation, self._problems = observation, problems
        self._outcomes: dict[str, str] = {}
        self._written = time.monotonic()

    def pytest_collectreport(self, report: Any) -> None:
        """Note a file that cannot be collected."""
        self._note(report)

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Note a finished phase of a test."""
        self._note(report)
        if report.when == "call" or report.outcome != "passed":
            self._outcomes[report.nodeid] = report.outcome

    def _note(self, report: Any) -> None:
        problem = f"{report.nodeid}: {_last_line(report.longreprtext)}" if report.failed else ""
        if problem and problem not in self._problems:
            self._problems.append(problem)

    def pytest_runtest_logfinish(self) -> None:
        """Write down observations after a test, since the run may be cut short in the next one."""
        if time.monotonic() - self._written > _PAUSE:
            self._write()

    def pytest_sessionfinish(self) -> None:
        """Write down all observations."""
        self._write()

    def _write(self) -> None:
        outcomes = list(self._outcomes.values())
        counts = {outcome: outcomes.count(outcome) for outcome in dict.fromkeys(outcomes)}
        problems = self._problems[:_MOST_PROBLEMS]
        self._observation.write(TESTS, outcomes=counts, problems=problems)
        self._written = time.monotonic()


def _last_line(text: str) -> str:
    """Return the most informative line of a traceback; for an error in a file, with its file and line."""
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
