import pytest

pytestmark = pytest.mark.usefixtures("warm")


def test_is_warm():
    pass


def test_speed(spindle):
    assert spindle.speed == 600


class TestSteps:
    def test_three(self, spindle):
        assert spindle.steps == 3
