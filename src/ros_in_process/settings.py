"""Settings that a program may change before or while the simulation runs.

This module imports nothing: it can be set in a process that may never simulate anything.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

#: packages and modules, by their dotted names, to whether they see simulated modules, wherever they are
#: installed. The longest name counts. Packages of ROS that wait take part in simulated time.
PACKAGES: dict[str, bool] = {
    **dict.fromkeys(
        ("rclpy", "tf2_ros", "message_filters", "nav2_simple_commander", "rclpy_message_converter"), True
    ),
    "ros_in_process": False,
}


class PluginSettings:
    """Settings of the pytest plug-in.

    Attributes:
        is_strict: whether a test fails that met what is not simulated, even where the program caught the
            error.
        seed_of: gives a number for a pytest item; random orders of its test are drawn from it, from the
            option ``--ros-seed`` and from the test's name.
    """

    is_strict: bool = False
    seed_of: Callable[[Any], int] = staticmethod(lambda item: 0)


SETTINGS = PluginSettings()
