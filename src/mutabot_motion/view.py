"""The data of a view: one test of the original and of a mutant, with descriptions and events."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from mutabot.api.reports import RecordedPaths

Coordinates = tuple[float, float, float]
#: name, centre, size (m) and colour of a box that never moves, see docs/motion.md
DrawnBlock = tuple[str, Coordinates, Coordinates, tuple[float, ...] | None]
#: of both sides: red, green and blue distinguishable with any kind of colour vision
COLOURS = {"original": (86, 180, 233), "mutant": (230, 159, 0)}
#: of blocks without a wish
BLOCK = (150, 156, 164)


@dataclass(frozen=True, slots=True)
class MotionView:
    """A test in one round.

    Attributes:
        number: the mutant's number.
        id: its id.
        what: description of what it changes.
        place: ``file:line``.
        test: node id.
        round: 0-based.
        original, mutant: what was recorded; None if there is nothing. A mutant in which nothing that is
            recorded differs has none on disk.
        story: what happened, in a sentence; empty if nothing is known.
        apart: when both went different ways, s; None if they never did, or if that is not known.
        ended: how the test ended in the original and in the mutant, such as ``passed``; empty if that is not
            known.
    """

    number: int
    id: str
    what: str
    place: str
    test: str
    round: int
    original: RecordedPaths | None
    mutant: RecordedPaths | None
    story: str = ""
    apart: float | None = None
    ended: tuple[str, str] = ("", "")

    @property
    def name(self) -> str:
        """The base name of its files."""
        return f"mutant-{self.number}-round-{self.round + 1}"

    @property
    def title(self) -> str:
        """The mutant's number, and what it changes."""
        return f"mutant {self.number} · {self.place} · {self.what}"

    @property
    def fault(self) -> float | None:
        """The time when the mutant first changed something, s; None if it did not."""
        return self.mutant.recording.fault if self.mutant is not None else None

    @property
    def sides(self) -> tuple[tuple[str, RecordedPaths], ...]:
        """The existing recordings, with the names of their sides."""
        both = ("original", self.original), ("mutant", self.mutant)
        return tuple((name, found) for name, found in both if found is not None)

    @property
    def blocks(self) -> list[DrawnBlock]:
        """The surroundings on both sides, each block once."""
        return list(dict.fromkeys(block for _, found in self.sides for block in found.recording.blocks))

    @property
    def about(self) -> dict[str, str]:
        """The general facts about it, each with a label."""
        found = {
            "mutant": str(self.number),
            "id": self.id,
            "what": self.what,
            "test": self.test,
            "round": str(self.round + 1),
            "clock": self.clock,
            "story": self.story,
            "fault": "" if self.fault is None else f"{self.fault:.3f} s",
        }
        return {name: text for name, text in found.items() if text}

    @property
    def clock(self) -> str:
        """The description of the clock of all times."""
        return (
            "simulated time" if all(found.recording.is_simulated for _, found in self.sides) else "wall clock"
        )


def end_of(recorded: RecordedPaths) -> float:
    """Return the last time in a recording, s."""
    recording = recorded.recording
    calls = (call.ended for call in recording.calls if call.ended is not None)
    moments = (moment.time for moment in recording.moments)
    return max((*recording.times[-1:], *calls, *moments), default=0.0)


def things_in(recorded: RecordedPaths) -> list[str]:
    """Return the names of the things that move."""
    return [name for name, path in recorded.paths.items() if path.track.kind != "value"]


def values_in(recorded: RecordedPaths) -> list[str]:
    """Return the names of the values over time."""
    return [name for name, path in recorded.paths.items() if path.track.kind == "value"]


_TOUCH = {"touch": "{} touch", "part": "{} no longer touch"}


class Weight(IntEnum):
    """The importance of a line."""

    READING = 0
    COMMAND = 1
    FAULT = 2


@dataclass(frozen=True, slots=True)
class ViewEvent:
    """A line about an event.

    Attributes:
        time: s.
        text: what happened.
        weight: how much it says.
        file, line: where in the program; empty and 0 if it is nowhere there.
    """

    time: float
    text: str
    weight: Weight = Weight.COMMAND
    file: str = ""
    line: int = 0


def events(view: MotionView, recorded: RecordedPaths) -> list[ViewEvent]:
    """Return all events of one side, in order of time; calls without a time are left out."""
    recording, found = recorded.recording, []
    for call in recording.calls:
        if call.began is None:
            continue
        file, _, line = call.place.rpartition(":")
        text = _call_text(call.pattern or call.operation.rpartition(":")[2], call.written, call.read)
        weight = Weight.COMMAND if call.written or not call.read else Weight.READING
        found.append(ViewEvent(call.began, text, weight, file, int(line) if line.isdigit() else 0))
    for moment in recording.moments:
        text = _TOUCH.get(moment.what, "{}").format(moment.text.replace(", ", " and "))
        found.append(ViewEvent(moment.time, text))
    if recording.fault is not None:
        found.append(ViewEvent(recording.fault, f"FAULT: {view.what}", Weight.FAULT))
    return sorted(found, key=lambda event: event.time)


def _call_text(name: str, written: Mapping[str, Any], read: Mapping[str, Any]) -> str:
    """Return a call with its values: the non-zero written ones, if any."""
    wrote = {part: value for part, value in written.items() if value != 0} or written
    return " ".join(filter(None, (name, _values(wrote), f"reads {_values(read)}" if read else "")))


def _values(values: Mapping[str, Any]) -> str:
    return ", ".join(f"{name}={_number(value)}" for name, value in values.items())


def _number(value: Any) -> str:
    return f"{value:.5g}" if isinstance(value, float) else str(value)
