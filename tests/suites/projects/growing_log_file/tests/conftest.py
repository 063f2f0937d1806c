import mission
import pytest
from robot import Agv


@pytest.fixture(scope="session")
def log(tmp_path_factory):
    return tmp_path_factory.mktemp("logs") / "shop.log"


@pytest.fixture(scope="session")
def logger(log):
    return mission.make_logger(log)


@pytest.fixture
def agv():
    return Agv()
