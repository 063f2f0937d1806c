"""Campaigns over the simulation: which projects use it, and how their tests are run over it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

from mutabot.campaign.campaign import Campaign
from mutabot.campaign.request import Request
from mutabot.campaign.simulation import SimulatedMiddleware
from mutabot.config.table import Table
from mutabot.errors import MutabotError, UsageError
from mutabot.execution.task import Result
from mutabot.model.operation import Clock
from mutabot_ros._speech import speaks_of

from .agreement import difference

#: the plug-in of campaigns, and that of the simulation alone
PLUGIN, PLAIN_PLUGIN = "mutabot_ros.simulation.plugin", "ros_in_process.plugin"
#: makes simulated time the time of budgets and reports, unless the vocabulary has a clock
CLOCK = Clock("ros_in_process.machine.scheduler:Scheduler.advanced", source="the simulation of ROS 2")
_SETTINGS = (
    "pyproject.toml",
    "pytest.ini",
    ".pytest.ini",
    "tox.ini",
    "setup.cfg",
    "conftest.py",
    "tests/conftest.py",
)
_REASON = re.compile(r"needs real ROS: (.+?)(?:; the original must run before mutants can)?$", re.MULTILINE)


class RosTable(Table):
    """For programs over [ROS](ros.md)."""

    simulation: Literal["auto", "never"] = "auto"
    """Whether campaigns run [in one process](ros.md#ros-2-in-one-process), in simulated time, if the original
    ends there as over real ROS 2. `"never"` means real ROS 2.

        simulation = "never"
    """
    schedule: Literal["first-in", "random"] = "first-in"
    """The order in which callbacks that are ready go on there. A random one is drawn for each round and test.

        schedule = "random"
    """


class Ros2Simulation(SimulatedMiddleware):
    """ROS 2 in one process."""

    name = "ros2"
    title = "a simulation of ROS 2"
    real = "real ROS 2"
    draws = False

    def adapt(self, request: Request) -> Request | None:
        """Put the plug-in before pytest's arguments, and the clock into the vocabulary."""
        if not self._is_of(request):
            return None
        table = request.configuration.tables.get("ros", RosTable())
        assert isinstance(table, RosTable)
        if table.simulation == "never":
            raise UsageError('the configuration says simulation = "never"')
        if find_spec("greenlet") is None:
            raise UsageError("the package greenlet is not installed")
        arguments = ["-p", PLUGIN]
        if table.schedule != "first-in":
            arguments += ["--ros-schedule", table.schedule]
        self.draws = table.schedule != "first-in"
        configuration = request.configuration
        changed = configuration.model_copy(update={"pytest_args": (*arguments, *configuration.pytest_args)})
        clock = request.vocabulary.clock or CLOCK
        return replace(request, configuration=changed, vocabulary=replace(request.vocabulary, clock=clock))

    def difference(
        self, real: Campaign, results: Sequence[Result], simulated: Sequence[Result]
    ) -> str | None:
        """See ``agreement.difference``."""
        return difference(real, results, simulated, draws=self.draws)

    def why(self, error: MutabotError) -> str:
        """The simulation's own words, if it was the simulation that failed."""
        found = _REASON.search(str(error))
        return found[1].strip() if found is not None else super().why(error)

    @staticmethod
    def _is_of(request: Request) -> bool:
        """Whether it is a project over the installed rclpy, and does not name the plug-in itself."""
        root = request.root
        is_own = (root / "rclpy").exists() or (root / "rclpy.py").exists()
        if find_spec("rclpy") is None or is_own or not speaks_of(str(root), "rclpy"):
            return False
        named = (*request.arguments, *_settings(root))
        return not any(plugin in text for text in named for plugin in (PLUGIN, PLAIN_PLUGIN))


def _settings(root: Path) -> Iterator[str]:
    """What may name plug-ins of pytest."""
    for name in _SETTINGS:
        if (file := root / name).is_file():
            yield file.read_text(encoding="utf-8", errors="replace")
