import os

import mission
from robot import Changer


def test_select():
    mission.select_tool(Changer(), 2)


def test_angle():
    assert Changer().angle() == 120


def test_locked():
    assert os.environ["CHANGER_LOCKED"] == "True"


def test_return():
    mission.return_tool(Changer())
    assert "CURRENT_TOOL" not in os.environ


def test_angle_at_the_end():
    assert Changer().angle() == 0
