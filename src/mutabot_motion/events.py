"""What happened in a recording, as lines of a log: calls, contacts, notes, and the fault."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from mutabot.evidence.recording import Moment, Recording, Told

from .shown import Shown

_TOUCH = {"touch": "{} touch", "part": "{} no longer touch"}


class Weight(IntEnum):
    """How much a line says."""

    READING = 0
    COMMAND = 1
    FAULT = 2


@dataclass(frozen=True, slots=True)
class Event:
    """One line.

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


def events(shown: Shown, recording: Recording) -> list[Event]:
    """All of one side, in the order of their times; calls without a time are left out."""
    found = [_call(one) for one in recording.calls if one.began is not None]
    found += [Event(one.time, _moment(one)) for one in recording.moments]
    if recording.fault is not None:
        found.append(Event(recording.fault, f"FAULT: {shown.what}", Weight.FAULT))
    return sorted(found, key=lambda one: one.time)


def _call(call: Told) -> Event:
    assert call.began is not None
    file, _, line = call.place.rpartition(":")
    name = call.pattern or call.operation.rpartition(":")[2]
    read = f"reads {_values(call.read)}" if call.read else ""
    written = {part: value for part, value in call.written.items() if value != 0} or call.written
    said = " ".join(part for part in (name, _values(written), read) if part)
    weight = Weight.COMMAND if call.written or not call.read else Weight.READING
    return Event(call.began, said, weight, file, int(line) if line.isdigit() else 0)


def _values(values: Mapping[str, Any]) -> str:
    return ", ".join(f"{name}={_number(value)}" for name, value in values.items())


def _number(value: Any) -> str:
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def _moment(moment: Moment) -> str:
    return _TOUCH.get(moment.what, "{}").format(moment.text.replace(", ", " and "))
