"""Suites that put mocks in the place of operations, and of what we use ourselves, are judged like others."""

from __future__ import annotations

from pathlib import Path

import pytest

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
    assert {one.verdict for one in found.values()} <= {Verdict.KILLED, Verdict.SURVIVED, Verdict.NO_EFFECT}


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
    """
    found = run(write_project(tmp_path, MISSION, tests))
    assert {one.verdict for one in found.values()} >= {Verdict.KILLED}


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
    (negated,) = [one for one in found.values() if one.mutant.endswith("negate")]
    assert (negated.verdict, negated.hits) == (Verdict.KILLED, 1)
