import pytest
from robot import Agv


@pytest.fixture(scope="session")
def fleet():
    return [Agv(), Agv()]


@pytest.fixture
def agv(fleet):
    return fleet[1]
