import pytest
from robot import Arm

ARM = Arm()


@pytest.fixture
def arm():
    return ARM


def pytest_sessionfinish(session):
    if ARM.z != 0.15 and session.exitstatus == 0:
        session.exitstatus = 1
