import mission
import pytest
from robot import Sprayer

SPRAYER = Sprayer()


@pytest.fixture(scope="module", autouse=True)
def painted():
    mission.paint(SPRAYER)
    yield
    SPRAYER.__init__()
