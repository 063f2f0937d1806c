"""Work cells simulated in MuJoCo: robot, gripper, sensors, scene.

Importing this package is cheap; MuJoCo is loaded when a name that needs it is first used. `SimulatorMissing`
says what to install when it is not there.
"""

from __future__ import annotations

import importlib
import os
import sys
from typing import TYPE_CHECKING

from .errors import (
    BadArgument as BadArgument,
)
from .errors import (
    BadModel as BadModel,
)
from .errors import (
    CellError as CellError,
)
from .errors import (
    ConditionBroken as ConditionBroken,
)
from .errors import (
    MotionRefused as MotionRefused,
)
from .errors import (
    PathLost as PathLost,
)
from .errors import (
    ProgramsStuck as ProgramsStuck,
)
from .errors import (
    ProtectiveStop as ProtectiveStop,
)
from .errors import (
    SensorError as SensorError,
)
from .errors import (
    SimulationDiverged as SimulationDiverged,
)
from .errors import (
    SimulatorMissing as SimulatorMissing,
)
from .parts import (
    Box as Box,
)
from .parts import (
    Cylinder as Cylinder,
)
from .parts import (
    Mesh as Mesh,
)
from .scene import (
    Belt as Belt,
)
from .scene import (
    DepthCamera as DepthCamera,
)
from .scene import (
    Fixture as Fixture,
)
from .scene import (
    LightBarrier as LightBarrier,
)
from .scene import (
    Mark as Mark,
)
from .scene import (
    Scene as Scene,
)

if TYPE_CHECKING:
    from . import robots as robots
    from .cell import Cell as Cell
    from .cell import current as current
    from .cell import world as world
    from .clock import simulated_time as simulated_time
    from .geometry import Pose as Pose
    from .geometry import Position as Position
    from .models.cup import suction_cup as suction_cup
    from .models.kinova import gen3 as gen3
    from .models.limits import Limits as Limits
    from .models.limits import ToolLimits as ToolLimits
    from .models.nozzle import nozzle as nozzle
    from .models.parts import read_mesh as read_mesh
    from .models.robot import RobotModel as RobotModel
    from .models.tool import Tool as Tool
    from .programs import run_together as run_together
    from .programs import until as until
    from .rendering import render as render

_LIBRARIES = ("mujoco", "numpy", "mink", "ruckig")
_LAZY = {
    "Cell": "cell",
    "current": "cell",
    "world": "cell",
    "simulated_time": "clock",
    "Pose": "geometry",
    "Position": "geometry",
    "gen3": "models.kinova",
    "read_mesh": "models.parts",
    "render": "rendering",
    "run_together": "programs",
    "until": "programs",
    "robots": "robots",
    "Limits": "models.limits",
    "RobotModel": "models.robot",
    "Tool": "models.tool",
    "ToolLimits": "models.limits",
    "nozzle": "models.nozzle",
    "suction_cup": "models.cup",
}


__all__ = [  # noqa: PLE0604  (the lazy names come from the table above)
    "BadArgument",
    "BadModel",
    "Belt",
    "Box",
    "CellError",
    "ConditionBroken",
    "Cylinder",
    "DepthCamera",
    "Fixture",
    "LightBarrier",
    "Mark",
    "Mesh",
    "MotionRefused",
    "PathLost",
    "ProgramsStuck",
    "ProtectiveStop",
    "Scene",
    "SensorError",
    "SimulationDiverged",
    "SimulatorMissing",
    *_LAZY,
]


def __getattr__(name: str) -> object:
    if name not in _LAZY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if "numpy" not in sys.modules:
        # A cell has no use for a pool of linear-algebra threads: a process with threads is not safe to fork.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        module = importlib.import_module(f".{_LAZY[name]}", __name__)
    except ModuleNotFoundError as error:
        if error.name in _LIBRARIES:
            raise SimulatorMissing(error.name) from error
        raise
    value = module if name == _LAZY[name] else getattr(module, name)
    globals()[name] = value
    return value
