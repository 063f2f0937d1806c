"""Physical facts of a recording: drops and their heights, slips, drags, collisions, and speeds.

Recordings have some ten moments a second, so the speed of an impact is that of a free fall from the height at
which a thing was let go.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import pairwise
from math import dist, hypot, inf, sqrt
from typing import TYPE_CHECKING, NamedTuple

from mutabot.evidence.contacts import ContactSpan, RecordedContacts, is_within, joined
from mutabot.evidence.paths import STEP

if TYPE_CHECKING:
    from mutabot.evidence.paths import RecordedPaths, Row, TrackPath
from mutabot.evidence.recording import TrackKind

#: what is measured
RELEASE, IMPACT, SLIP, DRAG = "release height", "impact speed", "slip", "drag"
COLLISION, SPEED, DURATION, MARGIN = "collision speed", "greatest speed", "duration", "least margin"
#: endings of the names of values for the distance to a limit
MARGIN_NAME = "margin"
#: m: a thing that is let go lower than this is set down, and hits nothing
SET_DOWN = 0.005
#: m/s²
_GRAVITY = 9.81
#: s: what falls longer is not followed
_FALL = 3.0


class Fact(NamedTuple):
    """A measured value.

    Attributes:
        name: one of the names above.
        thing: of what.
        value: how much; of what may occur several times the largest, of margins the least.
        at: when, s.
        other: onto what it fell, over what it was dragged, what was hit.
        unit: of the value.
    """

    name: str
    thing: str
    value: float
    at: float
    other: str = ""
    unit: str = "m"


@lru_cache(64)
def facts_of(seen: RecordedPaths) -> dict[tuple[str, str], Fact]:
    """Return the largest value of each kind, by name and thing."""
    contacts = RecordedContacts(seen)
    found: dict[tuple[str, str], Fact] = {}
    for fact in _facts(contacts):
        key = fact.name, fact.thing
        if key not in found or fact.value > found[key].value:
            found[key] = fact
    for thing in contacts.things:  # the impact that belongs to the release
        release = found.get((RELEASE, thing))
        if release is not None:
            found[IMPACT, thing] = Fact(
                IMPACT, thing, _impact(contacts, release), release.at, release.other, "m/s"
            )
    return found


def _facts(contacts: RecordedContacts) -> Iterator[Fact]:
    seen = contacts.seen
    if seen.recording.times:
        yield Fact(DURATION, "test", seen.recording.times[-1], seen.recording.times[-1], unit="s")
    for name in contacts.tools:
        yield from (Fact(SPEED, name, speed, time, unit="m/s") for time, speed in _speeds(seen.paths[name]))
    for thing in contacts.things:
        yield from _releases(contacts, thing)
        yield from _slips(contacts, thing)
        yield from _drags(contacts, thing)
    yield from _collisions(contacts)
    for name, path in seen.paths.items():
        if path.track.kind is TrackKind.VALUE and name.endswith(MARGIN_NAME):
            least, time = min((row[0], time) for time, row in zip(path.when, path.rows, strict=True))
            yield Fact(MARGIN, name, least, time, unit=path.track.unit)


def _speeds(path: TrackPath) -> Iterator[tuple[float, float]]:
    """Yield the speed of a thing at each moment, m/s."""
    for (before, previous_point), (after, point) in pairwise(zip(path.when, path.points, strict=True)):
        if after - before > STEP:
            yield after, dist(previous_point, point) / (after - before)


def _releases(contacts: RecordedContacts, thing: str) -> Iterator[Fact]:
    """Yield from how high a thing fell after a robot had last touched it; 0 if it stood on something."""
    path = contacts.seen.paths[thing]
    supports = contacts.supports(thing)
    for _, end in contacts.holds(thing):
        last = path.at(end - 1e-3)
        if end == inf or path.when[last] >= end:
            continue
        under = [name for name, found in supports.items() if is_within(path.when[last], found)]
        if under:
            yield Fact(RELEASE, thing, 0.0, end, under[0])
            continue
        landing = _landing(supports, end)
        if landing is not None:
            begin, other = landing
            fallen = lowest(path, last) - lowest(path, path.at(begin))
            yield Fact(RELEASE, thing, max(0.0, fallen), end, other)


def _landing(supports: Mapping[str, Sequence[ContactSpan]], time: float) -> tuple[float, str] | None:
    """Return when a released thing first touched something, and what; None if it did not."""
    begins = (
        (begin, name)
        for name, found in supports.items()
        for begin, _ in found
        if time - 1e-3 <= begin <= time + _FALL
    )
    return min(begins, default=None)


def _impact(contacts: RecordedContacts, release: Fact) -> float:
    """Return the speed (m/s) at which a thing hit what it fell onto, by its energy at the release.

    Zero for what was set down: how fast it was between two moments, while the arm slowed down, is not known.

    At ten moments a second the first touch may be missed, and what is seen is a bounce.
    """
    path = contacts.seen.paths[release.thing]
    last = path.at(release.at - 1e-3)
    if release.value <= SET_DOWN or last == 0:
        return 0.0
    step = path.when[last] - path.when[last - 1]
    carried = dist(path.points[last - 1], path.points[last]) / step if step > STEP else 0.0
    return sqrt(carried * carried + 2.0 * _GRAVITY * release.value)


def lowest(path: TrackPath, number: int) -> float:
    """Return the height (m) of a thing's lowest corner at a moment; of its centre if its size is unknown."""
    row, size = path.rows[number], path.track.size
    if size is None:
        return row[2]
    return row[2] - sum(abs(part) * edge / 2.0 for part, edge in zip(_upward(row), size, strict=True))


def _upward(row: Row) -> tuple[float, float, float]:
    """Return how far each edge of a thing points upward."""
    if len(row) < 7:
        return 0.0, 0.0, 1.0
    w, x, y, z = row[3:7]
    return 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)


def _slips(contacts: RecordedContacts, thing: str) -> Iterator[Fact]:
    """Yield how far a thing moved in each robot's grip while it touched none of its supports."""
    path = contacts.seen.paths[thing]
    supports = [interval for found in contacts.supports(thing).values() for interval in found]
    for tool, holds in _grips(contacts, thing).items():
        for hold in holds:
            free = [
                number for number, time in enumerate(path.when)
                if is_within(time, [hold]) and not is_within(time, supports)
            ]  # fmt: skip
            if len(free) >= 2:
                ways = _ways(contacts.seen.paths[tool], path, free)
                worst = max(range(len(ways)), key=ways.__getitem__)
                yield Fact(SLIP, thing, ways[worst], path.when[free[worst]])


def _grips(contacts: RecordedContacts, thing: str) -> dict[str, list[ContactSpan]]:
    """Return when a thing is held by each robot, by the robots' tools.

    A body that touches it belongs to the tool in whose frame it moves least meanwhile: robots that hand it
    over touch it at the same time, and carry it one after the other.
    """
    path = contacts.seen.paths[thing]
    found: dict[str, list[ContactSpan]] = {}
    for holds in contacts.holders(thing).values():
        held = [
            [number for number, time in enumerate(path.when) if is_within(time, [hold])] for hold in holds
        ]
        ways = {
            name: max(
                (way for those in held for way in _ways(contacts.seen.paths[name], path, those)), default=0.0
            )
            for name in contacts.tools
        }
        if ways:
            found.setdefault(min(ways, key=ways.__getitem__), []).extend(holds)
    return {tool: joined(holds) for tool, holds in found.items()}


def _ways(tool: TrackPath, path: TrackPath, numbers: Sequence[int]) -> list[float]:
    """Return how far a thing is from its first place in the tool's frame at each of some moments, m."""
    places = [_in_frame(tool.rows[tool.at(path.when[index])], path.points[index]) for index in numbers]
    return [dist(places[0], place) for place in places]


def _in_frame(frame: Row, point: Sequence[float]) -> tuple[float, ...]:
    """Return a point in the frame of a pose; relative to the position if there is no orientation."""
    x, y, z = (a - b for a, b in zip(point, frame[:3], strict=True))
    if len(frame) < 7:
        return x, y, z
    w, a, b, c = frame[3], -frame[4], -frame[5], -frame[6]
    tx, ty, tz = 2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)
    return (
        x + w * tx + b * tz - c * ty,
        y + w * ty + c * tx - a * tz,
        z + w * tz + a * ty - b * tx,
    )


def _drags(contacts: RecordedContacts, thing: str) -> Iterator[Fact]:
    """Yield how far a robot moved a thing over its support; supports that move things are left out."""
    path, holds = contacts.seen.paths[thing], contacts.holds(thing)
    for support, found in contacts.supports(thing).items():
        together = [(begin, end) for begin, end in found if any(a < end and begin < b for a, b in holds)]
        if not together or support in contacts.carriers:
            continue
        way, at = 0.0, None
        for (before, point), (after, next_one) in pairwise(zip(path.when, path.points, strict=True)):
            both = all(is_within(time, holds) and is_within(time, together) for time in (before, after))
            if both and after - before > STEP:
                way += hypot(next_one[0] - point[0], next_one[1] - point[1])
                at = before if at is None else at
        if at is not None:
            yield Fact(DRAG, thing, way, at, support)


def _collisions(contacts: RecordedContacts) -> Iterator[Fact]:
    """Yield when a robot touched something that is not tracked, and its tool's speed just before."""
    for pair, found in contacts.intervals.items():
        robots = [name for name in pair if name in contacts.robots]
        if not robots or contacts.robots >= {*pair} or {*contacts.things} & {*pair}:
            continue
        (other,) = {*pair} - {robots[0]}
        begin = found[0][0]
        tool = contacts.tool_of(robots[0])
        if tool is None:
            continue
        moving = _speeds(contacts.seen.paths[tool])
        speeds = [speed for time, speed in moving if begin - 0.25 <= time <= begin]
        yield Fact(COLLISION, f"{robots[0]}, {other}", max(speeds, default=0.0), begin, other, "m/s")
