"""Campaigns over the simulation: which projects use it, and how their tests run over it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

from mutabot.api.processes import SimulatedMiddleware, Table
from mutabot.api.reports import UsageError
from mutabot_ros._mentions import mentions

#: the plug-in of campaigns, and that of the simulation alone
PLUGIN, PLAIN_PLUGIN = "mutabot_ros.simulation.plugin", "ros_in_process.plugin"
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
    clock = "ros_in_process.machine.scheduler:Scheduler.advanced"

    def arguments(
        self, root: Path, given: Sequence[str], tables: Mapping[str, Table]
    ) -> Sequence[str] | None:
        """Return arguments that add the plug-in, if the project uses the installed rclpy and lacks it."""
        if not self._is_used_by(root, given):
            return None
        table = _table(tables)
        if table.simulation == "never":
            raise UsageError('the configuration says simulation = "never"')
        if find_spec("greenlet") is None:
            raise UsageError("the package greenlet is not installed")
        order = [] if table.schedule == "first-in" else ["--ros-schedule", table.schedule]
        return ["-p", PLUGIN, *order]

    def draws(self, tables: Mapping[str, Table]) -> bool:
        """Return whether the order of callbacks is random."""
        return _table(tables).schedule != "first-in"

    def reason(self, message: str) -> str:
        """Return the simulation's own message if the simulation has failed."""
        found = _REASON.search(message)
        return found[1].strip() if found is not None else super().reason(message)

    @staticmethod
    def _is_used_by(root: Path, given: Sequence[str]) -> bool:
        is_own = (root / "rclpy").exists() or (root / "rclpy.py").exists()
        if find_spec("rclpy") is None or is_own or not mentions(str(root), "rclpy"):
            return False
        named = (*given, *_settings(root))
        return not any(plugin in text for text in named for plugin in (PLUGIN, PLAIN_PLUGIN))


def _table(tables: Mapping[str, Table]) -> RosTable:
    found = tables.get("ros", RosTable())
    assert isinstance(found, RosTable)
    return found


def _settings(root: Path) -> Iterator[str]:
    """Yield the settings of pytest that may name plug-ins."""
    for name in _SETTINGS:
        if (file := root / name).is_file():
            yield file.read_text(encoding="utf-8", errors="replace")
