import mission
import pytest
from robot import Spindle


@pytest.fixture(scope="session")
def spindle():
    return Spindle()


@pytest.fixture(scope="session")
def warm(spindle):
    mission.warm_up(spindle)
