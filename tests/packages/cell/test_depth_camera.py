"""The depth camera measures what lies before it, with the errors of the stereo camera that it stands for."""

from __future__ import annotations

import numpy as np
import pytest

from mutabot_cell import BadArgument, Box, Cell, DepthCamera, Fixture, Scene
from mutabot_cell.geometry import Array

TOP, HEIGHT, EDGE = 1.0, 0.7, 0.06
"""Top of the table, height of the camera above it, and edge of the box on it, m."""
PLACE = (0.9, 0.2, TOP + HEIGHT)


def cell_with(*cameras: DepthCamera, parts: bool = True, noise: bool = False, seed: int = 1) -> Cell:
    """A cell with a table and a box below the camera; the robot at home is out of its sight."""
    box = Box(position=(PLACE[0], PLACE[1], TOP), size=(EDGE, EDGE, EDGE), jitter=0.0)
    table = Fixture("table", (0.9, 1.6, 0.05), (1.1, 0.2, TOP - 0.025))
    scene = Scene(fixtures=(table,), marks=(), parts=(box,) if parts else (), depth_cameras=cameras)
    return Cell(seed, scene=scene, noise=noise)


def near(points: Array, x: float, y: float, within: float = 0.01) -> Array:
    """The points around a place, shape (points, 3)."""
    found = np.hypot(points[..., 0] - x, points[..., 1] - y) < within
    chosen: Array = points[found]
    assert len(chosen) > 10
    return chosen


def test_points_lie_on_what_is_before_the_camera() -> None:
    picture = cell_with(DepthCamera("above", PLACE)).depth_camera().picture()
    assert picture.depth.shape == (180, 320)
    assert near(picture.points, *PLACE[:2])[:, 2] == pytest.approx(TOP + EDGE, abs=1e-4)
    assert near(picture.points, 1.1, 0.2)[:, 2] == pytest.approx(TOP, abs=1e-4)
    assert np.nanmin(picture.depth) == pytest.approx(HEIGHT - EDGE, abs=1e-4)


def test_a_camera_that_is_turned_measures_the_same_places() -> None:
    turned = DepthCamera("beside", (PLACE[0], PLACE[1] - 0.3, TOP + HEIGHT), (180 + 25, 0, 0))
    points = cell_with(turned).depth_camera("beside").picture().points
    assert near(points, *PLACE[:2])[:, 2] == pytest.approx(TOP + EDGE, abs=1e-4)
    assert near(points, 1.1, 0.2)[:, 2] == pytest.approx(TOP, abs=1e-4)


def test_where_the_right_imager_does_not_see_nothing_is_measured() -> None:
    """By hand: beside the box's left edge the shadow is baseline · edge / (height - edge) wide."""
    camera = DepthCamera("above", PLACE, decimation=1, baseline=0.055)
    picture = cell_with(camera).depth_camera().picture()
    row = picture.depth[len(picture.depth) // 2]
    edges = np.flatnonzero(np.diff(np.isnan(row[400:880]).astype(int)))
    assert len(edges) == 2
    pitch = HEIGHT / camera.focal_length
    assert (edges[1] - edges[0]) * pitch == pytest.approx(0.055 * EDGE / (HEIGHT - EDGE), abs=2 * pitch)
    assert 400 + edges[1] < 640


def test_the_depth_of_a_plane_has_the_error_of_the_data_sheet() -> None:
    """Intel's: distance² · subpixel / (focal length · baseline); 1005 pixels, 55 mm and 0.08 pixels here."""
    camera = DepthCamera("above", PLACE)
    depth = cell_with(camera, parts=False, noise=True).depth_camera().picture().depth
    plane = depth[40:140, 80:]
    assert np.isfinite(plane).all()
    assert plane.std() == pytest.approx(HEIGHT**2 * 0.08 / (1004.6 * 0.055), rel=0.05)
    assert plane.mean() == pytest.approx(HEIGHT, abs=5e-5)
    steps = 32 * camera.focal_length * camera.baseline / plane
    assert steps == pytest.approx(np.round(steps), abs=1e-6)


def test_what_is_too_near_is_not_measured() -> None:
    """A disparity has at most 126 pixels: 0.4385 m."""
    low = DepthCamera("low", (1.2, 0.2, TOP + 0.43))
    high = DepthCamera("high", (1.2, 0.2, TOP + 0.45))
    cell = cell_with(low, high, parts=False)
    middle = (slice(80, 100), slice(150, 170))
    assert np.isnan(cell.depth_camera("low").picture().depth[middle]).all()
    assert np.isfinite(cell.depth_camera("high").picture().depth[middle]).all()


def test_pictures_of_one_seed_are_the_same_and_each_has_its_own_noise() -> None:
    camera = DepthCamera("above", PLACE)
    cell, same, other = (cell_with(camera, noise=True, seed=seed) for seed in (1, 1, 2))
    first = cell.depth_camera().picture()
    assert np.array_equal(first.depth, same.depth_camera().picture().depth, equal_nan=True)
    assert not np.array_equal(first.depth, other.depth_camera().picture().depth, equal_nan=True)
    assert not np.array_equal(first.depth, cell.depth_camera().picture().depth, equal_nan=True)


def test_a_picture_shows_the_moment_at_which_it_was_taken_and_comes_later() -> None:
    cell = cell_with(DepthCamera("above", PLACE))
    cell.wait(0.2)
    picture = cell.depth_camera().picture()
    assert picture.time == pytest.approx(0.2)
    assert cell.time == pytest.approx(0.25)


def test_a_camera_that_is_not_there_is_named() -> None:
    with pytest.raises(BadArgument, match=r"\(above\) but got name='below'"):
        cell_with(DepthCamera("above", PLACE)).depth_camera("below")
    with pytest.raises(BadArgument, match="none"):
        cell_with().depth_camera()
