"""Values that are None: a camera sees no part, or an optional part of a message is left out."""

from __future__ import annotations

from pathlib import Path

from mutabot.campaign.run import run_campaign
from mutabot.model import Verdict
from tests.campaign.project import Quiet, outcomes, request_for, write_project

ROBOT = """
    class Part:
        x = 0.5

    class Arm:
        sees = False

        def locate(self):
            return Part() if self.sees else None

        def home(self):
            return "home"
"""
MISSION = """
    def work(arm):
        part = arm.locate()
        arm.home()
        return 0.0 if part is None else part.x
"""
TESTS = """
    import mission
    from robot import Arm

    def test_nothing_is_seen():
        assert mission.work(Arm()) == 0.0
"""
SEEN = """
    def test_a_part_is_seen():
        arm = Arm()
        arm.sees = True
        assert mission.work(arm) == 0.5
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Arm.locate"
    result.".x" = { kind = "position", axis = "x", unit = "m" }

    [[operation]]
    call = "robot:Arm.home"
"""


def verdicts(folder: Path, tests: str) -> tuple[dict[str, Verdict], list[str]]:
    """Return the verdicts by the end of the mutant's id, and what the user saw."""
    project = write_project(folder, MISSION, tests, robot=ROBOT, vocabulary=VOCABULARY)
    progress = Quiet()
    path = run_campaign(request_for(project), progress)
    found = {outcome.mutant.partition(":work:")[2]: outcome.verdict for outcome in outcomes(path)}
    return found, progress.lines


def test_a_reading_that_returns_none_in_all_tests_is_noted_and_the_others_are_judged(tmp_path: Path) -> None:
    found, lines = verdicts(tmp_path, TESTS)
    assert found["arm.home#1:call:skip"] is Verdict.SURVIVED
    assert not any(name.startswith("arm.locate") and ".x" in name for name in found)
    assert any("NoneType has no .x" in line for line in lines)


def test_a_reading_that_returns_none_in_one_test_has_the_mutants_of_another(tmp_path: Path) -> None:
    found, lines = verdicts(tmp_path, TESTS + SEEN)
    assert Verdict.KILLED in {verdict for name, verdict in found.items() if name.startswith("arm.locate")}
    assert not any("NoneType" in line for line in lines)


def test_a_part_of_an_argument_that_is_left_out_has_no_mutants_and_the_others_are_judged(
    tmp_path: Path,
) -> None:
    robot = """
        from dataclasses import dataclass

        @dataclass
        class Target:
            pose: tuple | None = None
            joint: float = 0.0

        class Arm:
            def go_to(self, target):
                self.joint = target.joint
    """
    mission = """
        from robot import Target

        def work(arm):
            arm.go_to(Target(joint=0.5))
            return arm.joint
    """
    tests = """
        import mission
        from robot import Arm

        def test_work():
            assert mission.work(Arm()) == 0.5
    """
    vocabulary = """
        [[operation]]
        call = "robot:Arm.go_to"
        arguments."target.pose[0]" = { kind = "translation", axis = "x", unit = "m", mode = "to" }
        arguments."target.joint" = { kind = "rotation", unit = "rad", mode = "to" }
    """
    project = write_project(tmp_path, mission, tests, robot=robot, vocabulary=vocabulary)
    progress = Quiet()
    path = run_campaign(request_for(project), progress)
    found = {outcome.mutant.partition(":work:")[2]: outcome.verdict for outcome in outcomes(path)}
    assert found["arm.go_to#1:target.joint:reverse"] is Verdict.KILLED
    assert not any("pose" in name for name in found)
    assert any("NoneType has no [0]" in line for line in progress.lines)
