import mission
import pytest
from robot import Controller, Link


@pytest.fixture(scope="module")
def controller():
    return Controller()


@pytest.fixture(scope="module")
def answer(controller):
    link = Link(controller.port)
    yield mission.load(link)
    link.close()


def test_answers(answer):
    assert answer in ("yes", "no")


def test_part_is_held(answer):
    assert answer == "yes"


def test_comes_back(controller, answer):
    assert controller.x == 0.0
