"""Configures the simulation for mutabot's campaigns."""

from __future__ import annotations

from typing import Any

from ros_in_process.settings import PACKAGES, SETTINGS


def configure() -> None:
    """Configure the simulation for this process, before it may start; no effect without simulation.

    What mutabot itself waits for takes place in real time, but for what its hooks let nodes wait for. Each
    round has orders of its own. A test that met what is not simulated decides nothing.
    """
    PACKAGES.update({"mutabot": False, "mutabot_ros": False, "mutabot_ros.ros2": True})
    SETTINGS.is_strict = True
    SETTINGS.seed_of = _seed_of_round


def _seed_of_round(item: Any) -> int:
    from mutabot.api.processes import seed_of  # noqa: PLC0415  # pytest imports its plug-in first

    return seed_of(item)
