import os

import mission
import pytest
from robot import Arm

ARM = Arm()


@pytest.fixture
def arm():
    return ARM


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(exitstatus):
    mission.place(ARM)
    os._exit(int(exitstatus) or (ARM.z != 0.0))
