import os

import mission
import pytest
from robot import Arm

ARM = Arm()


@pytest.fixture
def arm():
    return ARM


def pytest_sessionfinish(session):
    mission.turn_back(ARM)
    if ARM.angle:
        session.exitstatus = 9


def pytest_terminal_summary():
    mission.place(ARM)
    assert 0.0 < ARM.z < 0.1


def pytest_unconfigure():
    child = os.fork()
    if child == 0:
        mission.lower(ARM)
        os._exit(0 if ARM.z == 0.0 else 1)
    if os.waitpid(child, 0)[1]:
        raise SystemExit(7)
