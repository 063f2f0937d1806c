"""What must hold at every moment of an assembly, and at its end: for the strong suite."""

from __future__ import annotations

import math

import assembling
import pytest
from assembling import Report
from station import DEPTH, GAP, RIM, TABLE_TOP, Station

SEATED, UPRIGHT = 0.0006, 2.0
"""Of the pin in its hole and the cover on the rim: how high above, m, and askew, degrees: the pin's clearance
allows 1.8."""
COVER_WITHIN, STRAIGHT = 0.0015, 1.0
"""Of the cover from the middle of the housing, m; of the screwdriver while it turns, degrees."""
MOST_FORCE = 45.0
"""Between robot and tool, N: 20 N of pressing, weight and inertia of gripper and screwdriver, a reserve."""
FALLING = 1.0
"""No part is faster, m/s: what falls from 50 mm is as fast, and the robot half as fast."""
NEAR_HOUSING = 0.12
"""A tool so near to the hole, and so much above the table, works at the housing, m."""
LEAST_TORQUE, MOST_TORQUE = 1.5, 2.2
"""Of a screw, Nm: the drawing's 1.6, by noise and by what the screwdriver turns within two ticks."""
HOME_WITHIN = 0.3
"""Of the joints, degrees."""


def run_watched(station: Station) -> Report:
    """Assemble while forces, speeds and the order of the steps are watched."""
    cell = station.cell
    parts = [part.name for part in cell.simulation.scene.parts]
    cell.always(lambda: force_on_tool(station) < MOST_FORCE, "nothing is pressed too hard")
    cell.always(
        lambda: all(cell.truth.box_speed(name) < FALLING for name in parts), "nothing is dropped from high"
    )
    cell.always(lambda: station.clamp.is_closed() or not is_at_housing(station), "work needs a closed clamp")
    cell.always(lambda: not station.driver.is_turning or may_turn(station), "screws turn in their order")
    return assembling.run(station)


def force_on_tool(station: Station) -> float:
    """Between robot and tool, N."""
    wrench = station.cell.truth.wrench()
    return math.hypot(wrench.fx, wrench.fy, wrench.fz)


def is_at_housing(station: Station) -> bool:
    """Whether the tool, low as it is, can touch the housing."""
    tool = station.cell.truth.tool_position()
    low = tool.z < RIM + 2 * NEAR_HOUSING
    return low and math.dist((tool.x, tool.y), station.hole) < NEAR_HOUSING


def may_turn(station: Station) -> bool:
    """Whether pin and cover are in their places, and the screwdriver stands straight on a screw."""
    truth = station.cell.truth
    is_in = truth.box_position("pin").z < TABLE_TOP + SEATED
    is_covered = truth.box_position("cover").z < TABLE_TOP + RIM + SEATED
    is_on_screw = station.driver.screw_below() is not None and truth.box_tilt("driver") < STRAIGHT
    return is_in and is_covered and is_on_screw


def check_at_rest(station: Station) -> None:
    """The robot is at home with an open and empty gripper; clamp and screwdriver are as at the start."""
    cell, home = station.cell, station.cell.simulation.robot.model.home
    assert cell.simulation.robot.encoders() == pytest.approx(home, abs=math.radians(HOME_WITHIN))
    assert not cell.gripper.holding()
    assert cell.truth.opening() > 0.08
    assert not station.driver.is_turning
    assert station.inputs.has_driver()
    assert not station.clamp.is_closed()


def check_pin(station: Station) -> None:
    """The pin stands on the ground of its hole."""
    pin, (x, y) = station.cell.truth.box_position("pin"), station.hole
    assert (pin.x, pin.y) == pytest.approx((x, y), abs=GAP)
    assert pin.z == pytest.approx(TABLE_TOP, abs=SEATED)
    assert station.cell.truth.box_tilt("pin") < UPRIGHT


def check_assembled(station: Station) -> None:
    """Pin and cover are where the drawing wants them, and the screws are tight, drawn down crosswise."""
    check_pin(station)
    cover, screws = station.cell.truth.box_position("cover"), station.driver.screws
    assert math.dist((cover.x, cover.y), station.hole) < COVER_WITHIN
    assert cover.z == pytest.approx(TABLE_TOP + RIM, abs=SEATED)
    assert all(LEAST_TORQUE < screw.tightest < MOST_TORQUE for screw in screws)
    order = [screws[number].place for number in station.driver.order]
    for (x, y), (opposite_x, opposite_y) in (order[:2], order[2:]):
        middle = ((x + opposite_x) / 2, (y + opposite_y) / 2)
        assert middle == pytest.approx(station.hole, abs=1e-6)
    assert not station.lamp.is_on


def check_in_chute(station: Station, name: str) -> None:
    """A part lies in the chute."""
    part = station.cell.truth.box_position(name)
    assert math.dist((part.x, part.y), assembling.CHUTE) < 2 * DEPTH
    assert part.z == pytest.approx(TABLE_TOP, abs=SEATED)
