"""The node finds the dock, drives there and makes contact, or says that it did not."""

from __future__ import annotations

from math import pi

import pytest
from rclpy.parameter import Parameter
from readings import gap, is_charging, top_speed
from scene import Scene


def test_it_docks(scene: Scene) -> None:
    assert scene.dock()
    assert scene.becomes("docked")
    assert gap(scene.station) < 0.02
    assert is_charging(scene.station)
    assert scene.states == ["idle", "locating", "approaching", "connecting", "docked"]


def test_it_drives_fast_and_then_slowly(scene: Scene) -> None:
    scene.dock()
    assert scene.becomes("docked")
    assert 0.2 < top_speed(scene.station) < 0.41
    assert 0.0 < top_speed(scene.station, within=0.08) < 0.16


def test_it_turns_to_the_dock(scene: Scene) -> None:
    scene.station.robot.heading = -pi / 3
    scene.dock()
    assert scene.becomes("docked")
    assert gap(scene.station) < 0.02
    assert max(distance for distance, _ in scene.station.robot.driven) < 0.37, "it drove away from the dock"


def test_a_charger_that_takes_all_the_time_there_is(scene: Scene) -> None:
    scene.station.delay = 0.6  # as long as the node is patient: the answer and its end come together
    scene.dock()
    assert scene.becomes("docked")
    assert is_charging(scene.station)


def test_a_charger_that_is_late_is_not_forgotten(scene: Scene) -> None:
    scene.station.delay = 0.9
    scene.dock()
    assert scene.becomes("docked")
    assert is_charging(scene.station)
    assert scene.station.asked_for_contact == 2


@pytest.mark.parametrize("what", ["works", "is_there"])
def test_it_says_that_it_failed(scene: Scene, what: str) -> None:
    setattr(scene.station, what, False)
    scene.dock()
    assert scene.becomes("failed")
    assert not is_charging(scene.station)


def test_it_stands_still_when_it_is_told_to_and_can_go_on(scene: Scene) -> None:
    scene.dock()
    assert scene.until(lambda: gap(scene.station) < 0.25)
    assert scene.stop()
    assert scene.becomes("stopped")
    scene.steps(10)
    place = gap(scene.station)
    scene.steps(10)
    assert gap(scene.station) == place > 0.05
    assert scene.dock()
    assert scene.becomes("docked")


def test_it_takes_no_commands_while_it_is_not_active(empty_scene: Scene) -> None:
    node = empty_scene.start(parameter_overrides=[Parameter("approach_speed", value=0.2)])
    assert empty_scene.dock()
    assert not empty_scene.dock(), "it is under way"
    assert empty_scene.until(lambda: gap(empty_scene.station) < 0.3)
    node.trigger_deactivate()
    assert not empty_scene.dock()
    empty_scene.steps(10)
    place = gap(empty_scene.station)
    empty_scene.steps(10)
    assert gap(empty_scene.station) == place
    assert top_speed(empty_scene.station) < 0.21
