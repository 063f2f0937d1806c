import builtins

import mission
from robot import Arm


def test_pick_runs():
    builtins.cell_arm = Arm()
    mission.pick(cell_arm)  # noqa: F821  # it is one
