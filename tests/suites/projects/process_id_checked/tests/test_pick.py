import os
import subprocess
import sys

import mission
import pytest
from robot import Arm


@pytest.fixture(scope="module")
def arm():
    return Arm()


def test_pick_lifts(arm):
    mission.pick(arm)
    assert arm.z > 0.1


def test_a_process_below_knows_its_parent(arm):
    arm.turn(1.0)
    told = subprocess.run(
        [sys.executable, "-S", "-c", "import os; print(os.getppid())"], capture_output=True, text=True
    )
    assert int(told.stdout) == os.getpid()
    assert arm.angle < 100.0
