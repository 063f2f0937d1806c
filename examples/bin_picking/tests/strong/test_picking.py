"""What must hold at every moment, and what the vision may err."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import picking
import pytest
import vision
from picking import Report
from readings import fall_outside, in_bin, in_trays, nearest, touch_of_bin, true_face
from station import MASSES, Station

MOST_FORCE = 40.0
"""Between the robot and the cup, N: 9 N of pressing on the heap, the tool's weight and inertia, a reserve."""
FASTEST_FALL = 1.0
"""Of a part, m/s: faster than the robot moves, as after a fall of 5 cm; in the bin parts may slip."""
MOST_DEEP = 0.001
"""By so much the robot may press into the bin, m: contacts give way a little."""
PART_TIME, FIRST_AND_LAST = 12.0, 12.0
"""For each part and for the rest, s."""
PLACE_ERROR, TILT_ERROR = 0.004, 4.0
"""Of a face that is grasped, m and degrees."""
HOME_WITHIN = 0.005
"""Of the robot's joints, rad."""


def run_watched(station: Station) -> Report:
    """Empty the bin while forces are watched, what falls, and whether the robot touches the bin."""
    cell = station.cell

    def is_gentle() -> bool:
        wrench = cell.truth.wrench()
        return math.hypot(wrench.fx, wrench.fy, wrench.fz) < MOST_FORCE

    cell.always(is_gentle, "nothing is pressed too hard")
    depth, speed = touch_of_bin(station), fall_outside(station)
    cell.always(lambda: depth() < MOST_DEEP, "the robot does not touch the bin")
    cell.always(lambda: speed() < FASTEST_FALL, "no part falls outside the bin")
    return picking.run(cell)


def check_at_rest(station: Station) -> None:
    """The robot is at home, the cup holds nothing and its ejector is off."""
    cell = station.cell
    assert cell.simulation.robot.encoders() == pytest.approx(
        cell.simulation.robot.model.home, abs=HOME_WITHIN
    )
    assert not cell.suction.is_on()
    assert not cell.suction.holding()


def check_sorted(station: Station, report: Report) -> None:
    """Each part lies in its tray, in a place of its own, and the report says so."""
    assert report.result == "empty"
    assert in_trays(station) == report.placed
    assert sum(report.placed.values()) == len(station.names)
    assert nearest(station) > 0.05
    check_at_rest(station)


def test_a_heap_is_sorted_gently_and_in_time(station_with: Callable[..., Station]) -> None:
    station = station_with(parts=6)
    report = run_watched(station)
    check_sorted(station, report)
    assert report.placed == dict.fromkeys(MASSES, 2)
    assert report.failed <= 2
    assert station.cell.time < 6 * PART_TIME + FIRST_AND_LAST


@pytest.mark.parametrize("shape", MASSES)
def test_parts_of_one_shape_fill_one_tray(station_with: Callable[..., Station], shape: str) -> None:
    station = station_with(parts=3, shapes=(shape,))
    report = run_watched(station)
    check_sorted(station, report)
    assert report.placed[shape] == 3


def test_a_full_bin_is_sorted_and_what_is_left_is_reported(station_with: Callable[..., Station]) -> None:
    station = station_with(parts=15)
    report = run_watched(station)
    left = in_bin(station)
    assert report.result == ("nothing graspable" if left else "empty")
    assert len(left) <= 2
    assert in_trays(station) == report.placed
    assert sum(report.placed.values()) + len(left) == 15
    assert report.failed <= 9
    check_at_rest(station)


def test_a_cup_that_leaks_ends_the_work_after_a_bounded_number_of_tries(
    station_with: Callable[..., Station],
) -> None:
    station = station_with(parts=1)
    station.cell.suction.leak = 1e-4
    report = run_watched(station)
    assert report.result == "nothing graspable"
    assert 1 <= report.failed <= 9
    assert len(in_bin(station)) == 1
    check_at_rest(station)


def test_an_empty_bin_is_left_alone(station_with: Callable[..., Station]) -> None:
    station = station_with(parts=0)
    report = run_watched(station)
    assert report == Report("empty")
    assert station.cell.time < FIRST_AND_LAST
    check_at_rest(station)


def test_a_part_that_lies_alone_is_seen_where_and_as_it_is(station_with: Callable[..., Station]) -> None:
    station = station_with(parts=3)
    picture = picking.look(station.cell)
    found = [face for face in vision.faces(picture.points, vision.in_bin(picture.points)) if face.is_clear]
    assert found
    for face in found:
        name, miss, tilt = true_face(station, np.array([face.x, face.y, face.z]), face.normal)
        assert miss < PLACE_ERROR
        assert tilt < TILT_ERROR
        assert face.shape in (station.shape(name), "unknown")
