"""Monitors for survivors that take another path: zones that the original never enters, with a margin.

A zone is all beyond one bound (``x < 0.67``), or the corner beyond two (``x < 0.67 or z > 0.4``). With the
opening of a gripper it says from where something may be let go.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

from .bands import digits_of
from .checks import ANGLE, PLACE, Monitor, Trials, rank_of
from .project import PlaceInTest
from .readings import Measured, ValuesRead
from .suite import SuiteChecks
from .tick_recorder import SIGN
from .tolerances import StatedTolerances

#: what counts as clear of the original: m, and degrees
_CLEAR, _CLEAR_ANGLE = 0.02, 10.0
#: times that by which a survivor must be in a zone: half of it stays free on either side of the bound
_ROOM = 1.5
#: farther in a zone is no better
_FAR = 10.0
#: moments that are taken between two that were seen
_STEPS = 6
#: degrees by which an angle may change that is kept
_KEPT = 20.0
#: what says how far a gripper is open: it has two states, and its zones are those of things let go
_GATE = re.compile(r"opening|aperture", re.I)

#: numbers by expression, moment by moment
Columns = Mapping[str, Sequence[float]]


@dataclass(frozen=True, slots=True)
class _Bound:
    """One bound of a zone: ``sign`` is 1 for values above it, -1 for values below."""

    text: str
    sign: int
    scale: float


@dataclass(frozen=True, slots=True)
class _Zone:
    """The moments at which all readings are beyond their bounds."""

    sides: tuple[_Bound, ...]
    bounds: tuple[float, ...]
    distance: float

    def has(self, columns: Columns) -> bool:
        """Return whether any moment lies in the zone."""
        rows = zip(*(columns[side.text] for side in self.sides), strict=True)
        signs = [side.sign for side in self.sides]
        return any(
            all(
                sign * value >= sign * bound
                for sign, value, bound in zip(signs, row, self.bounds, strict=True)
            )
            for row in rows
        )


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
    return dict(zip(texts, zip(*rows, strict=True), strict=True))


def _of_ways(
    place: PlaceInTest,
    owner: str,
    ways: Sequence[Columns],
    theirs: Mapping[tuple[str, int], Columns],
    measured: Measured,
    limits: StatedTolerances,
) -> Iterator[Monitor]:
    shared = set.intersection(*({*one} for one in (*ways, *theirs.values())))
    shared -= {text for text in shared if text.replace("_pose()", "_position()") in shared - {text}}
    scales = {text: scale for text in sorted(shared) if (scale := _scale_of(text, ways, limits))}
    zones: dict[str, _Zone] = {}
    for columns in theirs.values():
        for zone in _zones(columns, ways, scales):
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
            condition=_condition(zone),
            name=_name(zone),
            is_release=any(_GATE.search(text) for text in texts),
            distance=zone.distance,
        )


def _scale_of(text: str, ways: Sequence[Columns], limits: StatedTolerances) -> float | None:
    """Return the margin of a reading, never less than the tests allow; None if it has no bounds."""
    if _GATE.search(text):
        values = [value for way in ways for value in way[text]]
        return (max(values) - min(values)) / 4 / _ROOM or None
    rank = rank_of(text)
    if rank == PLACE:
        return max(_CLEAR, limits.of(text).tolerance)
    # angles of an orientation that changes go round, or change all at once
    is_kept = all(max(way[text]) - min(way[text]) < _KEPT for way in ways)
    if rank == ANGLE and is_kept:
        return max(_CLEAR_ANGLE, limits.of(text).tolerance)
    return None


def _zones(columns: Columns, ways: Sequence[Columns], scales: Mapping[str, float]) -> Iterator[_Zone]:
    """Yield the zones of one survivor: at releases, with one bound; else the best with two bounds."""
    pairs = [*_pairs(scales)]
    gates = [pair for pair in pairs if _GATE.search(pair[1])]
    found = [*_beyond_two(columns, ways, scales, gates), *_beyond_one(columns, ways, scales)]
    if not found:
        corners = [pair for pair in pairs if pair not in gates]
        found = sorted(_beyond_two(columns, ways, scales, corners), key=lambda zone: -zone.distance)[:2]
    yield from found


def _beyond_one(columns: Columns, ways: Sequence[Columns], scales: Mapping[str, float]) -> Iterator[_Zone]:
    for text, scale in scales.items():
        for sign in (1, -1) if not _GATE.search(text) else ():
            most = [max(sign * value for value in way[text]) for way in ways]
            nearest = max(sign * value for value in columns[text])
            far = (nearest - max(most)) / (scale + max(most) - min(most))
            if far >= _ROOM:
                bound = _readable(sign * max(most), sign * nearest)
                yield _Zone((_Bound(text, sign, scale),), (bound,), min(far, _FAR))


def _beyond_two(
    columns: Columns,
    ways: Sequence[Columns],
    scales: Mapping[str, float],
    pairs: Sequence[tuple[str, str]],
) -> Iterator[_Zone]:
    for one, other in pairs:
        for signs in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            sides = _Bound(one, signs[0], scales[one]), _Bound(other, signs[1], scales[other])
            if _GATE.search(other) and signs != (1, 1):  # only what is let go, and from higher
                continue
            front = _front([row for way in ways for row in _between(_scaled(way, sides))])
            best, at = -math.inf, (0.0, 0.0)
            for row in _scaled(columns, sides):
                far = min(max(row[0] - a, row[1] - b) for a, b in front)
                if far > best:
                    best, at = far, row
            if best >= _ROOM:
                best = min(best, _FAR)
                bounds = tuple(
                    _readable(side.sign * (value - best) * side.scale, side.sign * value * side.scale)
                    for side, value in zip(sides, at, strict=True)
                )
                yield _Zone(sides, bounds, best - _ROOM / 2)


def _pairs(texts: Collection[str]) -> Iterator[tuple[str, str]]:
    """Yield pairs of related readings: of one thing, or of a thing and the gripper's opening."""
    gates = [text for text in texts if _GATE.search(text)]
    places = [text for text in texts if text not in gates and rank_of(text) == PLACE]
    for one, other in combinations(places, 2):
        if one.rpartition(".")[0] == other.rpartition(".")[0]:
            yield one, other
    yield from ((one, gate) for one in places for gate in gates if one.endswith(".z") and "tool" not in one)


def _scaled(columns: Columns, sides: Sequence[_Bound]) -> list[tuple[float, float]]:
    one, other = sides
    return [
        (one.sign * a / one.scale, other.sign * b / other.scale)
        for a, b in zip(columns[one.text], columns[other.text], strict=True)
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


def _condition(zone: _Zone) -> str:
    """Return the condition that a moment lies outside the zone: ``a < 0.6 or b > 0.2``."""
    return " or ".join(
        f"{side.text} {'<' if side.sign > 0 else '>'} {_number(bound)}"
        for side, bound in zip(zone.sides, zone.bounds, strict=True)
    )


def _number(value: float) -> str:
    text = repr(value)
    return text.removesuffix(".0") if digits_of(value) else text


def _name(zone: _Zone) -> str:
    """Return a description of the condition for people."""
    (first, *more), (bound, *others) = zone.sides, zone.bounds
    word = "below" if first.sign > 0 else "above"
    text = f"{_thing(first.text)} stays {word} {_number(bound)}"
    if not more:
        return text
    if _GATE.search(more[0].text):
        return f"{_thing(first.text)} is {word} {_number(bound)} when the gripper opens"
    side = "above" if more[0].sign > 0 else "below"
    return f"{text} where {_thing(more[0].text)} is {side} {_number(others[0])}"


def _thing(text: str) -> str:
    """Return a short name of a reading: ``tool x`` for ``cell.truth.tool_position().x``."""
    call, _, part = text.rpartition(").")
    name = (call or text).partition("(")[0].rpartition(".")[2]
    name = name.removesuffix("_position").removesuffix("_pose")
    return f"{name} {part}".replace("_", " ").strip() if call else name.replace("_", " ")
