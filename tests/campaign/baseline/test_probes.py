"""Probes in campaigns: what cannot be read is refused or told, and never counts as equal."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.checking import check
from mutabot.campaign.preparation import begin, locked_executor
from mutabot.campaign.run import run_campaign
from mutabot.errors import ConfigurationError
from mutabot.model import Outcome, Verdict
from tests.campaign.project import ROBOT, VOCABULARY, Quiet, by_forks, request_for, write_project

MISSION = """
    def run(arm):
        arm.move_by(0.25)
        arm.move_by(-0.125)
"""
TESTS = """
    import mission
    from robot import Arm

    def test_it_runs():
        mission.run(Arm())
"""


def project(folder: Path, probe: str, *, tests: str = TESTS, robot: str = ROBOT, more: str = "") -> Path:
    vocabulary = VOCABULARY + f'\n    [[probe]]\n    call = "{probe}"\n    tolerance = 0.001\n'
    files = {"world.py": more} if more else None
    return write_project(folder, MISSION, tests, robot=robot, vocabulary=vocabulary, more=files)


@pytest.mark.parametrize(
    ("probe", "words"),
    [
        ("robot:Arm.move_by", "it needs dx; a probe is called without arguments"),
        ("robot:Arm.positoin", "Arm has no 'positoin'; did you mean 'position'?"),
        ("world:box", "no test has imported its module 'world'"),
        ("robot:Broken.x", "no object of Broken is known"),
        ("robot:broken", "RuntimeError: the camera is off"),
        ("robot:silent", "it reads nothing (None)"),
    ],
)
def test_a_probe_that_no_test_can_read_is_refused(tmp_path: Path, probe: str, words: str) -> None:
    robot = ROBOT + "\n    def broken():\n        raise RuntimeError('the camera is off')\n"
    robot += "\n    def silent():\n        pass\n"
    folder = project(tmp_path, probe, robot=robot, more="def box():\n    return 1.0\n")
    request = request_for(folder, engine="fork")
    with pytest.raises(ConfigurationError) as caught:
        (run_campaign if probe == "world:box" else check)(request, Quiet())
    assert f"{probe} cannot be read at the end of any test" in str(caught.value)
    assert words in str(caught.value)
    assert str(caught.value).startswith(f"robot.toml:14 · {probe} · call")


def test_each_reason_why_tests_cannot_read_a_probe_is_said(tmp_path: Path) -> None:
    robot = ROBOT.replace("class Arm:", "class Arm:\n        async def later(self):\n            pass\n")
    tests = (
        TESTS + "\n    from unittest.mock import Mock\n\n    def test_mock():\n        mission.run(Mock())\n"
    )
    folder = project(tmp_path, "robot:Arm.later", robot=robot, tests=tests)
    with pytest.raises(ConfigurationError) as caught:
        check(request_for(folder), Quiet())
    why = str(caught.value)
    assert "it is a coroutine function; a probe must be a plain function (1 test)" in why
    assert "no object of Arm is known: the test makes none, and calls none (1 test)" in why


def test_a_method_is_read_from_the_object_that_the_program_uses(tmp_path: Path) -> None:
    """The mutant ends elsewhere, which nobody checks: it must not look as if nothing had happened."""
    found = by_forks(project(tmp_path, "robot:Arm.position"))
    reverse = outcome(found, "move_by#1:dx:reverse")
    assert reverse.verdict is Verdict.SURVIVED
    assert reverse.distance == pytest.approx(500)
    assert reverse.divergence[0] == "Arm.position: -0.375 instead of 0.125 (off by 0.5)"
    assert reverse.indistinguishable is False


@pytest.mark.whole
def test_errors_at_both_sides_are_not_equal_worlds(tmp_path: Path) -> None:
    """In the test that judges it the probe cannot be read, neither with the mutant nor without."""
    tests = """
        import mission
        import robot

        def test_with_the_camera():
            robot.camera = 1.0
            robot.Arm().position()

        def test_without_the_camera():
            robot.camera = None
            mission.run(robot.Arm())
    """
    reads = (
        "camera = None\n    calls = []\n    def look():\n        return camera + 1.0\n    def run_twice(arm):"
    )
    robot = ROBOT + f"\n    {reads}\n        arm.position()\n"
    tests = tests.replace("robot.Arm().position()", "mission.look(robot.Arm())")
    folder = project(tmp_path, "robot:look", tests=tests, robot=robot)
    mission = folder / "mission.py"
    mission.write_text(mission.read_text() + "\ndef look(arm):\n    arm.position()\n")
    found = by_forks(folder)
    reverse = outcome(found, "move_by#1:dx:reverse")
    assert reverse.verdict is Verdict.SURVIVED
    assert (reverse.indistinguishable, reverse.distance, reverse.divergence) == (None, None, ())
    assert "look cannot be read: TypeError" in reverse.gaps[0]
    progress = Quiet()
    check(request_for(folder), progress)
    told = [line for line in progress.lines if "cannot be read in 1 of 2 tests" in line]
    assert len(told) == 1


def test_a_probe_that_only_the_mutant_cannot_read_is_another_world(tmp_path: Path) -> None:
    robot = ROBOT + "\n    class Sensor:\n        pass\n"
    robot += "\n    ARM = Arm()\n    def ahead():\n        if ARM.x < 0: raise ValueError('nothing there')\n"
    robot += "        return ARM.x\n"
    tests = TESTS.replace("Arm()", "ARM").replace("import Arm", "import ARM")
    found = by_forks(project(tmp_path, "robot:ahead", tests=tests, robot=robot))
    reverse = outcome(found, "move_by#1:dx:reverse")
    assert reverse.indistinguishable is False
    assert "ahead: cannot be read, as it could be in the original: ValueError" in reverse.divergence[0]


def outcome(found: dict[tuple[str, int], Outcome], part: str) -> Outcome:
    return next(value for (mutant, _), value in found.items() if part in mutant)


def test_a_probe_of_a_class_reads_the_object_of_the_present_test(tmp_path: Path) -> None:
    """No test calls an operation on it, and objects of earlier tests live on in a global and in fixtures."""
    robot = ROBOT + "\n    def move(arm, dx):\n        arm.x += dx\n"
    mission = "import robot\n\ndef run(arm, dx):\n    robot.move(arm, dx)\n"
    tests = """
        import unittest
        import pytest
        import mission
        from robot import Arm

        KEPT = []

        @pytest.fixture(scope="session")
        def shared():
            return {"left": Arm(0.5)}

        def test_a_keeps_an_arm():
            KEPT.append(Arm(0.125))
            mission.run(KEPT[0], 0.125)

        def test_b_makes_the_fixture(shared):
            mission.run(shared["left"], 0.0)

        def test_c_uses_the_fixture_again(shared):
            mission.run(shared["left"], 0.25)

        def test_d_has_no_arm():
            mission.run(KEPT[0], 0.0)

        class TestE(unittest.TestCase):
            @classmethod
            def setUpClass(cls):
                cls.arm = Arm(0.75)

            def test_1(self):
                mission.run(self.arm, 0.0)

            def test_2(self):
                mission.run(self.arm, 0.125)
    """
    vocabulary = VOCABULARY.replace("robot:Arm.move_by", "robot:move") + (
        '\n    [[probe]]\n    call = "robot:Arm.x"\n    tolerance = 0.001\n'
    )
    write_project(tmp_path, mission, tests, robot=robot, vocabulary=vocabulary)
    request = request_for(tmp_path, rounds=1)
    with locked_executor(request, Quiet()) as executor:
        campaign, _ = begin(request, executor, Quiet())
    seen = {
        test.rpartition("::")[2]: dict(observation.probes)
        for (_, test), observation in campaign.baseline.observations.items()
    }
    assert seen == {
        "test_a_keeps_an_arm": {"robot:Arm.x": 0.25},
        "test_b_makes_the_fixture": {"robot:Arm.x": 0.5},
        "test_c_uses_the_fixture_again": {"robot:Arm.x": 0.75},
        "test_d_has_no_arm": {},
        "test_1": {"robot:Arm.x": 0.75},
        "test_2": {"robot:Arm.x": 0.875},
    }
