"""A path goes through its points in one go, its corners rounded by arcs, at an even speed."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from mutabot_cell import BadArgument, Cell, MotionRefused, Pose, gen3, nozzle
from mutabot_cell.geometry import Array, rotation_from_euler
from mutabot_cell.motion.rounded_path import RoundedPath, Waypoint

ABOVE = (12, 26, 180, -78, 0, -76, 90)
BLEND = 0.02


def through(*places: tuple[float, float, float], blend: float = BLEND, turns: float = 0.0) -> RoundedPath:
    """A path through places, turning by so many degrees about z from each to the next."""
    return RoundedPath(
        [
            Waypoint(np.array(place), rotation_from_euler(180.0, 0.0, turns * index), blend)
            for index, place in enumerate(places)
        ]
    )


CORNER = ((0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (0.2, 0.1, 0.0))


def sampled(path: RoundedPath, count: int = 4000) -> Array:
    return np.array([path.position_at(part) for part in np.linspace(0.0, 1.0, count).tolist()])


def test_a_right_angle_is_rounded_by_a_quarter_of_a_circle() -> None:
    path = through(*CORNER)
    # both lines lose the blend, the arc's radius is the blend
    assert path.length == pytest.approx(0.3 - 2 * BLEND + BLEND * math.pi / 2)
    middle = np.array((0.2 - BLEND, BLEND, 0.0))
    near = [place for place in sampled(path) if place[0] > 0.2 - BLEND and place[1] < BLEND]
    assert [math.dist(place, middle) for place in near] == pytest.approx([BLEND] * len(near))


@pytest.mark.parametrize("end", [(0.4, 0.1, 0.0), (0.25, 0.2, 0.05), (0.1, 0.1, -0.1), (0.0, 0.02, 0.0)])
def test_the_way_is_travelled_evenly_and_without_a_kink(end: tuple[float, float, float]) -> None:
    path = through(CORNER[0], CORNER[1], end)
    steps = np.diff(sampled(path), axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    assert lengths == pytest.approx(np.full(len(lengths), path.length / len(lengths)), rel=1e-3)
    ways = steps / lengths[:, None]
    turns = [math.acos(min(1.0, float(first @ second))) for first, second in pairwise(ways)]
    sharpest = max(turns)
    assert sharpest < 2.0 * path.length / len(lengths) / 0.001  # no tighter than 1 mm


def test_a_blend_longer_than_half_a_line_is_cut_to_that() -> None:
    assert through(*CORNER, blend=1.0).length == pytest.approx(0.3 - 2 * 0.05 + 0.05 * math.pi / 2)


def test_points_on_a_straight_line_need_no_blend() -> None:
    path = through((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.3, 0.0, 0.0), blend=0.0)
    assert (path.length, path.finest) == (pytest.approx(0.3), math.inf)


def test_the_tool_turns_evenly_between_two_points() -> None:
    path = through((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.3, 0.0, 0.0), turns=30.0)
    for fraction, degrees in ((0.0, 0.0), (1 / 6, 15.0), (1 / 3, 30.0), (2 / 3, 45.0), (1.0, 60.0)):
        assert path.rotation_at(fraction) == pytest.approx(rotation_from_euler(180.0, 0.0, degrees), abs=1e-9)
    # on the first third it turns as fast as 90 degrees on the whole
    assert path.angle == pytest.approx(math.radians(90.0))


def test_a_sharp_corner_is_no_path() -> None:
    with pytest.raises(BadArgument, match=r"blend above 0 where the path turns by 90 deg .* at point 1"):
        through(*CORNER, blend=0.0)


def test_a_point_twice_is_no_path() -> None:
    with pytest.raises(BadArgument, match="got the same at point 2"):
        through(CORNER[0], CORNER[1], CORNER[1])


@pytest.fixture(scope="module")
def travelled() -> tuple[Array, float]:
    """Where the tool was at each tick along a path with two corners (m), and how long the path said it is."""
    cell = Cell(1, robot=gen3().with_tool(nozzle()))
    cell.arm.move_joints(ABOVE)
    path, here = cell.arm.new_path(), cell.arm.commanded_pose()
    for x, y in ((0.0, 0.15), (-0.1, 0.15), (-0.1, 0.0)):
        path.line_to(Pose(here.x + x, here.y + y, here.z, 180, 0, 90), blend=0.01)
    places = [cell.truth.tool_position()]
    cell.simulation.after_tick.append(lambda: places.append(cell.truth.tool_position()))
    move = path.start(0.06)
    seen = [0.0]
    while not move.done:
        cell.wait(0.05)
        seen.append(path.travelled())
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(path.length(), abs=0.001)
    return np.array([(place.x, place.y, place.z) for place in places]), path.length()


def test_the_arm_keeps_the_speed_around_corners(travelled: tuple[Array, float]) -> None:
    places, length = travelled
    speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) / 0.01
    cruising = speeds[20:-20]
    assert cruising.min() > 0.057
    assert cruising.max() < 0.063
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).sum() == pytest.approx(length, rel=0.01)


def test_the_arm_keeps_its_height_on_a_level_path(travelled: tuple[Array, float]) -> None:
    places, _ = travelled
    assert np.ptp(places[:, 2]) < 0.0005


def test_a_path_is_travelled_once() -> None:
    cell = Cell(1, robot=gen3().with_tool(nozzle()))
    here = cell.arm.commanded_pose()
    path = cell.arm.new_path()
    path.line_to(Pose(here.x, here.y + 0.02, here.z, 90, 0, 90))
    path.start(0.05).wait()
    with pytest.raises(MotionRefused, match="travelled already"):
        path.start(0.05)
    with pytest.raises(BadArgument, match="has not begun"):
        path.line_to(here)


@pytest.mark.parametrize("speed", [0.0, -0.1, 9.0, math.nan])
def test_a_speed_out_of_its_range_is_refused_before_anything_moves(speed: float) -> None:
    cell = Cell(1, robot=gen3().with_tool(nozzle()))
    here = cell.arm.commanded_pose()
    path = cell.arm.new_path()
    path.line_to(Pose(here.x, here.y + 0.02, here.z, 90, 0, 90))
    with pytest.raises(BadArgument, match="speed"):
        path.start(speed)
    assert cell.arm.commanded_pose() == here


def test_a_path_out_of_reach_is_refused_before_anything_moves() -> None:
    cell = Cell(1, robot=gen3().with_tool(nozzle()))
    here = cell.arm.commanded_pose()
    path = cell.arm.new_path()
    path.line_to(Pose(here.x, here.y + 0.1, here.z, 90, 0, 90), blend=0.02)
    path.line_to(Pose(here.x + 3.0, here.y + 0.1, here.z, 90, 0, 90))
    with pytest.raises(MotionRefused):
        path.start(0.05)
    assert cell.arm.commanded_pose() == here


def test_an_empty_path_does_not_start() -> None:
    with pytest.raises(BadArgument, match="at least one point"):
        Cell(1, robot=gen3().with_tool(nozzle())).arm.new_path().start(0.05)


def test_a_tool_that_holds_nothing_has_neither_gripper_nor_cup() -> None:
    cell = Cell(1, robot=gen3().with_tool(nozzle()))
    with pytest.raises(BadArgument, match="no gripper"):
        _ = cell.gripper
    with pytest.raises(BadArgument, match="no suction cup"):
        _ = cell.suction
