"""Contacts in a recording: which bodies touch when, and which are things, robots and supports."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise, takewhile
from math import hypot, inf
from typing import TYPE_CHECKING

from mutabot.evidence.paths import STEP, RecordedPaths
from mutabot.evidence.recording import Recording, TrackKind

if TYPE_CHECKING:
    from mutabot.evidence.differences import BodyPair

#: from when to when two bodies touch, s; inf if they do at the end
ContactSpan = tuple[float, float]
#: names of what no simulator calls a robot
_GROUND = frozenset({"floor", "ground", "plane", "world"})
#: s in which a support carries a thing that no robot touches, and how fast the thing moves then, m/s
_CARRIED, _CARRYING = 0.2, 0.005
#: s: a contact that is lost for less goes on
_FLICKER = 0.25


def intervals_of(recording: Recording) -> dict[BodyPair, list[ContactSpan]]:
    """Return when each pair of bodies touches, in order."""
    found: dict[BodyPair, list[ContactSpan]] = {}
    for moment in recording.moments:
        pair = tuple(moment.text.split(", ", 1))
        if moment.what == "touch":
            found.setdefault(pair, []).append((moment.time, inf))
        elif moment.what == "part" and pair in found:
            found[pair][-1] = (found[pair][-1][0], moment.time)
    return found


def joined(intervals: Iterable[ContactSpan]) -> list[ContactSpan]:
    """Return intervals in order, with those merged that overlap or nearly meet."""
    found: list[ContactSpan] = []
    for begin, end in sorted(intervals):
        if found and begin <= found[-1][1] + _FLICKER:
            found[-1] = (found[-1][0], max(end, found[-1][1]))
        else:
            found.append((begin, end))
    return found


@dataclass(frozen=True)
class RecordedContacts:
    """The contacts in a recording.

    Attributes:
        seen: the recording with its paths.
    """

    seen: RecordedPaths

    @cached_property
    def intervals(self) -> Mapping[BodyPair, list[ContactSpan]]:
        """When each pair touches."""
        return intervals_of(self.seen.recording)

    @cached_property
    def things(self) -> list[str]:
        """The tracked bodies that have contacts: objects that a robot can move."""
        touched = {name for pair in self.intervals for name in pair}
        paths = self.seen.paths.items()
        return [name for name, path in paths if path.track.kind is not TrackKind.VALUE and name in touched]

    @cached_property
    def tools(self) -> list[str]:
        """The other tracked bodies: the robots' tools."""
        paths = self.seen.paths.items()
        places = [name for name, path in paths if path.track.kind is not TrackKind.VALUE]
        return [name for name in places if name not in self.things and not self.seen.paths[name].track.size]

    @cached_property
    def robots(self) -> frozenset[str]:
        """The bodies of robots: those that the simulator names, else all that move and are not tracked."""
        recording = self.seen.recording
        if recording.robots:
            return frozenset(recording.robots)
        others = {*self.seen.paths, *(block.name for block in recording.blocks)} | _GROUND
        return frozenset({name for pair in self.intervals for name in pair} - others)

    @cached_property
    def carriers(self) -> frozenset[str]:
        """The bodies that move things lying on them, as conveyors do."""
        found = set()
        for thing in self.things:
            held = [(begin - _CARRIED, end + _CARRIED) for begin, end in self.holds(thing)]
            for other, spans in self.supports(thing).items():
                lies = [(begin + _CARRIED, end) for begin, end in spans if end - begin > _CARRIED]
                if other not in found and lies and self._moves(thing, lies, held):
                    found.add(other)
        return frozenset(found)

    def _moves(self, thing: str, lies: list[ContactSpan], held: list[ContactSpan]) -> bool:
        """Return whether a thing moves over the ground while it lies on something and is not held."""
        path = self.seen.paths[thing]
        for (before, previous_point), (after, point) in pairwise(zip(path.when, path.points, strict=True)):
            way = hypot(point[0] - previous_point[0], point[1] - previous_point[1])
            if after - before <= STEP or way <= _CARRYING * (after - before):
                continue
            is_held = is_within(before, held) or is_within(after, held)
            if is_within(before, lies) and is_within(after, lies) and not is_held:
                return True
        return False

    def holds(self, thing: str) -> list[ContactSpan]:
        """Return the intervals in which any robot touches a thing."""
        return joined(interval for found in self.holders(thing).values() for interval in found)

    def holders(self, thing: str) -> dict[str, list[ContactSpan]]:
        """Return the intervals in which a thing touches each body of a robot, by their names."""
        return {
            body: found
            for pair, found in self.intervals.items()
            if thing in pair
            for body in self.robots & {*pair} - {thing}
        }

    def tool_of(self, body: str) -> str | None:
        """Return the tool of the robot to which a body belongs; None if names do not say of which of several.

        Bodies and tools of one robot share what their names begin with: ``left/arm`` and ``left/tool``.
        """
        shared = {
            name: sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(name, body, strict=False)))
            for name in self.tools
        }
        best = [name for name in shared if shared[name] == max(shared.values())]
        return best[0] if len(best) == 1 else None

    def supports(self, thing: str) -> dict[str, list[ContactSpan]]:
        """Return the intervals in which a thing touches other bodies than robots, by their names."""
        found = {}
        for pair, intervals in self.intervals.items():
            (other,) = {*pair} - {thing} if thing in pair and len({*pair}) > 1 else ("",)
            if other and other not in self.robots:
                found[other] = intervals
        return found


def is_within(time: float, intervals: Iterable[ContactSpan]) -> bool:
    """Return whether a moment lies in one of the intervals; the moment at which one ends does not."""
    return any(begin <= time < end for begin, end in intervals)
