"""What parts of messages mean that no convention tells of: by their own names, and by where they pass."""

from __future__ import annotations

import re
from collections.abc import Sequence

from mutabot.proposal.guess import Guess, Setting, guess_argument, guess_reading
from mutabot.proposal.sequences import guess_elements

from .seen import Part

#: names of fields that say nothing: the name of the topic or service does
_EMPTY = frozenset({"", "data", "value"})
_WAITS = frozenset({"wait", "sleep", "pause", "dwell", "delay", "duration"})
_GRIPPER = re.compile(r"grip|hand$|finger|claw|jaw|vacuum|suction")
_JOINT = re.compile(r"joints?|(?:move|servo)j")
_POSE_LENGTH, _TURN = 6, "[3:6]"
#: values that are settings, and no scale
_LEAST_VALUES, _MOST_VALUES = 2, 5
#: no joint turns further, rad
_FULL_TURN = 6.5


def by_name(part: Part, words: Sequence[str], *, is_written: bool) -> dict[str, Guess]:
    """What a part means, by path; an empty guess for a path of which nothing tells."""
    own = part.within[-1][1] if part.within else ""
    if part.length == 0:
        return {}
    if part.length is not None:
        return _elements(part, own, words, is_written=is_written)
    values = [value for value in part.values if value is not None]
    if not values:
        return {}
    if all(isinstance(value, bool) for value in values):
        guess = _switch(words) if is_written else Guess({"kind": "flag"})
    elif all(isinstance(value, str) for value in values):
        guess = _label(part) if not part.path and not is_written else Guess()
    else:
        guess = _number(part, own, words, is_written=is_written)
    return {part.path: guess} if guess.table else {}


def _switch(words: Sequence[str]) -> Guess:
    is_gripper = any(_GRIPPER.search(word) for word in words)
    return Guess({"kind": "opening" if is_gripper else "output", "values": [False, True]})


def _label(part: Part) -> Guess:
    many = _LEAST_VALUES <= len(part.values) <= _MOST_VALUES
    return Guess({"kind": "label", "values": list(part.values)}, ["values"]) if many else Guess()


def _number(part: Part, own: str, words: Sequence[str], *, is_written: bool) -> Guess:
    is_empty = own in _EMPTY
    if is_empty and is_written and _WAITS & set(words):
        return Guess({"kind": "duration", "unit": "s"})
    name = "_".join(words[-1:]) if is_empty else own
    setting = Setting("_".join(words), "", "", part.values)
    guess = guess_argument(name, setting) if is_written else guess_reading(name, setting)
    if guess.table and guess.table.get("kind") not in ("label", "flag"):
        return _in_radians(guess, part.values)
    if is_empty and _is_whole(part) and _LEAST_VALUES <= len(part.values) <= _MOST_VALUES:
        kind = "output" if is_written else "label"
        return Guess({"kind": kind, "values": list(part.values)}, ["values"])
    return Guess()


def _is_whole(part: Part) -> bool:
    return bool(part.within) and all(isinstance(value, int) for value in part.values)


def _elements(part: Part, own: str, words: Sequence[str], *, is_written: bool) -> dict[str, Guess]:
    assert part.length is not None
    name = "joints" if any(_JOINT.fullmatch(word) for word in words) and not _says_speed(own) else own
    setting = Setting("_".join(words), "", "", part.values)
    found = guess_elements(name, part.length, setting, written=is_written)
    numbers = [number for values in part.values for number in values]
    told = {f"{part.path}{step}": _in_radians(guess, numbers) for step, guess in found.items()}
    if part.length == _POSE_LENGTH and name != "joints" and f"{part.path}{_TURN}" in told:
        told[f"{part.path}{_TURN}"] = Guess()  # Euler angles of some order, or a rotation vector
    return told


def _says_speed(name: str) -> bool:
    return re.search(r"vel|speed|acc|effort|torque", name) is not None


def _in_radians(guess: Guess, values: Sequence[object]) -> Guess:
    """Angles of ROS are radians, if nothing says otherwise and they are no larger than a turn."""
    if "unit" in guess.checks and guess.table.get("unit") == "deg":
        largest = max((abs(value) for value in values if isinstance(value, int | float)), default=0.0)
        if largest <= _FULL_TURN:
            guess.table["unit"] = "rad"
    return guess
