"""Guessing what arguments and results mean from their names, annotations and docstrings.

The elements of a sequence are joint angles, a pose, an action.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

#: a quantity as a vocabulary writes it
Table = dict[str, Any]

_AXIS = re.compile(r"(?P<delta>d|delta_|offset_)?(?P<axis>[xyz])")
_TURN = re.compile(r"(?:d|delta_)?(?:theta|rot|rotation|angle|euler|r|a|w)_?(?P<axis>[xyz])")
_NAMED_TURNS = {"yaw": "z", "pitch": "y", "roll": "x", "heading": "z"}
_TURNS = frozenset({"angle", "theta", "rotation", "degrees", "deg", "radians", "rad", "turn"})
_JOINT = re.compile(r"(?:j|joint_?|q|axis_?|a)(?P<number>[1-9]|1[0-2])")
_HEIGHTS = frozenset({"height", "depth", "lift", "drop"})
_LENGTHS = frozenset({"distance", "length", "dist", "step", "amount", "travel"})
_TIMES = frozenset(
    {"seconds", "secs", "sec", "duration", "delay", "dwell", "pause", "milliseconds", "time", "t"}
)
_OPENINGS = frozenset(
    {"position", "opening", "width", "pos", "fraction", "value", "state", "command", "percent"}
)
_SWITCHES = frozenset(
    {"on", "state", "enabled", "value", "val", "signal", "level", "active", "closed", "open", "grip"}
)
_UNIT_WORDS = {
    "mm": "mm", "millimetre": "mm", "millimeter": "mm", "cm": "cm", "centimetre": "cm", "centimeter": "cm",
    "m": "m", "metre": "m", "meter": "m", "metres": "m", "meters": "m",
    "deg": "deg", "degree": "deg", "degrees": "deg", "°": "deg",
    "rad": "rad", "radian": "rad", "radians": "rad",
    "s": "s", "sec": "s", "second": "s", "seconds": "s",
    "ms": "ms", "millisecond": "ms", "milliseconds": "ms",
}  # fmt: skip
_UNITS_OF = {"length": ("m", "cm", "mm"), "angle": ("deg", "rad"), "time": ("s", "ms")}
_RELATIVE = re.compile(
    r"(?:^|_)(?:by|relative|rel|offset|shift|jog|translate|rotate|turn|forward|back|lift|drop|delta)"
)
_ABSOLUTE = re.compile(
    r"(?:^|_)(?:to|absolute|abs|goto|target|set|move[ljpc]|servo[ljc]|[ljp]_?move|ptp|lin)(?:_|$)"
)
_GRIPPER = re.compile(r"grip|(?:^|_)hand(?:_|$)|finger|claw|jaw|vacuum|suction")
_OUTPUT = re.compile(r"output|digital|signal|valve|relay|lamp|coil|(?:^|_)io(?:_|$)|(?:^|_)do(?:_|$)")


#: more different numbers than these are no settings, but a scale
_MOST_VALUES = 5


@dataclass
class Guess:
    """A quantity and how sure we are.

    Attributes:
        table: the quantity; empty if nothing could be guessed.
        checks: what the user should look at.
        seen: values that were seen, in words; empty if they are shown elsewhere.
    """

    table: Table = field(default_factory=dict)
    checks: list[str] = field(default_factory=list)
    seen: str = ""


@dataclass(frozen=True)
class Setting:
    """Where a name stands.

    Attributes:
        words: names of the callable, its class and module, in lower case.
        doc: docstrings of the callable and its class.
        annotation: type as written, or empty.
        constants: values that were seen, and what the program compares them with.
    """

    words: str
    doc: str = ""
    annotation: str = ""
    constants: Sequence[Any] = ()


def is_complete(guess: Guess) -> bool:
    """Whether a vocabulary takes it as it is: a label needs all its values."""
    return guess.table.get("kind") != "label" or "values" in guess.table


def guess_argument(name: str, setting: Setting) -> Guess:
    """What an argument means; an empty guess if its name says nothing."""
    stem, unit = split_unit(name.lower())
    if _GRIPPER.search(setting.words) and stem in _OPENINGS | _SWITCHES:
        return _opening(stem, unit, setting)
    if (_OUTPUT.search(setting.words) and stem in _SWITCHES) or _is_switch(stem, setting):
        return _switch(setting)
    motion = _motion(stem)
    if motion is not None:
        kind, axis, relative = motion
        return moved(kind, axis, relative, unit, setting)
    if stem in _TIMES and "timeout" not in name:
        unit = "ms" if "milli" in stem else unit
        return measured({"kind": "duration"}, "time", unit, setting)
    return Guess()


def guess_reading(name: str, setting: Setting) -> Guess:
    """What a result, or the part of it with this name, means."""
    stem, unit = split_unit(name.lower())
    motion = _motion(stem)
    if motion is not None and stem not in _LENGTHS | _HEIGHTS:
        kind, axis, _ = motion
        if axis is not None and axis.startswith("j"):
            return measured({"kind": "angle", "axis": axis}, "angle", unit, setting)
        turned = kind == "rotation"
        table = {"kind": "orientation" if turned else "position", **({"axis": axis} if axis else {})}
        return measured(table, "angle" if turned else "length", unit, setting)
    return _plain_reading(stem, unit, setting)


def _plain_reading(stem: str, unit: str | None, setting: Setting) -> Guess:
    words = set(re.split(r"[_\W]+", f"{stem} {setting.words}"))
    if setting.annotation == "bool" or re.match(r"(is|has|can)_", stem):
        return Guess({"kind": "flag"})
    if setting.annotation.startswith("Literal") or words & {
        "color",
        "colour",
        "label",
        "kind",
        "type",
        "category",
    }:
        return _label(setting)
    if setting.annotation == "str":
        return _label(setting)
    if words & {"angle", "joint", "heading"}:
        return measured({"kind": "angle"}, "angle", unit, setting)
    if words & {"distance", "range", "gap", "height", "width", "length", "depth", "ultrasonic", "lidar"}:
        return measured({"kind": "distance"}, "length", unit, setting)
    return Guess()


def _motion(stem: str) -> tuple[str, str | None, bool | None] | None:
    """Kind, axis and whether it is relative, where the name alone shows a motion."""
    if match := _AXIS.fullmatch(stem):
        return "translation", match["axis"], True if match["delta"] else None
    if match := _TURN.fullmatch(stem):
        return "rotation", match["axis"], None
    if match := _JOINT.fullmatch(stem):
        return "rotation", f"j{match['number']}", False
    if stem in _NAMED_TURNS or stem.removeprefix("d") in _NAMED_TURNS:
        return "rotation", _NAMED_TURNS.get(stem) or _NAMED_TURNS[stem[1:]], None
    if stem in _TURNS:
        return "rotation", None, None
    if stem in _HEIGHTS:
        return "translation", "z", None
    return ("translation", None, True) if stem in _LENGTHS else None


def moved(kind: str, axis: str | None, relative: bool | None, unit: str | None, setting: Setting) -> Guess:
    """A commanded motion; ``relative`` and ``unit`` are None where the name does not tell."""
    table: Table = {"kind": kind, **({"axis": axis} if axis else {})}
    guess = measured(table, "angle" if kind == "rotation" else "length", unit, setting)
    mode = {True: "by", False: "to", None: None}[relative]
    if mode is None and _ABSOLUTE.search(setting.words) and not re.search(r"_by(?:_|$)", setting.words):
        mode = "to"
    elif mode is None and (_RELATIVE.search(setting.words) or "relative" in setting.doc.lower()):
        mode = "by"
    if mode is None:
        guess.checks.append("mode")
    guess.table["mode"] = mode or "to"
    return guess


def measured(table: Table, dimension: str, unit: str | None, setting: Setting) -> Guess:
    """A quantity with a unit: as its name or a docstring says, else as its values look."""
    fitting = _UNITS_OF[dimension]
    if unit not in fitting:
        said = [_UNIT_WORDS.get(word) for word in re.findall(r"[^\W\d_]+|°", setting.doc.lower())]
        unit = next((one for one in said if one in fitting), None)
    if unit is not None:
        return Guess({**table, "unit": unit})
    return Guess({**table, "unit": _unit_by_size(dimension, setting.constants) or fitting[0]}, ["unit"])


def _unit_by_size(dimension: str, values: Sequence[Any]) -> str | None:
    """The unit that numbers of this size usually have: no arm reaches 10 m, nor turns by 7 rad."""
    numbers = [abs(one) for one in values if isinstance(one, int | float) and not isinstance(one, bool)]
    largest = max(numbers, default=0.0)
    if dimension == "length":
        return "mm" if largest > 10 else None
    if dimension == "angle":
        is_whole = all(float(number).is_integer() for number in numbers)
        return "rad" if 0 < largest <= 6.5 and not is_whole else None
    return "ms" if largest > 60 else None


def _opening(stem: str, unit: str | None, setting: Setting) -> Guess:
    if setting.annotation == "bool":
        return Guess({"kind": "opening", "values": [False, True]})
    values = _distinct(setting.constants)
    if _are_numbers(values) and (len(values) > _MOST_VALUES or any(value < 0 for value in values)):
        return Guess(_ranged("output", values), ["range"])
    if len(values) >= 2:
        table: Table = {"kind": "opening", "values": values}
        if _are_numbers(values) and any(value > 1 for value in values):
            return Guess({**table, "unit": unit if unit in ("mm", "cm", "m") else "percent"}, ["unit"])
        return Guess(table)
    if unit is not None or stem == "width":
        return Guess(
            {"kind": "opening", "unit": unit or "m", "range": [0.0, _stroke(unit or "m")]}, ["range"]
        )
    if _are_numbers(values) and any(value > 1 for value in values):
        return Guess(
            _ranged("output", [0, 255, *values] if values[0] > 100 else [0, 100, *values]), ["range"]
        )
    return Guess({"kind": "opening", "range": [0.0, 1.0], "unit": "fraction"}, ["range"])


def _ranged(kind: str, values: Sequence[Any]) -> Table:
    return {"kind": kind, "range": [float(min(values)), float(max(values))]}


def _stroke(unit: str) -> float:
    return {"m": 0.1, "cm": 10.0, "mm": 100.0}.get(unit, 1.0)


def _is_switch(stem: str, setting: Setting) -> bool:
    return setting.annotation == "bool" and stem in _SWITCHES


def _switch(setting: Setting) -> Guess:
    values = _distinct(setting.constants)
    if setting.annotation == "bool" or len(values) < 2:
        return Guess(
            {"kind": "output", "values": [False, True]}, [] if setting.annotation == "bool" else ["values"]
        )
    return Guess({"kind": "output", "values": values})


def _label(setting: Setting) -> Guess:
    literal = re.fullmatch(r"Literal\[(.*)\]", setting.annotation)
    values = _distinct(re.findall(r"'([^']*)'", literal[1])) if literal else _distinct(setting.constants)
    if len(values) >= 2:
        return Guess({"kind": "label", "values": values}, [] if literal else ["values"])
    return Guess({"kind": "label"}, ["values"])


def split_unit(name: str) -> tuple[str, str | None]:
    stem, _, last = name.rpartition("_")
    if stem and last in _UNIT_WORDS:
        return stem, _UNIT_WORDS[last]
    return name, _UNIT_WORDS.get(name) if name in (
        "seconds",
        "milliseconds",
        "degrees",
        "radians",
        "deg",
    ) else None


def _distinct(values: Sequence[Any]) -> list[Any]:
    kinds = {type(value) for value in values}
    same = values if len(kinds) <= 1 or kinds == {int, float} else []
    return list(dict.fromkeys(same))


def _are_numbers(values: Sequence[Any]) -> bool:
    return all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)


_JOINTED = re.compile(r"(?:^|_)(?:movej|servoj|getj|joints?|jnts?|q|qpos|angles?|actual_q|target_q)(?:_|$)")
_POSES = re.compile(
    r"(?:^|_)(?:move[lpc]?|servo[lp]|getl|[ts]?pose[s]?|tcp|xyz|pos|position[s]?|target|goal|location|locate|where"
    r"|point|waypoint|translation|translate|offset|goto|coords?)(?:_|$)"
)
_TURNED = re.compile(r"(?:^|_)(?:orientation|rotation|rotvec|rpy|euler|orn)(?:_|$)")
_NO_PLACES = re.compile(r"speed|veloc|acc|force|torque|wrench|gain|weight|colou?r|rgb|limit|radius|size|vel")
_ACTIONS = frozenset({"action", "actions", "act", "a", "u"})
_MOST_JOINTS = 12
_AXES_OF = {2: "xy", 3: "xyz"}


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
        if _JOINTED.search(about) and length <= _MOST_JOINTS:
            return _joints(length, setting, written)
        if _TURNED.search(about) and length == 3:
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
    axis, flat = _AXES_OF[place], _flat(setting, slice(0, place))
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
