"""Monitors for survivors that take another path: zones that the original never enters, with a margin.

A zone is all beyond one bound (``x < 0.67``), of a place, a kept angle, a force or a speed. With the opening
of a gripper (``z < 1.1 or opening < 0.06``) it says from where a thing may be let go, or that it slips.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, pairwise, permutations

from .checks import ANGLE, PLACE, Monitor, Trials, rank_of
from .project import PlaceInTest
from .readings import Measured, ValuesRead
from .suite import SuiteChecks
from .tick_recorder import PEAKS, SIGN
from .tolerances import StatedTolerances
from .zone import COORDINATE, FROM, GATE, Bound, Columns, Zone

#: what counts as clear of the original: m, degrees, and m that a thing moves in the fingers
_CLEAR, _CLEAR_ANGLE, _CLEAR_SLIP = 0.02, 10.0, 0.003
#: the same of forces (N) and speeds (m/s), and as a share of the original's greatest
_CLEAR_FORCE, _CLEAR_SPEED, _CLEAR_SHARE = 5.0, 0.1, 0.2
#: times that by which a survivor must be in a zone: half of it stays free on either side of the bound
_ROOM = 1.5
#: farther in a zone is no better
_FAR = 10.0
#: moments that are taken between two that were seen
_STEPS = 6
#: degrees by which an angle may change that is kept
_KEPT = 20.0
#: times what counts as clear: what slips farther has been lost
_SLIPPED = 4.0


def monitors(suite: SuiteChecks, measured: Measured) -> Iterator[Monitor]:
    """Yield the conditions that survivors break on their paths."""
    everywhere = [read for reads in measured.originals.values() for read in reads.values()]
    for place, originals in measured.originals.items():
        mutants = measured.mutants.get(place, {})
        runs = list(originals.values())
        for owner in {key for read in runs for key in read if key.startswith(SIGN)}:
            ways = [found for read in runs if (found := _columns(read, owner)) is not None]
            limits = StatedTolerances(suite, {}, runs, mutants, everywhere)
            theirs = {
                (mutant, round): found
                for mutant, reads in mutants.items()
                for (round, _), read in reads.items()
                if (found := _columns(read, owner)) is not None
            }
            if len(ways) == len(runs) and theirs:
                yield from _of_ways(place, owner.removeprefix(SIGN), ways, theirs, measured, limits)


def _columns(read: ValuesRead, owner: str) -> Columns | None:
    if owner not in read:
        return None
    texts, rows = json.loads(read[owner])
    found = dict(zip(texts, zip(*rows, strict=True), strict=True))
    return {**found, **dict(_distances(found))}


def _distances(columns: Columns) -> Iterator[tuple[str, Sequence[float]]]:
    """Yield how far things are from a tool that grips, along each axis."""
    if not any(GATE.search(text) for text in columns):
        return
    places = {text: match[1] for text in columns if (match := COORDINATE.search(text))}
    for first, second in permutations(places, 2):
        if places[second] == "tool" != places[first] and first[-2:] == second[-2:]:
            values = [a - b for a, b in zip(columns[first], columns[second], strict=True)]
            yield f"{first}{FROM}{second}", values


def _of_ways(
    place: PlaceInTest,
    owner: str,
    ways: Sequence[Columns],
    theirs: Mapping[tuple[str, int], Columns],
    measured: Measured,
    limits: StatedTolerances,
) -> Iterator[Monitor]:
    shared = set.intersection(*({*way} for way in (*ways, *theirs.values())))
    shared -= {text for text in shared if text.replace("_pose()", "_position()") in shared - {text}}
    scales = {text: scale for text in sorted(shared) if (scale := _scale_of(text, ways, limits))}
    zones: dict[str, Zone] = {}
    for columns in theirs.values():
        for zone in _zones(columns, ways, scales):
            (side, *_), (bound, *_) = zone.sides, zone.bounds
            if not PEAKS.search(side.text) or bound >= limits.bound(side.text):
                zones.setdefault(f"{zone.sides} {zone.bounds}", zone)
    for zone in zones.values():
        trials: Trials = frozenset(trial for trial, columns in theirs.items() if zone.has(columns))
        texts = [side.text for side in zone.sides]
        needs = dict.fromkeys(
            line for text in texts for line in measured.watched.get(place, {}).get(text, ())
        )
        yield Monitor(
            place=place,
            trials=trials,
            runs=len(ways),
            needs=tuple(needs),
            owner=owner,
            condition=zone.condition,
            name=zone.name,
            is_release=zone.is_release,
            distance=zone.distance,
        )


def _scale_of(text: str, ways: Sequence[Columns], limits: StatedTolerances) -> float | None:
    """Return the margin of a reading, never less than the tests allow; None if it has no bounds."""
    if GATE.search(text):
        values = [value for way in ways for value in way[text]]
        return (max(values) - min(values)) / 4 / _ROOM or None
    if PEAKS.search(text):
        least = _CLEAR_FORCE if text.endswith("force") else _CLEAR_SPEED
        return max(least, _CLEAR_SHARE * max(value for way in ways for value in way[text]))
    if FROM in text:
        return max(_CLEAR_SLIP, limits.of(text.partition(FROM)[0]).tolerance)
    rank = rank_of(text)
    if rank == PLACE:
        return max(_CLEAR, limits.of(text).tolerance)
    # angles of an orientation that changes go round, or change all at once
    is_kept = all(max(way[text]) - min(way[text]) < _KEPT for way in ways)
    if rank == ANGLE and is_kept:
        return max(_CLEAR_ANGLE, limits.of(text).tolerance)
    return None


def _zones(columns: Columns, ways: Sequence[Columns], scales: Mapping[str, float]) -> Iterator[Zone]:
    """Yield the zones of one survivor: of what is let go or slips, and with one bound."""
    for zones in (_of_releases, _of_slips, _of_bounds):
        yield from zones(columns, ways, scales)


def _of_bounds(columns: Columns, ways: Sequence[Columns], scales: Mapping[str, float]) -> Iterator[Zone]:
    """Yield the zones beyond one bound; forces and speeds have no least one."""
    for text, scale in scales.items():
        is_paired = GATE.search(text) or FROM in text
        for sign in () if is_paired else (1,) if PEAKS.search(text) else (1, -1):
            side = Bound(text, sign, scale)
            found = _beyond(side, columns[text], [way[text] for way in ways])
            if found is not None:
                yield Zone((side,), (found[0],), found[1])


def _of_slips(columns: Columns, ways: Sequence[Columns], scales: Mapping[str, float]) -> Iterator[Zone]:
    """Yield the zones of things that move in closed fingers, in either direction."""
    for gate in (text for text in scales if GATE.search(text)):
        values = [value for way in ways for value in way[gate]]
        half = _readable(min(values), max(values))
        for text in (text for text in scales if FROM in text):
            held = [_where_below(way, gate, half)[text] for way in ways]
            own = _where_below(columns, gate, half)[text]
            if not own or not all(held):
                continue
            side = Bound(text, 1, scales[text], _middle([*chain.from_iterable(held)], scales[text]))
            found = _beyond(side, own, held, _SLIPPED)
            if found is not None:
                yield Zone((side, Bound(gate, -1, scales[gate])), (found[0], half), found[1])


def _middle(values: Sequence[float], scale: float) -> float:
    """Return the middle of what the original reads, in few digits, or 0 if that is near."""
    middle = (min(values) + max(values)) / 2
    return 0.0 if abs(middle) < scale / 2 else _readable(middle - scale / 2, middle + scale / 2)


def _where_below(columns: Columns, gate: str, bound: float) -> Columns:
    """Return the moments at which a reading is below a bound."""
    kept = [number for number, value in enumerate(columns[gate]) if value < bound]
    return {text: [values[number] for number in kept] for text, values in columns.items()}


def _beyond(
    side: Bound, own: Sequence[float], usual: Sequence[Sequence[float]], most: float = math.inf
) -> tuple[float, float] | None:
    """Return the bound on one side of what is usual, and how far beyond it is; None if not far enough.

    ``most``: times the scale, where what is farther counts as near as that.
    """
    ends = [max(side.sign * side.of(value) for value in values) for values in usual]
    unit = side.scale + max(ends) - min(ends)
    far = min((max(side.sign * side.of(value) for value in own) - max(ends)) / unit, most)
    if far < _ROOM:
        return None
    return _readable(side.sign * max(ends), side.sign * (max(ends) + far * unit)), min(far, _FAR)


def _of_releases(columns: Columns, ways: Sequence[Columns], scales: Mapping[str, float]) -> Iterator[Zone]:
    """Yield the zones of things that open fingers let go from higher."""
    for sides in _releasing(scales):
        front = _front([row for way in ways for row in _between(_scaled(way, sides))])
        best, at = -math.inf, (0.0, 0.0)
        for row in _scaled(columns, sides):
            far = min(max(row[0] - a, row[1] - b) for a, b in front)
            if far > best:
                best, at = far, row
        if best >= _ROOM:
            best = min(best, _FAR)
            bounds = tuple(
                _readable((value - best) * side.scale, value * side.scale)
                for side, value in zip(sides, at, strict=True)
            )
            yield Zone(sides, bounds, best - _ROOM / 2)


def _releasing(scales: Mapping[str, float]) -> Iterator[tuple[Bound, Bound]]:
    """Yield heights of things, each with the gripper's opening."""
    gates = [text for text in scales if GATE.search(text)]
    for text in (text for text in scales if text.endswith(".z") and "tool" not in text):
        yield from ((Bound(text, 1, scales[text]), Bound(gate, 1, scales[gate])) for gate in gates)


def _scaled(columns: Columns, sides: Sequence[Bound]) -> list[tuple[float, float]]:
    first, second = sides
    return [
        (first.sign * a / first.scale, second.sign * b / second.scale)
        for a, b in zip(columns[first.text], columns[second.text], strict=True)
    ]


def _between(rows: Sequence[tuple[float, float]]) -> Iterator[tuple[float, float]]:
    """Yield these moments with interpolated ones, since fast motions leave gaps between them."""
    for (a, b), (c, d) in pairwise(rows):
        for part in range(_STEPS):
            share = part / _STEPS
            yield a + (c - a) * share, b + (d - b) * share
    yield from rows[-1:]


def _front(rows: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the moments that no other exceeds in both readings: only these bound a corner."""
    found: list[tuple[float, float]] = []
    for a, b in sorted(rows, reverse=True):
        if not found or b > found[-1][1]:
            found.append((a, b))
    return found


def _readable(free: float, taken: float) -> float:
    """Return the bound with the fewest digits in the middle third between free and used values."""
    low, high = sorted((free + (taken - free) / 3, free + (taken - free) * 2 / 3))
    for digits in range(-2, 6):
        value = round((low + high) / 2, digits)
        if low <= value <= high:
            return value + 0.0
    return (low + high) / 2
