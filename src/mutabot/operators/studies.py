"""How often each class of bugs was counted in public studies, by which operators say what they stand for."""

from __future__ import annotations

_STUDIES = "of the bugs on commands and readings in studies of ROS and PX4/ArduPilot software"
TIMING = f"timing and order are 28 {_STUDIES}"
SENSORS = f"sensor dropouts and misreadings are 20 {_STUDIES}"
PARAMETERS = f"parameters are 14 {_STUDIES}"
COMMANDS = f"missing and duplicated commands are 13 {_STUDIES}"
FRAMES = f"frames are 9 {_STUDIES}"
SIGNS = f"signs are 4 {_STUDIES}"
UNITS = f"units are 2 {_STUDIES}"
