import pytest
from robot import Arm, Controller


@pytest.fixture(scope="session")
def controller():
    with Controller() as controller:
        yield controller


@pytest.fixture
def arm(controller):
    return Arm(controller)
