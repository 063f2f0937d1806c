import json

import mission
import pytest
from robot import Arm


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    return tmp_path_factory.mktemp("points") / "points.json"


def test_1_teach(points):
    mission.teach(Arm(), points)
    assert points.exists()


def test_2_three_points(points):
    assert len(json.loads(points.read_text())) == 3


def test_3_last_point(points):
    assert json.loads(points.read_text())[-1] == 0.25


def test_4_playback(points):
    arm = Arm()
    mission.playback(arm, points)
    assert arm.braked
