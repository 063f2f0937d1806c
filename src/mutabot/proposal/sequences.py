"""Guessing what the elements of a sequence mean: joint angles, a pose, an action."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from .guess import Guess, Setting, measured, moved

_JOINTS = re.compile(r"(?:^|_)(?:movej|servoj|getj|joints?|jnts?|q|qpos|angles?|actual_q|target_q)(?:_|$)")
_POSES = re.compile(
    r"(?:^|_)(?:move[lpc]?|servo[lp]|getl|[ts]?pose[s]?|tcp|xyz|pos|position[s]?|target|goal|location|locate|where"
    r"|point|waypoint|translation|translate|offset|goto|coords?)(?:_|$)"
)
_TURNS = re.compile(r"(?:^|_)(?:orientation|rotation|rotvec|rpy|euler|orn)(?:_|$)")
_NO_PLACES = re.compile(r"speed|veloc|acc|force|torque|wrench|gain|weight|colou?r|rgb|limit|radius|size|vel")
_ACTIONS = frozenset({"action", "actions", "act", "a", "u"})
_MOST_JOINTS = 12
_AXES = {2: "xy", 3: "xyz"}


def guess_elements(name: str, length: int, setting: Setting, *, written: bool) -> dict[str, Guess]:
    """What the elements mean, by the index or slice; nothing if neither the name nor the callable's tells.

    ``setting.constants`` are the sequences that were seen.
    """
    name, words = name.lower(), f"{setting.words}_{name.lower()}"
    if _NO_PLACES.search(name) or re.search(r"speed[jl]", setting.words):
        return {}
    if written and name in _ACTIONS and "step" in words:
        return {f"[{index}]": _action(index, setting.constants) for index in range(min(length, 12))}
    for about in (name, words):
        if _JOINTS.search(about) and length <= _MOST_JOINTS:
            return _joints(length, setting, written)
        if _TURNS.search(about) and length == 3:
            return {"[0:3]": _turn("xyz", _flat(setting), written)}
        if _POSES.search(about) and length in (2, 3, 6, 7):
            return _pose(length, setting, written)
    return {}


def _joints(length: int, setting: Setting, written: bool) -> dict[str, Guess]:
    axis = "j1" if length == 1 else f"j1..j{length}"
    flat = _flat(setting)
    if written:
        return {f"[0:{length}]": moved("rotation", axis, None, None, flat)}
    return {f"[0:{length}]": measured({"kind": "angle", "axis": axis}, "angle", None, flat)}


def _pose(length: int, setting: Setting, written: bool) -> dict[str, Guess]:
    place = min(length, 3)
    axis, flat = _AXES[place], _flat(setting, slice(0, place))
    if written:
        found = {f"[0:{place}]": moved("translation", axis, None, None, flat)}
    else:
        table = {"kind": "position", "axis": axis}
        found = {f"[0:{place}]": measured(table, "length", None, flat)}
    if length == 6:
        found["[3:6]"] = _turn("xyz", _flat(setting, slice(3, 6)), written)
    return found


def _turn(axis: str, setting: Setting, written: bool) -> Guess:
    if written:
        return moved("rotation", axis, None, None, setting)
    return measured({"kind": "orientation", "axis": axis}, "angle", None, setting)


def _action(index: int, seen: Sequence[Any]) -> Guess:
    """An element of a policy's action: a number on a scale of the simulator's own."""
    numbers = [values[index] for values in seen if len(values) > index]
    most = max([1.0, *(abs(number) for number in numbers)])
    return Guess({"kind": "output", "range": [-most, most]}, ["range"])


def _flat(setting: Setting, part: slice = slice(None)) -> Setting:
    numbers = [number for values in setting.constants for number in values[part]]
    return Setting(setting.words, setting.doc, setting.annotation, numbers)
