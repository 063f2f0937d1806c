import pytest
from robot import Disc


@pytest.fixture(scope="module")
def disc():
    return Disc()


@pytest.fixture(autouse=True)
def monitor(disc):
    yield
    assert not disc.events, "the part is scratched"
