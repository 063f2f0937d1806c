"""Tracks with fewer points: what a straight line in time keeps within half a millimetre is left out."""

from __future__ import annotations

from array import array
from bisect import bisect_left
from collections.abc import Sequence
from itertools import pairwise
from math import isnan
from typing import Any

from mutabot.evidence.recording import Kind, Track

#: what one step of the whole numbers is, and by how many steps a line may miss: m; quaternions without unit
_LENGTH, _TURN = 1e-4, 1e-3
_MISS_LENGTH, _MISS_TURN = 5.0, 3.0
#: steps over the range of a value, and by how many a line may miss
_STEPS, _MISS_VALUE = 2000, 8.0

Row = tuple[float, ...]


def thinned(track: Track, times: Sequence[float], usual: Track | None, usual_times: Sequence[float]) -> Any:
    """A track as data: times in ms and numbers in steps, each as the difference from the one before.

    ``usual``: the same thing in the original. What both begin with is left to it: the data say ``from`` which
    moment (ms) on they hold.
    """
    rows, when, gaps = _rows(track, times)
    if not rows:
        return None
    scales, misses = _scales(track.kind, rows)
    start = _shared(track, times, usual, usual_times)
    first = max(0, bisect_left(when, start) - 1) if start > 0 else 0
    rows, when = rows[first:], when[first:]
    steps = [tuple(value / scale for value, scale in zip(row, scales, strict=True)) for row in rows]
    kept = kept_points(when, steps, misses)
    channels = [[round(steps[index][axis]) for index in kept] for axis in range(len(scales))]
    return {
        "name": track.name,
        "kind": track.kind.value,
        "unit": track.unit,
        **({"size": list(track.size)} if track.size is not None else {}),
        **({"from": round(1000 * when[0])} if first else {}),
        **({"gaps": gaps} if gaps else {}),
        "scales": scales,
        "t": _differences([round(1000 * when[index]) for index in kept]),
        "v": [_differences(channel) for channel in channels],
    }


def kept_points(times: Sequence[float], rows: Sequence[Row], misses: Sequence[float]) -> list[int]:
    """The points to keep: on a line between two of them, all others lie within ``misses`` per axis.

    From each kept point on, the slopes are narrowed to those that pass every point so far; the last point
    within them is kept next. Each point is looked at once.
    """
    if len(rows) < 3:
        return list(range(len(rows)))
    kept, cone, index = [0], _Cone(), 1
    while index < len(rows):
        anchor = kept[-1]
        span = max(times[index] - times[anchor], 1e-9)
        slopes = [(one - other) / span for one, other in zip(rows[index], rows[anchor], strict=True)]
        if cone.holds(slopes):
            cone.narrow(slopes, [miss / span for miss in misses])
            index += 1
        else:
            kept.append(max(index - 1, anchor + 1))
            cone, index = _Cone(), kept[-1] + 1
    if kept[-1] != len(rows) - 1:
        kept.append(len(rows) - 1)
    return kept


class _Cone:
    """The slopes of lines that pass near enough to every point since the last that was kept."""

    def __init__(self) -> None:
        self._low: list[float] | None = None
        self._high: list[float] = []

    def holds(self, slopes: Sequence[float]) -> bool:
        """Whether a line with these slopes does."""
        if self._low is None:
            return True
        return all(low <= one <= high for low, one, high in zip(self._low, slopes, self._high, strict=True))

    def narrow(self, slopes: Sequence[float], misses: Sequence[float]) -> None:
        """One more point: lines may miss it by so much."""
        low = [one - miss for one, miss in zip(slopes, misses, strict=True)]
        high = [one + miss for one, miss in zip(slopes, misses, strict=True)]
        if self._low is not None:
            low, high = [*map(max, low, self._low)], [*map(min, high, self._high)]
        self._low, self._high = low, high


def _rows(track: Track, times: Sequence[float]) -> tuple[list[Row], list[float], list[list[int]]]:
    """The moments at which it was there, and from when to when (ms) it was not."""
    width, values = track.kind.width, track.values
    rows: list[Row] = []
    when: list[float] = []
    gaps: list[list[int]] = []
    gone: float | None = None
    for number, time in enumerate(times):
        row = tuple(values[number * width : (number + 1) * width])
        if isnan(row[0]):
            gone = time if gone is None else gone
            continue
        if gone is not None:
            gaps.append([round(1000 * gone), round(1000 * time)])
            gone = None
        rows.append(_turned_like(rows[-1], row) if rows and track.kind is Kind.POSE else row)
        when.append(time)
    if gone is not None:
        gaps.append([round(1000 * gone), round(1000 * times[-1]) + 1])
    return rows, when, gaps


def _turned_like(before: Row, row: Row) -> Row:
    """The same pose, with the one of its two quaternions that is nearer to the one before."""
    if sum(a * b for a, b in zip(before[3:], row[3:], strict=True)) < 0:
        return (*row[:3], *(-value for value in row[3:]))
    return row


def _scales(kind: Kind, rows: Sequence[Row]) -> tuple[list[float], list[float]]:
    if kind is Kind.VALUE:
        values = [row[0] for row in rows]
        reach = max(max(values) - min(values), 1e-9 * max(map(abs, values)), 1e-12)
        return [float(f"{reach / _STEPS:.3g}")], [_MISS_VALUE]
    turns = kind.width - 3
    return [_LENGTH] * 3 + [_TURN] * turns, [_MISS_LENGTH] * 3 + [_MISS_TURN] * turns


def _shared(track: Track, times: Sequence[float], usual: Track | None, usual_times: Sequence[float]) -> float:
    """Until when, s, a track is the original's to the last bit."""
    if usual is None or usual.kind is not track.kind:
        return 0.0
    width = track.kind.width
    until = 0.0
    for count, (one, other) in enumerate(zip(times, usual_times, strict=False)):
        here = slice(count * width, (count + 1) * width)
        if one != other or _bytes(track.values[here]) != _bytes(usual.values[here]):
            break
        until = one
    return until


def _bytes(values: array[float]) -> bytes:
    return values.tobytes()


def _differences(numbers: Sequence[int]) -> list[int]:
    return [numbers[0], *(after - before for before, after in pairwise(numbers))]
