"""Suites that put mocks in the place of operations, and of what we use ourselves, are judged like others."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.errors import UnknownNameError
from mutabot.model import Verdict
from tests.campaign.project import REPLAY, run, write_project

MISSION = "def run(arm):\n    arm.move_by(0.25)\n    arm.move_by(-0.5)\n    return arm.position()\n"
TESTS = """
    import time
    from unittest import mock

    import mission
    from robot import Arm

    def test_plain():
        arm = Arm()
        mission.run(arm)
        assert arm.x == -0.25

    def test_of_mocks():
        with mock.patch.object(Arm, "move_by", autospec=True) as fake:
            mission.run(Arm())
        assert fake.call_count == 2

    def test_without_an_operation(monkeypatch):
        monkeypatch.delattr(Arm, "position")
        arm = mock.create_autospec(Arm, instance=True)
        arm.position = lambda: 4
        assert mission.run(arm) == 4

    def test_that_leaves_what_it_has_put_there():
        time.perf_counter = lambda: None
        Arm.position = mock.Mock(return_value=4)
        assert mission.run(Arm()) == 4
"""


@pytest.mark.parametrize("engine", ["auto", REPLAY])
def test_mocks_end_no_campaign(tmp_path: Path, engine: str) -> None:
    found = run(write_project(tmp_path, MISSION, TESTS), engine=engine)
    assert found
    assert {outcome.verdict for outcome in found.values()} <= {
        Verdict.KILLED,
        Verdict.SURVIVED,
        Verdict.NO_EFFECT,
    }


def test_looking_at_what_mocks_answer_calls_no_mock(tmp_path: Path) -> None:
    tests = """
        from unittest import mock

        import mission
        from robot import Arm

        def test_an_answer_that_is_a_mock():
            arm = mock.MagicMock(spec=Arm)
            mission.run(arm)
            assert arm.mock_calls == [mock.call.move_by(0.25), mock.call.move_by(-0.5), mock.call.position()]

        def test_a_class_that_is_specified():
            with mock.patch("robot.Arm", autospec=True) as fake:
                mission.run(fake())
            fake.return_value.move_by.assert_called_with(-0.5)
            assert fake.return_value.move_by.mock_calls == [mock.call(0.25), mock.call(-0.5)]

        def test_mocks_that_claim_to_be_functions():
            arm = mock.Mock(spec_set=Arm)
            arm.move_by = mock.MagicMock(spec=lambda *given: None)
            arm.position = mock.MagicMock(spec=Arm().position)
            mission.run(arm)
            assert arm.move_by.mock_calls == [mock.call(0.25), mock.call(-0.5)]
            assert arm.position.mock_calls == [mock.call()]
    """
    found = run(write_project(tmp_path, MISSION, tests))
    assert {outcome.verdict for outcome in found.values()} >= {Verdict.KILLED}


def test_a_mock_in_the_place_of_a_property_is_read_by_the_mutant(tmp_path: Path) -> None:
    robot = """
        class Drone:
            def __init__(self):
                self.flown = []

            @property
            def altitude(self):
                return 3.0

            @altitude.setter
            def altitude(self, height):
                self.flown.append(height)
    """
    mission = """
        def climb(drone):
            drone.altitude = 4.0
            return drone.altitude > 2.0
    """
    tests = """
        from unittest import mock

        import mission
        from robot import Drone

        def test_of_a_mock():
            with mock.patch.object(Drone, "altitude", new_callable=mock.PropertyMock, return_value=5.0) as it:
                assert mission.climb(Drone())
            assert it.mock_calls == [mock.call(4.0), mock.call()]
    """
    vocabulary = """
        [[operation]]
        call = "robot:Drone.altitude"
        result = { kind = "position", axis = "z", unit = "m" }
    """
    found = run(write_project(tmp_path, mission, tests, robot=robot, vocabulary=vocabulary))
    (negated,) = [result for result in found.values() if result.mutant.endswith("negate")]
    assert (negated.verdict, negated.hits) == (Verdict.KILLED, 1)


TURN = """
    class Arm:
        def turn(self, roll):
            self.roll = roll
"""
TO = """
    [[operation]]
    call = "robot:Arm.turn"
    arguments.roll = { kind = "rotation", axis = "x", unit = "deg", mode = "to" }
"""
MOCK = """
    from unittest.mock import Mock

    import mission
    from robot import Arm

    def test_it():
        arm = Mock(spec=Arm)
        mission.run(arm)
        arm.turn.assert_called_once_with(180.0)
"""
FAKE = """
    import mission
    from robot import Arm

    class Fake(Arm):
        def turn(self, roll):
            self.rolls = [roll]

    def test_it():
        arm = Fake()
        mission.run(arm)
        assert arm.rolls == [180.0]
"""
REAL = """
    import mission
    from robot import Arm

    def test_it():
        mission.run(Arm())
"""


@pytest.mark.parametrize("tests", [MOCK, FAKE], ids=["a mock", "a fake"])
def test_half_a_turn_the_other_way_is_a_fault_to_a_test_that_compares_numbers(
    tmp_path: Path, tests: str
) -> None:
    mission = "def run(arm):\n    arm.turn(180.0)\n"
    found = run(write_project(tmp_path, mission, tests, robot=TURN, vocabulary=TO))
    (turned,) = [result for result in found.values() if result.mutant.endswith("reverse")]
    assert (turned.verdict, turned.example) == (Verdict.KILLED, (180.0, -180.0))


def test_half_a_turn_the_other_way_is_the_same_to_a_robot(tmp_path: Path) -> None:
    mission = "def run(arm):\n    arm.turn(180.0)\n"
    found = run(write_project(tmp_path, mission, REAL, robot=TURN, vocabulary=TO))
    assert not [result for result in found.values() if result.mutant.endswith("reverse")]


#: of the standard library, which ours use as well
REPLACED = ("os.write", "os.fstat", "os.open", "json.dumps", "json.loads", "builtins.open", "time.monotonic")
REPLACING = """
    from unittest import mock

    import mission
    import pytest
    from robot import Arm

    @pytest.mark.parametrize("name", {names})
    @pytest.mark.parametrize("answer", [None, OSError("no")])
    def test_goes(name, answer):
        with mock.patch(name, side_effect=answer):
            arm = Arm()
            mission.go(arm)
"""


@pytest.mark.parametrize("engine", ["auto", REPLAY])
def test_functions_that_tests_replace_are_not_those_that_name_them(tmp_path: Path, engine: str) -> None:
    mission = "def go(arm): arm.move_by(0.25)\n"
    folder = write_project(tmp_path, mission, REPLACING.format(names=REPLACED))
    found = run(folder, engine=engine, only=("skip", "repeat"))
    assert {outcome.verdict for outcome in found.values()} == {Verdict.SURVIVED}


PLACEHOLDERS = """
    from unittest import mock

    import mission
    from robot import Arm

    def test_that_hands_on_what_nobody_looks_into():
        arm = mock.create_autospec(Arm, instance=True)
        arm.where.return_value = mock.sentinel.there
        assert mission.go(arm, mock.sentinel.pose, "fast") is mock.sentinel.there
        arm.go_to.assert_called_once_with(mock.sentinel.pose, mode="fast")

    def test_a_text_in_the_place_of_a_pose():
        arm = mock.Mock(spec=Arm)
        mission.go(arm, "POSE", object())
        assert arm.mock_calls[0].args == ("POSE",)
"""


def test_a_mock_may_be_given_what_the_vocabulary_does_not_describe(tmp_path: Path) -> None:
    robot = """
        class Arm:
            def go_to(self, pose, mode="by"):
                self.x = pose.x

            def where(self):
                return self
    """
    mission = """
        def go(arm, pose, mode):
            arm.go_to(pose, mode=mode)
            return arm.where()
    """
    vocabulary = """
        [[operation]]
        call = "robot:Arm.go_to"
        arguments."pose.x" = { kind = "translation", axis = "x", unit = "m", mode = \
{ argument = "mode", by = "by", to = "to" } }

        [[operation]]
        call = "robot:Arm.where"
        result.".x" = { kind = "position", axis = "x", unit = "m" }
    """
    project = write_project(tmp_path, mission, PLACEHOLDERS, robot=robot, vocabulary=vocabulary)
    found = {result.mutant.rpartition(":")[2]: result.verdict for result in run(project).values()}
    assert found == {"repeat": Verdict.KILLED, "skip": Verdict.KILLED}


ITEMS_OF_MOCKS = """
    from unittest import mock

    import mission
    from robot import Arm

    def test_that_looks_at_all_calls_of_a_mock():
        arm, path = mock.MagicMock(spec=Arm), mock.MagicMock()
        mission.go(arm, path)
        assert arm.mock_calls == [mock.call.follow(path), mock.call.log("done")]
        assert path.mock_calls == []
"""


def test_a_path_asks_a_mock_for_no_item_which_would_be_a_call_of_it(tmp_path: Path) -> None:
    robot = """
        class Arm:
            def follow(self, path):
                self.x = path[-1]

            def log(self, text):
                return text
    """
    mission = """
        def go(arm, path):
            arm.follow(path)
            arm.log("done")
    """
    vocabulary = """
        [[operation]]
        call = "robot:Arm.follow"
        arguments."path[-1]" = { kind = "translation", axis = "x", unit = "m", mode = "to" }
    """
    project = write_project(tmp_path, mission, ITEMS_OF_MOCKS, robot=robot, vocabulary=vocabulary)
    found = {result.mutant.rpartition(":")[2]: result.verdict for result in run(project).values()}
    assert found == {"repeat": Verdict.KILLED, "skip": Verdict.KILLED}


def test_a_misspelt_step_is_refused_where_tests_have_fakes_alone(tmp_path: Path) -> None:
    robot = """
        from dataclasses import dataclass

        @dataclass
        class Pose:
            x: float

        class Arm:
            def go_to(self, pose):
                self.x = pose.x
    """
    mission = """
        from robot import Pose

        def go(arm):
            arm.go_to(Pose(0.5))
    """
    tests = """
        from unittest import mock

        import mission
        from robot import Arm

        def test_go():
            arm = mock.create_autospec(Arm, instance=True)
            mission.go(arm)
            assert arm.go_to.call_count == 1
    """
    vocabulary = """
        [[operation]]
        call = "robot:Arm.go_to"
        arguments."pose.xx" = { kind = "translation", axis = "x", unit = "m", mode = "to" }
    """
    project = write_project(tmp_path, mission, tests, robot=robot, vocabulary=vocabulary)
    with pytest.raises(UnknownNameError, match=r"did you mean '\.x'"):
        run(project)


COUNTING = """
    class Arm:
        def __init__(self):
            self.x, self.asked = 0.0, 0

        def move_by(self, dx):
            self.x += dx

        def position(self):
            self.asked += 1
            return self.x
"""
WHERE = """
    [[operation]]
    call = "robot:Arm.move_by"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
    current = "robot:Arm.position"

    [[operation]]
    call = "robot:Arm.position"
    result = { kind = "position", axis = "x", unit = "m" }
"""


@pytest.mark.parametrize("engine", ["auto", REPLAY])
@pytest.mark.parametrize(
    ("test", "verdict"),
    [
        ("assert arm.x == 0.25 and arm.asked == 0", Verdict.KILLED),
        ("assert arm.x == 0.25", Verdict.NO_EFFECT),
    ],
)
def test_a_robot_may_count_what_by_to_asks_it(
    tmp_path: Path, test: str, verdict: Verdict, engine: str
) -> None:
    """At zero, by and to agree: the amount stays, and only that the robot was asked can be seen."""
    tests = f"""
        import mission
        from robot import Arm

        def test_it():
            arm = Arm()
            mission.run(arm)
            {test}
    """
    mission = "def run(arm):\n    arm.move_by(0.25)\n"
    project = write_project(tmp_path, mission, tests, robot=COUNTING, vocabulary=WHERE)
    found = run(project, engine=engine)
    assert found["mission.py:run:arm.move_by#1:dx:by-to"].verdict is verdict


@pytest.mark.parametrize("engine", ["auto", REPLAY])
@pytest.mark.parametrize(
    "arm",
    [
        "mock.Mock()",
        "mock.Mock(**{'position.return_value': None})",
        "SimpleNamespace(move_by=print)",
        "SimpleNamespace(move_by=print, position=lambda: 'here')",
        "type('Fake', (Arm,), {'position': lambda self: [1.0]})()",
        "type('Fake', (Arm,), {'position': lambda self: 1 / 0})()",
    ],
)
def test_by_to_leaves_what_does_not_tell_where_it_is(tmp_path: Path, arm: str, engine: str) -> None:
    tests = f"""
        from types import SimpleNamespace
        from unittest import mock

        import mission
        from robot import Arm

        def test_the_robot():
            mission.run(Arm())

        def test_what_stands_in():
            mission.run({arm})
    """
    mission = "def run(arm):\n    arm.move_by(0.25)\n"
    project = write_project(tmp_path, mission, tests, robot=COUNTING, vocabulary=WHERE)
    found = run(project, engine=engine)["mission.py:run:arm.move_by#1:dx:by-to"]
    assert (found.verdict, found.hits) == (Verdict.NO_EFFECT, 2)
    assert "a mock or a fake stands here, and does not tell where it is" in found.away
