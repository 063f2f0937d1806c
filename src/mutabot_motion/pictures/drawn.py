"""Draws a recording from above and from the side, for simulators that render no pictures."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise, product
from math import isnan
from operator import ne

from PIL import Image, ImageDraw

from mutabot.api.reports import RecordedPaths
from mutabot_motion.view import end_of, things_in

from .fonts import font_of_size

_WIDTH, _HEIGHT = 600, 600
_EDGE, _LABEL = 16, 20
_GROUND, _BLOCK, _OUTLINE, _TEXT = "#f7f8fa", "#dfe3e8", "#aab2bc", "#343a42"
_ARM = "#c8d0d9"
#: of things that move, distinguishable with any kind of colour vision
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8a6d00", "#5a5a5a")
#: corners of the views: which axis goes to the right, and which goes up
_VIEWS = (("from above", 0, 1), ("from the side", 0, 2))


@dataclass(frozen=True, slots=True)
class _PixelView:
    """A view, and its conversion to pixels."""

    right: int
    up: int
    scale: float
    middle: tuple[float, float]
    centre: tuple[float, float]

    def pixel(self, point: Sequence[float]) -> tuple[float, float]:
        x, y = (point[axis] - middle for axis, middle in zip((self.right, self.up), self.middle, strict=True))
        return self.centre[0] + x * self.scale, self.centre[1] - y * self.scale


class DrawnPictures:
    """The paths of a recording, drawn in two views.

    Args:
        recording: what is drawn.
        others: recordings for whose paths there is to be room as well, so that sides beside each other have
            one scale.
    """

    def __init__(self, recording: RecordedPaths, others: Iterable[RecordedPaths] = ()) -> None:
        self.end = end_of(recording)
        self._paths = {name: recording.paths[name] for name in things_in(recording)}
        self._lines = [*recording.lines.values()]
        self._views = _views(_extents([recording, *others]))
        self._empty = Image.new("RGB", (_WIDTH, _HEIGHT), _GROUND)
        draw = ImageDraw.Draw(self._empty)
        for (name, _, up), view in zip(_VIEWS, self._views, strict=True):
            for block in sorted(
                recording.recording.blocks,
                key=lambda recorded_block: recorded_block.centre[3 - view.right - up],
            ):
                _draw_block(draw, view, block.centre, block.size)
            bottom = view.centre[1] + _HEIGHT / 4
            font_of_size(14).draw(draw, (_EDGE, bottom - 8), name, _TEXT, "lb")
        draw.line((0, _HEIGHT / 2, _WIDTH, _HEIGHT / 2), fill=_OUTLINE)
        for number, name in enumerate(self._paths):
            font_of_size(14).draw(draw, (_WIDTH - _EDGE, 6 + 18 * number), name, _colour(number), "ra")

    def at(self, time: float) -> Image.Image:
        """Return the picture at a time, s: the paths until then, and the things' positions."""
        image = self._empty.copy()
        draw = ImageDraw.Draw(image)
        for line, view in product(self._lines, self._views):
            _draw_line(draw, view, line.rows[line.at(time)], line.track.radii)
        for number, path in enumerate(self._paths.values()):
            until = bisect_right(path.when, time + 1e-6)
            for view in self._views:
                trail = [view.pixel(point) for point in path.points[:until]]
                if len(trail) > 1:
                    draw.line(trail, fill=_colour(number), width=2, joint="curve")
                if trail:
                    _draw_thing(draw, view, path.rows[until - 1], path.track.size, _colour(number))
        return image


def _draw_line(
    draw: ImageDraw.ImageDraw, view: _PixelView, row: Sequence[float], radii: Sequence[float]
) -> None:
    """Draw an arm link by link."""
    points = [view.pixel(row[start : start + 3]) for start in range(0, len(row), 3)]
    for number, ends in enumerate(pairwise(points)):
        draw.line(ends, fill=_ARM, width=max(2, round(2 * view.scale * radii[number])))
    for (x, y), radius in zip(points, radii, strict=True):
        wide = max(1.0, view.scale * radius)
        draw.ellipse((x - wide, y - wide, x + wide, y + wide), fill=_ARM, outline=_OUTLINE)


def _colour(number: int) -> str:
    return _COLOURS[number % len(_COLOURS)]


def _extents(recordings: Sequence[RecordedPaths]) -> list[tuple[float, float]]:
    """Return the range of coordinates along each axis, m; blocks count only near what moves."""
    points = [
        point
        for recording in recordings
        for name in things_in(recording)
        for point in recording.paths[name].points
        if not any(map(isnan, point))
    ]
    if not points:
        return [(-0.5, 0.5)] * 3
    margin = 0.15
    return [(min(axis) - margin, max(axis) + margin) for axis in zip(*points, strict=True)]


def _views(room: Sequence[tuple[float, float]]) -> list[_PixelView]:
    """Return both views in one scale."""
    spans = [most - least for least, most in room]
    wide, high = _WIDTH - 2 * _EDGE, _HEIGHT / 2 - _EDGE - _LABEL
    scale = min(wide / spans[0], high / spans[1], high / spans[2])
    middles = [(least + most) / 2 for least, most in room]
    return [
        _PixelView(right, up, scale, (middles[right], middles[up]), (_WIDTH / 2, _HEIGHT / 4 * (1 + 2 * row)))
        for row, (_, right, up) in enumerate(_VIEWS)
    ]


def _draw_block(
    draw: ImageDraw.ImageDraw, view: _PixelView, centre: Sequence[float], size: Sequence[float]
) -> None:
    low = view.pixel([c - s / 2 for c, s in zip(centre, size, strict=True)])
    high = view.pixel([c + s / 2 for c, s in zip(centre, size, strict=True)])
    half = view.centre[1] - _HEIGHT / 4, view.centre[1] + _HEIGHT / 4
    top, bottom = max(high[1], half[0]), min(low[1], half[1])
    if top < bottom:
        draw.rectangle((low[0], top, high[0], bottom), fill=_BLOCK, outline=_OUTLINE)


def _draw_thing(
    draw: ImageDraw.ImageDraw,
    view: _PixelView,
    row: Sequence[float],
    size: Sequence[float] | None,
    colour: str,
) -> None:
    """Draw a box by its edges, rotated; anything else as a dot. ``row``: as in a track."""
    place, turn = row[:3], row[3:] or (1.0, 0.0, 0.0, 0.0)
    if size is None:
        x, y = view.pixel(place)
        draw.ellipse((x - 5, y - 5, x + 5, y + 5), fill=colour)
        return
    corners = {}
    for signs in product((-0.5, 0.5), repeat=3):
        offset = _rotated(turn, [part * edge for part, edge in zip(signs, size, strict=True)])
        corners[signs] = view.pixel(
            [coordinate + shift for coordinate, shift in zip(place, offset, strict=True)]
        )
    for first, second in combinations(corners, 2):
        if sum(map(ne, first, second)) == 1:  # they differ along one edge
            draw.line((corners[first], corners[second]), fill=colour, width=3)


def _rotated(turn: Sequence[float], vector: Sequence[float]) -> list[float]:
    """Return a vector rotated by a unit quaternion w, x, y, z."""
    w, *axis = turn
    twice = [2.0 * part for part in _cross(axis, vector)]
    return [v + w * t + c for v, t, c in zip(vector, twice, _cross(axis, twice), strict=True)]


def _cross(first: Sequence[float], second: Sequence[float]) -> tuple[float, float, float]:
    (a, b, c), (x, y, z) = first, second
    return b * z - c * y, c * x - a * z, a * y - b * x
