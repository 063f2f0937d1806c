import os

import mission
from robot import Arm

PROCESS, PARENT = os.getpid(), os.getppid()


def test_step():
    assert mission.step(Arm()) == 1.0


def test_who():
    arm = Arm()
    assert mission.who(arm) == (PROCESS, PARENT)
    assert arm.closed
