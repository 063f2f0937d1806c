import pytest
from robot import Robot


@pytest.fixture(scope="session")
def robot():
    return Robot()
