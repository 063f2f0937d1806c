"""Reads a story apart and holds each of its parts against what was watched.

Recordings have ten moments a second. Tolerances: heights 6 mm or 10 %, slips 3 mm or 10 %, ways over a
surface 5 mm or 15 %, distances from a path 1.5 mm or 6 % (5 mm of what falls), distances at the end 2 mm or
5 %, speeds of an impact 0.3 m/s or 15 %, the greatest speed of a motion 0.05 m/s or 10 %, angles 1.5 degrees
or 6 %, times 0.15 s, those of a release 0.25 s.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from .cells import Release, Watched, angle, aside, turned_aside

#: parts of a sentence: its groups
Told = Mapping[str, str]
_AMOUNT = r"[\d.e-]+ (?:mm|m/s|m|deg|s)"
_UNITS = {"mm": 1e-3, "m": 1.0, "m/s": 1.0, "deg": 1.0, "s": 1.0}
#: m that count as the same place; and what is let go higher falls
SAME, FALLS = 0.002, 0.01
_ORIGINAL = re.compile(
    rf"(?:at (?P<at>[\d.]+) s, )?(?:on the (?P<on>.+)|(?P<height>{_AMOUNT})(?: above the (?P<over>.+))?)"
)


@dataclass(frozen=True)
class Runs:
    """A test of the original and of a mutant.

    Attributes:
        original, mutant: the cells.
        spread: how far each thing ends apart with other seeds, m.
    """

    original: Watched
    mutant: Watched
    spread: Mapping[str, float]

    def untrue(self, story: str) -> Iterator[str]:
        """Yield what is not true of a story, a line each."""
        for part in story.split("; "):
            matches = ((re.fullmatch(pattern, part), check) for pattern, check in CHECKS.items())
            found = next(((match.groupdict(), check) for match, check in matches if match), None)
            if found is None:
                yield f"{part!r}: cannot be read"
                continue
            told, check = found
            yield from (f"{part!r}: {line}" for line in check(self, told))

    def both(self, told: Told) -> Iterator[tuple[str, Watched, str]]:
        """What is told of the mutant (``now``) and of the original (``then``)."""
        yield "", self.mutant, told["now"]
        yield "original's ", self.original, told["then"]

    def release(self, told: Told) -> Iterator[str]:
        """Let go, from which height above what, and how fast it hit that."""
        known = _ORIGINAL.fullmatch(told["known"])
        yield from self._released("", self.mutant, told)
        if told["known"] == "never":
            found = _highest(self.original, told["part"])
            if found is not None and found.fall > FALLS:
                yield f"the original lets it go as well: {found}"
        elif known is not None:
            usual = {"part": told["part"], "speed": told["usual"], **known.groupdict()}
            yield from self._released("original's ", self.original, usual)

    def _released(self, which: str, cell: Watched, told: Told) -> Iterator[str]:
        found = _highest(cell, told["part"])
        if found is None:
            yield f"{which}was not released"
            return
        if told["at"]:
            yield from off(f"{which}time", f"{told['at']} s", found.at, 0.25, 0.0)
        yield from off(f"{which}height", told["height"] or "none", found.fall, 0.006, 0.1)
        onto = told["over"] or told["on"]
        if onto and onto != found.onto:
            yield f"{which}fell onto {found.onto}"
        if told["speed"]:
            yield from off(f"{which}impact", told["speed"], found.speed, 0.3, 0.15)

    def never_touched(self, told: Told) -> Iterator[str]:
        """What touches in the original alone."""
        if self.mutant.first_touch(told["one"], told["other"]) is not None:
            yield "they touched"
        yield from _touched("original ", self.original, told)

    def hit(self, told: Told) -> Iterator[str]:
        """What touches in the mutant alone, and how fast."""
        yield from _touched("", self.mutant, told)
        if self.original.first_touch(told["one"], told["other"]) is not None:
            yield "they touched in the original"
        begin = self.mutant.first_touch(told["one"], told["other"])
        if told["speed"] and begin is not None:
            tick = max(0, int(np.searchsorted(self.mutant.times, begin)) - 2)
            own = [name for name in self.mutant.tools if told["one"].startswith(name.removesuffix("tool"))]
            fastest = max(float(self.mutant.speeds(name)[tick]) for name in own)
            yield from off("speed", told["speed"], fastest, 0.1, 0.25)

    def slip(self, told: Told) -> Iterator[str]:
        """How far it slipped in the grip."""
        for which, cell, far in self.both(told):
            yield from off(f"{which}slip", far, cell.slip(told["part"]), 0.003, 0.1)

    def drag(self, told: Told) -> Iterator[str]:
        """How far it was dragged."""
        for which, cell, far in self.both(told):
            yield from off(f"{which}way", far, cell.drag(told["part"], told["other"]), 0.005, 0.15)

    def speed(self, told: Told) -> Iterator[str]:
        """The greatest speed."""
        for which, cell, fast in self.both(told):
            yield from off(f"{which}speed", fast, float(cell.speeds(told["part"]).max()), 0.05, 0.1)

    def margin(self, told: Told) -> Iterator[str]:
        """The least margin."""
        for which, cell, near in self.both(told):
            yield from off(f"{which}margin", near, float(cell.values[told["part"]].min()), 0.5, 0.1)

    def duration(self, told: Told) -> Iterator[str]:
        """How long the test took."""
        for which, cell, seconds in self.both(told):
            text = seconds if seconds.endswith(" s") else f"{seconds} s"
            yield from off(f"{which}duration", text, float(cell.times[-1]), 0.15, 0.0)

    def late(self, told: Told) -> Iterator[str]:
        """The same, later or earlier; how much that is may not be told."""
        yield from self._same_world()
        sign = -1.0 if told.get("way") == "earlier" else 1.0
        if "far" in told:
            yield from off("delay", told["far"], max(sign * delay for delay in self._delays()), 0.15, 0.1)

    def no_delay(self, told: Told) -> Iterator[str]:
        """The same at nearly the same times."""
        yield from self._same_world()
        yield from off("delay", "0 s", max(map(abs, self._delays())), 0.15, 0.0)

    def _delays(self) -> list[float]:
        delays = [float(self.mutant.times[-1] - self.original.times[-1])]
        for tool in self.original.tools:
            before, after = self.original.starts(tool), self.mutant.starts(tool)
            delays += (after - before).tolist() if len(before) == len(after) else []
        return delays

    def _same_world(self) -> Iterator[str]:
        for name, pose in self.original.poses.items():
            other = self.mutant.poses[name]
            far = max(float(np.linalg.norm(pose[-1, :3] - other[-1, :3])), aside(other[:, :3], pose[:, :3]))
            if far > SAME:
                yield f"{name} is {far:.4f} m away"

    def ended(self, told: Told) -> Iterator[str]:
        """How far from its place or value it ended."""
        name, far = told["part"], told["end"]
        if name in self.original.poses:
            before, after = self.original.poses[name][-1], self.mutant.poses[name][-1]
            yield from off("distance", far, float(np.linalg.norm(before[:3] - after[:3])), 0.002, 0.05)
        else:
            values = self.original.values[name][-1] - self.mutant.values[name][-1]
            yield from off("difference", far, abs(float(values)), 1e-3, 0.05)

    def ended_turned(self, told: Told) -> Iterator[str]:
        """By which angle it ended turned."""
        before, after = (cell.poses[told["part"]][-1, 3:] for cell in (self.original, self.mutant))
        yield from off("angle", told["far"], angle(before, after), 1.5, 0.06)

    def left(self, told: Told) -> Iterator[str]:
        """How far it left its path, and where it ended."""
        yield from self._path(told["part"], told["far"])
        yield from self.ended(told)

    def detour(self, told: Told) -> Iterator[str]:
        """How far things left their paths, and that they came back."""
        for name, far in zip(told["names"].split(" and "), told["far"].split(" and "), strict=True):
            yield from self._path(name, far)
            last = self.original.poses[name][-1, :3], self.mutant.poses[name][-1, :3]
            away = float(np.linalg.norm(last[0] - last[1]))
            if told["end"] and away > max(SAME, self.spread.get(name, 0.0)):
                yield f"{name} ended {away:.4f} m away"

    def _path(self, name: str, far: str) -> Iterator[str]:
        true = aside(self.mutant.poses[name][:, :3], self.original.poses[name][:, :3])
        falls = name in self.mutant.parts and any(
            release.fall > FALLS for release in self.mutant.releases(name)
        )
        yield from off(f"way of {name}", far, true, 0.005 if falls else 0.0015, 0.06)

    def turned(self, told: Told) -> Iterator[str]:
        """By which angle it was turned on its way."""
        before, after = (cell.poses[told["part"]][:, 3:] for cell in (self.original, self.mutant))
        yield from off("angle", told["far"], turned_aside(after, before), 1.5, 0.06)

    def held_on(self, told: Told) -> Iterator[str]:
        """Never let go."""
        if not self.mutant.partners(told["part"])[0][-1]:
            yield "no robot touches it at the end"
        yield from _last_held("original's ", self.original, told["part"], told["then"])

    def lost(self, told: Told) -> Iterator[str]:
        """Let go earlier or later."""
        for which, cell, time in self.both(told):
            yield from _last_held(which, cell, told["part"], time)


def off(what: str, told: str, true: float, least: float, share: float) -> Iterator[str]:
    """A number that is not as it is told; ``none`` is zero."""
    amount, _, unit = told.partition(" ")
    value = 0.0 if told == "none" else float(amount) * _UNITS[unit]
    if abs(value - true) > max(least, share * abs(true)):
        yield f"{what} is {true:.4g}, not {told}"


def _highest(cell: Watched, part: str) -> Release | None:
    return max(cell.releases(part), key=lambda release: release.fall, default=None)


def _touched(which: str, cell: Watched, told: Told) -> Iterator[str]:
    begin = cell.first_touch(told["one"], told["other"])
    if begin is None or abs(begin - float(told["at"])) > 0.15:
        yield f"{which}touched at {begin}"


def _last_held(which: str, cell: Watched, part: str, time: str) -> Iterator[str]:
    held = np.flatnonzero(cell.partners(part)[0])
    last = float(cell.times[held[-1]]) if len(held) else 0.0
    yield from off(f"{which}time", f"{time} s", last, 0.25, 0.0)


_BOTH = rf"(?P<now>{_AMOUNT}) \(original: (?P<then>none|{_AMOUNT})\)"
_TIMES = r"(?P<at>[\d.]+) s"
#: how each part of a story reads, and what checks it
CHECKS: dict[str, Callable[[Runs, Told], Iterator[str]]] = {
    rf"(?P<part>.+) was (?:let go|lost|set down) (?:at {_TIMES}, )?"
    rf"(?:(?P<height>{_AMOUNT}) above the (?P<over>.+?)|on the (?P<on>.+?)) \(original: (?P<known>.+?)\)"
    rf"(?: and hit it with (?P<speed>{_AMOUNT})(?: \(original: (?P<usual>{_AMOUNT})\))?)?": Runs.release,
    r"the test ended at (?P<now>[\d.]+) s instead of (?P<then>[\d.]+) s": Runs.duration,
    r"(?P<part>.+) was never let go \(original: at (?P<then>[\d.]+) s\)": Runs.held_on,
    r"(?P<part>.+) was lost at (?P<now>[\d.]+) s \(original: let go at (?P<then>[\d.]+) s\)": Runs.lost,
    rf"(?P<one>.+) never touched (?P<other>.+) \(original: at {_TIMES}\)": Runs.never_touched,
    rf"(?P<one>.+) (?:touched|hit) the (?P<other>.+) at {_TIMES}(?: with (?P<speed>{_AMOUNT}))? "
    r"\(original: never\)": Runs.hit,
    rf"(?P<part>.+) slipped {_BOTH} in the grip": Runs.slip,
    rf"(?P<part>.+) was dragged {_BOTH} over the (?P<other>.+)": Runs.drag,
    rf"(?P<part>.+) moved at up to {_BOTH}": Runs.speed,
    rf"(?P<part>.+) fell to {_BOTH}": Runs.margin,
    rf"the same movements happened up to (?P<far>{_AMOUNT}) (?P<way>later|earlier)": Runs.late,
    rf"the same movements happened at most (?P<far>{_AMOUNT}) earlier or later": Runs.no_delay,
    "the same movements happened at other times": Runs.late,
    rf"the test took {_BOTH}": Runs.duration,
    rf"(?P<part>.+) ended turned by (?P<far>{_AMOUNT})": Runs.ended_turned,
    rf"(?P<part>.+) left its path by up to (?P<far>{_AMOUNT}) and ended (?P<end>{_AMOUNT}) from its "
    "position in the original": Runs.left,
    rf"(?P<part>.+) ended (?P<end>{_AMOUNT}) from its (?:position|value) in the original": Runs.ended,
    rf"(?P<names>.+) left (?:its|their) paths? by up to (?P<far>{_AMOUNT}(?: and {_AMOUNT})?)"
    "(?P<end> but reached the correct end positions?)?": Runs.detour,
    rf"(?P<part>.+) was turned by up to (?P<far>{_AMOUNT}) on its way": Runs.turned,
}
