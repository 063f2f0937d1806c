import mission
import pytest


@pytest.fixture(scope="package")
def agv(fleet):
    mission.dock(fleet[0])
    return fleet[0]
