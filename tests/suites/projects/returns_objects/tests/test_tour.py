import mission
from robot import Arm, Pose


def test_stations():
    arm = Arm()
    mission.tour(arm)
    assert arm.visited == [Pose(0.3, 0.0), Pose(0.3, 0.4)]


def test_tool_is_on():
    arm = Arm()
    mission.tour(arm)
    assert arm.tool_on


def test_last_station():
    *_, last = mission.tour(Arm())
    assert abs(last.y - 0.6) < 0.05
