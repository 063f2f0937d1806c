"""Values that the robot cannot tell apart: the mutant is left out, or has no effect at these calls."""

from __future__ import annotations

from pathlib import Path

from mutabot.campaign.checking import plan_only
from mutabot.model import Verdict
from tests.campaign.project import Quiet, by_forks, request_for, write_project

ROBOT = """
    class Arm:
        def __init__(self):
            self.told = []

        def turn_to(self, yaw):
            self.told.append(yaw)

        def turn_by(self, yaw):
            self.told.append(yaw)

        def turn_joint(self, angle):
            self.told.append(angle)

        def face(self, angles):
            self.told.append(angles)

        def go(self, position):
            self.told.append(position)
"""
MISSION = """
    def half_a_turn(arm):
        arm.turn_to(180)
        arm.turn_by(180)
        arm.turn_joint(180)

    def both(arm):
        for yaw in (180.0, 90.0):
            arm.turn_to(yaw)

    def flip(arm):
        arm.face([180.0, 0.0, 0.0])

    def shift(arm):
        arm.go([0, 0.25])
"""
TESTS = """
    import mission
    from robot import Arm

    def test_half_a_turn():
        mission.half_a_turn(Arm())

    def test_both():
        arm = Arm()
        mission.both(arm)
        assert [yaw % 360.0 for yaw in arm.told] == [180.0, 90.0]

    def test_flip():
        mission.flip(Arm())

    def test_shift():
        mission.shift(Arm())
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Arm.turn_to"
    arguments.yaw = { kind = "rotation", axis = "z", unit = "deg", mode = "to" }

    [[operation]]
    call = "robot:Arm.turn_by"
    arguments.yaw = { kind = "rotation", axis = "z", unit = "deg", mode = "by" }

    [[operation]]
    call = "robot:Arm.turn_joint"
    arguments.angle = { kind = "rotation", axis = "j6", unit = "deg", mode = "to" }

    [[operation]]
    call = "robot:Arm.face"
    arguments.angles = { kind = "euler", unit = "deg", order = "xyz" }

    [[operation]]
    call = "robot:Arm.go"
    arguments."position[0:2]" = { kind = "translation", axis = "xy", unit = "m", mode = "to" }
"""
BOTH = "mission.py:both:arm.turn_to#1:yaw:reverse"


def project(folder: Path) -> Path:
    return write_project(folder, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY)


def test_what_the_robot_cannot_distinguish_is_not_planned(tmp_path: Path) -> None:
    plan = plan_only(request_for(project(tmp_path)), Quiet())
    mutants, left_out = plan.mutants, plan.left_out
    planned = {mutant.id.split(":", 1)[1] for mutant in mutants if mutant.operator == "reverse"}
    reasons = {omission.id.split(":", 1)[1]: omission.reason for omission in left_out}
    assert "would change nothing" in reasons["half_a_turn:arm.turn_to#1:yaw:reverse"]
    assert "would change nothing" in reasons["flip:arm.face#1:angles:reverse"]
    # another motion, and another turn of the joint
    assert "half_a_turn:arm.turn_by#1:yaw:reverse" in planned
    assert "half_a_turn:arm.turn_joint#1:angle:reverse" in planned
    assert BOTH.split(":", 1)[1] in planned


def test_it_has_no_effect_at_these_calls_alone(tmp_path: Path) -> None:
    """The robot is sent what the program says there: 180, and then −90."""
    outcomes = by_forks(project(tmp_path))
    found = outcomes[BOTH, 0]
    assert found.verdict is Verdict.KILLED
    assert (found.hits, found.acted) == (2, 1)
    assert found.example == (90.0, -90.0)
    assert found.away == {"the value would stay the same": 1}
    assert "At index 1 diff: 270.0 != 90.0" in (found.message or "")
