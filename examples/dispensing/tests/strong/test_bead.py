"""What the drawing of the bead asks, place by place, and what must hold at every moment."""

from __future__ import annotations

from collections.abc import Callable

import pytest
import sealing
from bead import aside, narrowest, spilled, widest
from sealing import Report
from station import HOUSING, Station

from mutabot_cell import Pose

WIDTH, WIDTH_WITHIN = 0.004, 0.0004
"""Of the bead as drawn, m. A piece has 16 or 17 drops: 3 % of its width."""
ASIDE_WITHIN = 0.0007
"""The sensor's noise makes 0.1 mm of the frame at its far end, five times that, and 0.2 mm of the arm."""
SPILLED_WITHIN = 3e-9
"""What the valve lets out beyond both ends, m³: 1 % of the bead."""
LEAST_STANDOFF, MOST_STANDOFF = 0.0015, 0.0025
"""Of the nozzle above the housing where it dispenses, m: half a millimetre about the drawing's 2."""
SHIFT_WITHIN, TURN_WITHIN = 0.0003, 0.25
"""Of what is reported, m and degrees: five times the noise."""
HOME, HOME_WITHIN, HOME_WITHIN_DEGREES = Pose(0.6167, 0.0014, 0.4337, 90.0, 0.0, 90.0), 0.0015, 0.3
"""Of the nozzle's tip, base frame: 40 mm before that of a gripper."""
CYCLE_TIME = 20.0
"""From the start to home, s."""
FREE = 0.0010
"""The nozzle is never nearer to the housing than this, m."""
LOW = 0.010
"""So near the nozzle is only to dispense, m."""
NOTICED = 0.8
"""So long the nozzle may stay low after the sealant has stopped by itself, s."""
CLOGS_AT = {"clogs_at": 3.0}


def test_the_bead_is_as_wide_as_drawn_and_in_its_groove(station_with: Callable[..., Station]) -> None:
    station = station_with()
    watch_nozzle(station)
    report = sealing.run(station)
    assert narrowest(station) > WIDTH - WIDTH_WITHIN
    assert widest(station) < WIDTH + WIDTH_WITHIN
    assert aside(station) < ASIDE_WITHIN
    assert spilled(station) < SPILLED_WITHIN
    heights = [drop.height for drop in station.dispenser.drops]
    assert min(heights) > LEAST_STANDOFF
    assert max(heights) < MOST_STANDOFF
    check_reported(station, report)
    check_at_rest(station)
    assert station.cell.time < CYCLE_TIME


def test_a_clogged_needle_stops_the_robot_at_once_and_the_valve_is_shut(
    station_with: Callable[..., Station],
) -> None:
    station = station_with(**CLOGS_AT)
    low = watch_nozzle(station)
    assert sealing.run(station).result == "clogged"
    dry = [time for time in low if time > station.dispenser.drops[-1].time]
    assert max(dry) - min(dry) < NOTICED
    assert station.dispenser.pressure() < sealing.CLOGGED
    check_at_rest(station)


@pytest.mark.parametrize("fault", [{"is_empty": True}, {"level": 0.05}, {"shift": (0.007, 0.002)}])
def test_after_a_fault_the_robot_is_at_home(
    station_with: Callable[..., Station], fault: dict[str, object]
) -> None:
    station = station_with(**fault)
    watch_nozzle(station)
    sealing.run(station)
    check_at_rest(station)


def watch_nozzle(station: Station) -> list[float]:
    """The nozzle touches nothing. Returns the times at which it is low above the housing, as they come."""
    cell, housing = station.cell, station.housing
    low: list[float] = []
    if housing is None:
        return low

    def is_free() -> bool:
        tip = cell.truth.tool_position()
        x, y = housing.place(tip.x, tip.y)
        is_over = abs(x) < HOUSING[0] / 2 and abs(y) < HOUSING[1] / 2
        if is_over and tip.z - housing.z < LOW:
            low.append(cell.time)
        return tip.z - housing.z > (FREE if is_over else -HOUSING[2])

    cell.always(is_free, "the nozzle touches neither housing nor table")
    return low


def check_reported(station: Station, report: Report) -> None:
    """The report says by how much the housing lay off."""
    housing = station.housing
    assert housing is not None
    x, y = housing.x - sealing.NOMINAL_X, housing.y - sealing.NOMINAL_Y
    assert (report.shift_x, report.shift_y) == pytest.approx((x, y), abs=SHIFT_WITHIN)
    assert report.turn == pytest.approx(housing.turn, abs=TURN_WITHIN)


def check_at_rest(station: Station) -> None:
    """The arm stands at home, and nothing leaves the nozzle."""
    pose = station.cell.sensors.tool_pose()
    assert (pose.x, pose.y, pose.z) == pytest.approx((HOME.x, HOME.y, HOME.z), abs=HOME_WITHIN)
    angles = (pose.theta_x, pose.theta_y, pose.theta_z)
    assert angles == pytest.approx((HOME.theta_x, HOME.theta_y, HOME.theta_z), abs=HOME_WITHIN_DEGREES)
    before = len(station.dispenser.drops)
    station.cell.wait(1.0)
    assert len(station.dispenser.drops) == before
