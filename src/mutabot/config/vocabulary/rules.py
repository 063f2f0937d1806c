"""What a quantity must say, by its kind; and what a quantity of several axes is spread over."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from typing import Any

from mutabot.config.mistakes import shown
from mutabot.errors import nearest_name
from mutabot.model import Kind, Mode, Path
from mutabot.model.path import Step
from mutabot.model.quantity import DIMENSIONS, HEADER, MEASURED, READ, WHOLE, WRITTEN
from mutabot.model.units import QUATERNION_ORDERS, UNITS, Dimension, dimension_of, is_euler_order

from .schema import QuantityTable, is_target

#: every axis a quantity may have
AXES = ("x", "y", "z", *(f"j{number}" for number in range(1, 13)))

_AXIS = re.compile(r"[xyz]|j(?:1[0-2]|[1-9])")
_JOINTS = re.compile(r"j(\d{1,2})(?:\.\.|-)j(\d{1,2})")


def split_axes(text: str) -> tuple[str, ...] | None:
    """The axes in ``x``, ``xyz``, ``j1j2j3`` or ``j1..j7``; None if it is anything else."""
    joints = _JOINTS.fullmatch(text)
    if joints is not None:
        axes = tuple(f"j{number}" for number in range(int(joints[1]), int(joints[2]) + 1))
    else:
        axes = tuple(_AXIS.findall(text))
        if "".join(axes) != text:
            return None
    return axes if axes and set(axes) <= set(AXES) else None


def slice_of(path: Path) -> Step | None:
    """The slice a path ends with, or None."""
    return path.steps[-1] if path.steps and path.steps[-1].bounds is not None else None


def spread(path: Path, axes: tuple[str, ...]) -> list[Path]:
    """One path per axis, for a path that ends with a slice.

    Raises ValueError if it ends with none, or with one that does not have as many elements.
    """
    step = slice_of(path)
    if step is None or step.bounds is None:
        raise ValueError(
            f"{''.join(axes)!r} names {len(axes)} axes, for which the path must end with a slice "
            f'such as "{path}[0:{len(axes)}]"'
        )
    start, stop, stride = step.bounds[0] or 0, step.bounds[1], step.bounds[2] or 1
    if stride < 1:
        raise ValueError(f"the slice {step} must go forwards to be spread over several axes")
    if stop is None:  # counted from the end, a sequence ends at 0
        stop = 0 if start < 0 else start + len(axes) * stride
    if start >= 0 > stop or start < 0 < stop:
        raise ValueError(
            f"the slice {step} must start and stop at the same end of the sequence to be spread over axes"
        )
    indices = range(start, stop, stride)
    if len(indices) != len(axes):
        text = f"the slice {step} has {len(indices)} elements for {len(axes)} axes ({', '.join(axes)})"
        raise ValueError(text)
    return [replace(path, steps=(*path.steps[:-1], Step(item=index))) for index in indices]


_MOVED = (Kind.TRANSLATION, Kind.ROTATION)
_AXES_IN_SHORT = ("x", "y", "z", "j1 … j12")
_WITH_AXIS = MEASURED - {Kind.DURATION} - WHOLE
#: how a kind that stands on the wrong side would be written there
_AS_ARGUMENT = {
    Kind.POSITION: '; a commanded position is kind = "translation" with mode = "to"',
    Kind.ORIENTATION: '; a commanded orientation is kind = "rotation" with mode = "to"',
    Kind.ANGLE: '; a commanded joint angle is kind = "rotation" with mode = "to" and the joint as axis',
    Kind.LABEL: '; a commanded choice is kind = "output" with its values',
    Kind.FLAG: '; a commanded switch is kind = "output" with values = [false, true]',
}
_AS_RESULT = {
    Kind.TRANSLATION: '; where the robot is, is kind = "position"',
    Kind.ROTATION: '; how the robot is turned, is kind = "orientation" (or "angle" for a joint)',
    Kind.OPENING: '; how far the gripper is open, is kind = "distance", and whether it is, "flag"',
    Kind.OUTPUT: '; a state that is read back is kind = "flag" or "label"',
}


#: a broken rule: the key, and a sentence; or the name that does not exist, and those that do
Fault = tuple[str, str, tuple[str, ...] | None]
#: a rule: the key, whether it is broken, and what is said then
Rule = tuple[str, object, str]


def faults(
    table: QuantityTable, *, is_written: bool, is_vector: bool = False, words: tuple[str, str]
) -> Iterator[Fault]:
    """The rules a quantity breaks, the first of each key; none beside its kind if that is wrong here.

    ``is_vector`` tells whether it is a slice that stays one quantity; ``words`` are what messages call what
    is written, and what is read.
    """
    rules = [*_of_kind(table, is_written, words)]
    if not any(is_broken for _, is_broken, _ in rules):
        rules = [*_of_unit(table), *_of_motion(table, is_written, is_vector), *_of_values(table, is_vector)]
        rules += [*_of_limits(table, is_written), *_of_reading(table, is_written), *_of_orientation(table)]
        rules += _of_ladder(table)
        yield from _unknown(table)
    told: set[str] = set()
    for key, is_broken, text in rules:
        if is_broken and key not in told:
            told.add(key)
            yield key, text, None


def default_unit(table: QuantityTable) -> str | None:
    """The unit, where it goes without saying: an opening between 0 and 1 is a fraction."""
    if table.unit is None and table.kind is Kind.OPENING:
        numbers = [*(table.values or ()), *(table.range or table.clip or ())]
        if numbers and all(_is_number(number) and 0 <= number <= 1 for number in numbers):
            return "fraction"
    return "s" if table.kind is Kind.STAMP else table.unit


def default_values(table: QuantityTable) -> tuple[Any, ...] | None:
    """The values, where they go without saying: a flag is false or true."""
    if table.values is None:
        return (False, True) if table.kind is Kind.FLAG else None
    return tuple(table.values)


def _of_kind(table: QuantityTable, is_written: bool, words: tuple[str, str]) -> list[Rule]:
    kind, (written, read) = table.kind, words
    on_wrong_side = kind not in (WRITTEN if is_written else READ)
    if is_written:
        text = f"{_a(kind)} is read from the robot, so it belongs to {read}, not to {written}"
    else:
        text = f"{_a(kind)} is sent to the robot, so it belongs to {written}, not to {read}"
    instead = (_AS_ARGUMENT if is_written else _AS_RESULT).get(kind, "")
    known = "settings are known from what is set up; no vocabulary describes them"
    return [("kind", kind is Kind.SETTING, known), ("kind", on_wrong_side, text + instead)]


def _unknown(table: QuantityTable) -> Iterator[Fault]:
    """Names that do not exist."""
    units, (_, of_ladder) = _units(table), steps_of(table)
    if table.unit is not None and units and table.unit not in UNITS:
        yield "unit", table.unit, units
    if table.axis is not None and table.kind in _WITH_AXIS and split_axes(table.axis) is None:
        yield "axis", table.axis, AXES if nearest_name(table.axis, AXES) else _AXES_IN_SHORT
    if isinstance(of_ladder, str) and of_ladder not in UNITS:
        yield "ladder", of_ladder, _units_of_ladder(table)


def _of_unit(table: QuantityTable) -> list[Rule]:
    a, units, is_named = _a(table.kind), _units(table), _has_named_values(table)
    unit = table.unit if table.kind is Kind.STAMP else default_unit(table)
    is_other = unit in UNITS and unit not in units
    return [
        ("unit", unit is not None and not units, f"{a} has no unit"),
        ("unit", units and unit is None and not is_named, f"{a} needs a unit: {_listed(units)}"),
        ("unit", is_other, f"{unit!r} is no unit for {a}; use {_listed(units)}"),
        ("unit", unit in units and is_named, f"{a} with named values has no unit"),
    ]


def _of_motion(table: QuantityTable, is_written: bool, is_vector: bool) -> list[Rule]:
    a, kind, mode = _a(table.kind), table.kind, table.mode
    is_motion, is_target = kind in _MOVED, kind in _MOVED and mode is Mode.TO
    is_position = is_written and kind is Kind.TRANSLATION and mode is Mode.TO
    hidden = (
        'only a translation or rotation with mode = "to" can hide a relative move: the program computes '
        "its target from where the robot is"
    )
    several = "give the axes of the slice, or indices: each has a place of its own"
    in_front = 'only a target position (kind = "translation", mode = "to") has a tool in front of it'
    no_mode = f"{a} has no mode; only a translation or rotation has"
    return [
        ("mode", is_motion and mode is None, f'{a} needs mode = "by" (relative) or "to" (absolute target)'),
        ("mode", not is_motion and mode is not None, no_mode),
        ("relative", table.relative and not is_target, hidden),
        ("relative", table.relative and is_vector, several),
        ("axis", table.axis is not None and kind not in _WITH_AXIS, f"{a} has no axis"),
        ("tcp", table.tcp is not None and not is_position, in_front),
    ]


def _of_values(table: QuantityTable, is_vector: bool) -> list[Rule]:
    a, kind, values = _a(table.kind), table.kind, table.values or []
    is_given, is_measured = table.values is not None, kind in MEASURED
    has_no_limits = table.range is None and table.clip is None
    needs_values = kind in (Kind.OPENING, Kind.OUTPUT) and has_no_limits and not is_given
    wrong = [value for value in values if not _fits(kind, value)]
    wanted = "numbers" if is_measured else "texts, numbers, true or false"
    twice = [value for position, value in enumerate(values) if value in values[:position]]
    least, most = table.range or (-math.inf, math.inf)
    outside = [value for value in values if _is_number(value) and not least <= value <= most]
    single = f"{_a(kind)} is a single value; give an index instead of a slice"
    indices = "a slice that stays one quantity cannot have values; give indices instead"
    two = f"a flag has two values, false first, not {len(values)}; use a label"
    return [
        ("kind", is_vector and not is_measured, single),
        ("values", is_vector and is_measured and is_given, indices),
        ("values", kind is Kind.LABEL and not is_given, "a label needs values: all that it can read"),
        ("values", needs_values, f"{a} needs values (all that can be sent), a range or a clip"),
        ("values", kind is Kind.STAMP and is_given, "a stamp is any moment, so it has no values"),
        ("values", wrong, f"values must be {wanted}, not {shown(next(iter(wrong), None))}"),
        ("values", is_given and len(values) < 2, f"needs at least two different values, got {len(values)}"),
        ("values", twice, f"{next(iter(twice), None)!r} stands there twice"),
        ("values", kind is Kind.FLAG and is_given and len(values) != 2, two),
        ("values", outside, f"{next(iter(outside), None)} lies outside the range {table.range}"),
    ]


def _of_limits(table: QuantityTable, is_written: bool) -> list[Rule]:
    a, kind, limits, clip = _a(table.kind), table.kind, table.range, table.clip
    read = f"{a} is read, not sent: only what is sent can be limited by the robot"
    values = "values are all that can be sent, so nothing is left to limit"
    rises = "must rise from the least to the greatest value, got"
    return [
        ("range", limits and kind in (Kind.LABEL, Kind.FLAG), f"{a} has no range, but values"),
        ("range", limits and kind in HEADER, f"{a} has no range"),
        ("range", limits and not limits[0] < limits[1], f"{rises} {limits}"),
        ("clip", clip and kind in HEADER, f"{a} is limited to nothing"),
        ("clip", clip and not is_written, read),
        ("clip", clip and table.values is not None, values),
        ("clip", clip and not clip[0] < clip[1], f"{rises} {clip}"),
    ]


def _of_reading(table: QuantityTable, is_written: bool) -> list[Rule]:
    a, missing, kind = _a(table.kind), table.missing, table.kind
    never = f"{a} that is sent is never missing; only a reading is"
    ways = f'write "none", "nan" or an exception (module:Name), not {shown(missing)}'
    is_odd = missing is not None and missing not in ("none", "nan") and not is_target(missing)
    rules: list[Rule] = [("missing", missing is not None and is_written, never), ("missing", is_odd, ways)]
    is_reading, noise = kind in MEASURED & READ, table.noise
    positive = f"must be more than 0 (a standard deviation), got {noise}"
    only = f"{a} has no noise; only a measured reading has"
    rules.append(("noise", noise is not None and not is_reading, only))
    rules.append(("noise", noise is not None and noise <= 0, positive))
    return rules


def _of_orientation(table: QuantityTable) -> list[Rule]:
    """Orientations as a whole are several numbers, of which none has limits of its own."""
    a, kind, order = _a(table.kind), table.kind, table.order
    together = "its numbers mean something only together"
    keys = ("values", "range", "clip") if kind in WHOLE else ()
    scalar = f'{a} needs order = "wxyz" or "xyzw": where its real part w stands'
    angles = (
        f"{kind} angles need order = three axes in the order of the angles, "
        'such as "xyz" for axes that stay, or "ZYX" for axes that turn along'
    )
    has_none = order is not None and kind not in (Kind.QUATERNION, Kind.EULER)
    return [
        *((key, getattr(table, key) is not None, f"{a} has no {key}: {together}") for key in keys),
        ("order", kind is Kind.QUATERNION and order not in QUATERNION_ORDERS, scalar),
        ("order", kind is Kind.EULER and not is_euler_order(order or ""), angles),
        ("order", has_none, f"{a} has no order"),
    ]


def steps_of(table: QuantityTable) -> tuple[list[float] | None, str | None]:
    """The magnitudes of its ladder and their unit, if it has one of its own."""
    ladder = table.ladder
    return (ladder.get("steps"), ladder.get("unit")) if isinstance(ladder, dict) else (ladder, None)


def _of_ladder(table: QuantityTable) -> list[Rule]:
    if table.ladder is None:
        return []
    a, (steps, unit), units = _a(table.kind), steps_of(table), _units_of_ladder(table)
    is_table = isinstance(table.ladder, dict)
    is_odd_table = is_table and (table.ladder.keys() != {"steps", "unit"} or not isinstance(unit, str))
    form = f'write {{ steps = [1, 2, 5], unit = "mm" }}, not {_written(table.ladder)}'
    if is_odd_table:
        return [("ladder", True, form)]
    is_list = isinstance(steps, list) and len(steps) > 1 and all(map(_is_number, steps))
    if not is_list or steps is None:
        text = f"takes at least two magnitudes, such as [1, 2, 5], not {_written(steps)}"
        return [("ladder", True, text)]
    falls = any(later <= earlier for earlier, later in pairwise(steps))
    no_scale = f"{a} has no magnitudes; only what is a number on a scale has"
    positive = f"magnitudes are more than 0, not {min(steps):g}; both directions are tried"
    other = f"{unit!r} measures no fault of {a}; use {_listed(units)}"
    return [
        ("ladder", table.kind not in MEASURED and table.range is None, no_scale),
        ("ladder", min(steps) <= 0, positive),
        ("ladder", falls, f"must rise from the smallest to the greatest magnitude, got {_written(steps)}"),
        ("ladder", unit in UNITS and unit not in units, other),
    ]


def _units(table: QuantityTable) -> tuple[str, ...]:
    """The units of its values."""
    dimensions = DIMENSIONS.get(table.kind, frozenset())
    return tuple(name for name in UNITS if dimension_of(name) in dimensions)


def _units_of_ladder(table: QuantityTable) -> tuple[str, ...]:
    """The units of faults in it: its own measure, a time or a share."""
    own = DIMENSIONS.get(table.kind, frozenset())
    if table.unit in UNITS:
        own = frozenset({dimension_of(table.unit)})
    elif table.kind in WHOLE:
        own = frozenset({Dimension.ANGLE})
    return tuple(name for name in UNITS if dimension_of(name) in (*own, Dimension.TIME, Dimension.RATIO))


def _written(value: Any) -> str:
    """A value as it stands in the file, where that is short."""
    return str(value) if len(str(value)) < 60 else shown(value)


def _fits(kind: Kind, value: Any) -> bool:
    if kind in MEASURED:
        return _is_number(value)
    return isinstance(value, str | bool) or _is_number(value)


def _is_number(value: Any) -> bool:
    finite = isinstance(value, int | float) and abs(value) < float("inf")
    return finite and not isinstance(value, bool)


def _has_named_values(table: QuantityTable) -> bool:
    return table.kind is Kind.OPENING and any(isinstance(value, str | bool) for value in table.values or ())


def _a(kind: Kind) -> str:
    return f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"


def _listed(names: tuple[str, ...]) -> str:
    return " or ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))
