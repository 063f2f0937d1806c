"""The steps of the published scenario.

They say "cm" but compare metres, as published (see the README).
"""

from __future__ import annotations

import pytest
import tracker
from expected import HOME, ON_CONVEYOR, TARGETS, is_within
from processes import start
from pytest_bdd import given, parsers, scenarios, then, when
from rclpy.node import Node
from sensors import box_end_position, box_start_position, robot_home_position

from mutabot_cell import Position

scenarios("features/mission.feature")


@pytest.fixture
def target(cell: Node) -> Position:
    """Where the box of this round belongs; world frame, m."""
    return TARGETS["red" if tracker.color() % 2 == 0 else "blue"]


@given("the system is initialised")
def system_is_initialised(cell: Node) -> None:
    assert cell.context.ok()


@given("the conveyor is initialised")
def conveyor_is_initialised(cell: Node) -> None:
    assert tracker.color() in range(1, 11)


@given(parsers.parse("the robot is at home within {threshold:f} cm in x"))
def robot_is_at_home_in_x(threshold: float) -> None:
    assert is_within(HOME.x, robot_home_position().x, threshold)


@given(parsers.parse("the robot is at home within {threshold:f} cm in y"))
def robot_is_at_home_in_y(threshold: float) -> None:
    assert is_within(HOME.y, robot_home_position().y, threshold)


@given(parsers.parse("the robot is at home within {threshold:f} cm in z"))
def robot_is_at_home_in_z(threshold: float) -> None:
    assert is_within(HOME.z, robot_home_position().z, threshold)


@given(parsers.parse("the box is on the conveyor within {threshold:f} cm in x"))
def box_is_on_conveyor_in_x(threshold: float) -> None:
    assert is_within(ON_CONVEYOR.x, box_start_position().x, threshold)


@given(parsers.parse("the box is on the conveyor within {threshold:f} cm in y"))
def box_is_on_conveyor_in_y(threshold: float) -> None:
    assert is_within(ON_CONVEYOR.y, box_start_position().y, threshold)


@given(parsers.parse("the box is on the conveyor within {threshold:f} cm in z"))
def box_is_on_conveyor_in_z(threshold: float) -> None:
    assert is_within(ON_CONVEYOR.z, box_start_position().z, threshold)


@when("the program has finished")
def program_has_finished(cell: Node) -> None:
    mission = start("mission.py", "--ros-args", "-p", "use_sim_time:=true")
    assert mission.wait(60) == 0, "the program failed"


@then(parsers.parse("the box is at its target within {threshold:f} cm in x"))
def box_is_at_target_in_x(threshold: float, target: Position) -> None:
    assert is_within(target.x, box_end_position().x, threshold)


@then(parsers.parse("the box is at its target within {threshold:f} cm in y"))
def box_is_at_target_in_y(threshold: float, target: Position) -> None:
    assert is_within(target.y, box_end_position().y, threshold)


@then(parsers.parse("the box is at its target within {threshold:f} cm in z"))
def box_is_at_target_in_z(threshold: float, target: Position) -> None:
    assert is_within(target.z, box_end_position().z, threshold)
