import mission
import pytest
from robot import STATE, Arm


@pytest.fixture(autouse=True, scope="module")
def clean():
    yield
    STATE.unlink()
    STATE.with_name("lamp.log").unlink()


def test_shuttle():
    mission.shuttle(Arm())


def test_state_file():
    assert STATE.read_text() == "3"


def test_lamp_was_lit_once():
    assert STATE.with_name("lamp.log").read_text() == "True\n"
