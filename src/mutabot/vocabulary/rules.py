"""What a quantity must say, by its kind; and what a quantity of several axes is spread over."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from mutabot.errors import nearest_name
from mutabot.model import Kind, Mode, Path
from mutabot.model.path import Step
from mutabot.model.quantity import DIMENSIONS, HEADER, MEASURED, READ, WHOLE, WRITTEN
from mutabot.model.units import QUATERNION_ORDERS, UNITS, Dimension, dimension_of, is_euler_order
from mutabot.settings.mistakes import shown

from .schema import QuantityTable, target_fault

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

    Raises ValueError if the slice does not have as many elements as there are axes.
    """
    step = path.steps[-1]
    assert step.bounds is not None
    return [
        replace(path, steps=(*path.steps[:-1], Step(item=index)))
        for index in _indices(step.bounds, len(axes), f"{step}", axes)
    ]


def _indices(
    bounds: tuple[int | None, int | None, int | None], count: int, text: str, axes: tuple[str, ...]
) -> range:
    start, stop, stride = bounds[0] or 0, bounds[1], bounds[2] or 1
    if stride < 1:
        raise ValueError(f"the slice {text} must go forwards to be spread over several axes")
    if stop is None and start < 0:
        stop = 0  # counted from the end, this is where the sequence ends
    if stop is None:
        return range(start, start + count * stride, stride)
    if start >= 0 > stop or (start < 0 < stop):
        raise ValueError(
            f"the slice {text} must start and stop at the same end of the sequence to be spread over axes"
        )
    found = max(0, -((start - stop) // stride))
    if found != count:
        raise ValueError(f"the slice {text} has {found} elements for {count} axes ({', '.join(axes)})")
    return range(start, stop, stride)


_MOVED = (Kind.TRANSLATION, Kind.ROTATION)
_AXES_IN_SHORT = ("x", "y", "z", "j1 … j12")
_WITH_AXIS = MEASURED - {Kind.DURATION} - WHOLE
#: where the quantities of a callable stand: those that are written, and those that are read
SIDES = ("arguments", "result")
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


@dataclass(frozen=True)
class Fault:
    """A broken rule: the key, and a sentence; or the name that does not exist and those that do."""

    key: str
    text: str
    known: tuple[str, ...] | None = None


def faults(
    table: QuantityTable, *, written: bool, vector: bool = False, sides: tuple[str, str] = SIDES
) -> Iterator[Fault]:
    """The rules a quantity breaks.

    ``written`` tells whether it is an argument; ``vector``, whether it is a slice that stays one quantity;
    ``sides``, where quantities stand that are written, and those that are read.
    """
    side = list(_side(table, written, sides))
    if side:
        yield from side
        return
    yield from _unit(table)
    yield from _mode(table)
    yield from _relative(table, vector)
    yield from _axis(table)
    yield from _vector(table, vector)
    yield from _values(table)
    yield from _range(table)
    yield from _clip(table, written)
    yield from _noise(table)
    yield from _whole(table)
    yield from _ladder(table)
    yield from _missing(table, written)
    yield from _tcp(table, written)


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


def _side(table: QuantityTable, written: bool, sides: tuple[str, str]) -> Iterator[Fault]:
    kind, (of_written, of_read) = table.kind, sides
    if kind is Kind.SETTING:
        yield Fault("kind", "settings are known from what is set up; no vocabulary describes them")
    elif written and kind not in WRITTEN:
        yield Fault(
            "kind",
            f"a {kind} is read from the robot, so it belongs to {of_read}, not to {of_written}"
            f"{_AS_ARGUMENT.get(kind, '')}",
        )
    elif not written and kind not in READ:
        yield Fault(
            "kind",
            f"{_a(kind)} is sent to the robot, so it belongs to {of_written}, not to {of_read}"
            f"{_AS_RESULT.get(kind, '')}",
        )


def _unit(table: QuantityTable) -> Iterator[Fault]:
    kind, unit = table.kind, table.unit if table.kind is Kind.STAMP else default_unit(table)
    dimensions = DIMENSIONS.get(kind, frozenset())
    fitting = tuple(name for name in UNITS if dimension_of(name) in dimensions)
    if not fitting:
        if unit is not None:
            yield Fault("unit", f"{_a(kind)} has no unit")
    elif unit is None:
        if not _has_named_values(table):
            yield Fault("unit", f"{_a(kind)} needs a unit: {_listed(fitting)}")
    elif unit not in UNITS:
        yield Fault("unit", unit, fitting)
    elif unit not in fitting:
        yield Fault("unit", f"{unit!r} is no unit for {_a(kind)}; use {_listed(fitting)}")
    elif _has_named_values(table):
        yield Fault("unit", f"{_a(kind)} with named values has no unit")


def _mode(table: QuantityTable) -> Iterator[Fault]:
    if table.kind in _MOVED and table.mode is None:
        yield Fault("mode", f'{_a(table.kind)} needs mode = "by" (relative) or "to" (absolute target)')
    if table.kind not in _MOVED and table.mode is not None:
        yield Fault("mode", f"{_a(table.kind)} has no mode; only a translation or rotation has")


def _relative(table: QuantityTable, vector: bool) -> Iterator[Fault]:
    if not table.relative:
        return
    if table.kind not in _MOVED or table.mode is not Mode.TO:
        yield Fault(
            "relative",
            'only a translation or rotation with mode = "to" can hide a relative move: the program computes '
            "its target from where the robot is",
        )
    elif vector:
        yield Fault("relative", "give the axes of the slice, or indices: each has a place of its own")


def _axis(table: QuantityTable) -> Iterator[Fault]:
    if table.axis is None:
        return
    if table.kind not in _WITH_AXIS:
        yield Fault("axis", f"{_a(table.kind)} has no axis")
    elif split_axes(table.axis) is None:
        yield Fault("axis", table.axis, AXES if nearest_name(table.axis, AXES) else _AXES_IN_SHORT)


def _vector(table: QuantityTable, vector: bool) -> Iterator[Fault]:
    if not vector:
        return
    if table.kind not in MEASURED:
        yield Fault("kind", f"{_a(table.kind)} is a single value; give an index instead of a slice")
    elif table.values is not None:
        yield Fault("values", "a slice that stays one quantity cannot have values; give indices instead")


def _values(table: QuantityTable) -> Iterator[Fault]:
    kind, values = table.kind, table.values
    if values is None:
        if kind is Kind.LABEL:
            yield Fault("values", "a label needs values: all that it can read")
        if kind in (Kind.OPENING, Kind.OUTPUT) and table.range is None and table.clip is None:
            yield Fault("values", f"{_a(kind)} needs values (all that can be sent), a range or a clip")
        return
    wrong = [value for value in values if not _fits(kind, value)]
    if kind is Kind.STAMP:
        yield Fault("values", "a stamp is any moment, so it has no values")
    elif wrong:
        wanted = "numbers" if kind in MEASURED else "texts, numbers, true or false"
        yield Fault("values", f"values must be {wanted}, not {shown(wrong[0])}")
    elif len(values) < 2:
        yield Fault("values", f"needs at least two different values, got {len(values)}")
    elif len(set(values)) < len(values):
        twice = next(value for position, value in enumerate(values) if value in values[:position])
        yield Fault("values", f"{twice!r} stands there twice")
    elif kind is Kind.FLAG and len(values) != 2:
        yield Fault("values", f"a flag has two values, false first, not {len(values)}; use a label")


def _range(table: QuantityTable) -> Iterator[Fault]:
    if table.range is None:
        return
    least, most = table.range
    if table.kind in (Kind.LABEL, Kind.FLAG):
        yield Fault("range", f"a {table.kind} has no range, but values")
    elif table.kind in HEADER:
        yield Fault("range", f"a {table.kind} has no range")
    elif not least < most:
        yield Fault("range", f"must rise from the least to the greatest value, got [{least}, {most}]")
    else:
        outside = [v for v in table.values or () if _is_number(v) and not least <= v <= most]
        if outside:
            yield Fault("values", f"{outside[0]} lies outside the range [{least}, {most}]")


def _clip(table: QuantityTable, written: bool) -> Iterator[Fault]:
    if table.clip is None:
        return
    least, most = table.clip
    if table.kind in HEADER:
        yield Fault("clip", f"a {table.kind} is limited to nothing")
    elif not written:
        yield Fault(
            "clip", f"{_a(table.kind)} is read, not sent: only what is sent can be limited by the robot"
        )
    elif table.values is not None:
        yield Fault("clip", "values are all that can be sent, so nothing is left to limit")
    elif not least < most:
        yield Fault("clip", f"must rise from the least to the greatest value, got [{least}, {most}]")


def _noise(table: QuantityTable) -> Iterator[Fault]:
    for key in ("noise", "repeatability"):
        deviation = getattr(table, key)
        if deviation is None:
            continue
        if table.kind not in MEASURED & READ:
            yield Fault(key, f"{_a(table.kind)} has no {key}; only a measured reading has")
        elif deviation <= 0:
            yield Fault(key, f"must be more than 0 (a standard deviation), got {deviation}")


def _whole(table: QuantityTable) -> Iterator[Fault]:
    """Orientations as a whole: several numbers, of which none has limits of its own."""
    kind, order = table.kind, table.order
    if kind in WHOLE:
        for key in ("values", "range", "clip"):
            if getattr(table, key) is not None:
                yield Fault(key, f"{_a(kind)} has no {key}: its numbers mean something only together")
    if kind is Kind.QUATERNION and order not in QUATERNION_ORDERS:
        yield Fault("order", f'{_a(kind)} needs order = "wxyz" or "xyzw": where its real part w stands')
    elif kind is Kind.EULER and not is_euler_order(order or ""):
        example = 'such as "xyz" for axes that stay, or "ZYX" for axes that turn along'
        yield Fault("order", f"{kind} angles need order = three axes in the order of the angles, {example}")
    elif order is not None and kind not in (Kind.QUATERNION, Kind.EULER):
        yield Fault("order", f"{_a(kind)} has no order")


def steps_of(table: QuantityTable) -> tuple[list[float] | None, str | None]:
    """The magnitudes of its ladder and their unit, if it has one of its own."""
    ladder = table.ladder
    return (ladder.get("steps"), ladder.get("unit")) if isinstance(ladder, dict) else (ladder, None)


def _ladder(table: QuantityTable) -> Iterator[Fault]:
    if table.ladder is None:
        return
    steps, unit = steps_of(table)
    is_table = isinstance(table.ladder, dict)
    if is_table and (table.ladder.keys() != {"steps", "unit"} or not isinstance(unit, str)):
        yield Fault("ladder", f'write {{ steps = [1, 2, 5], unit = "mm" }}, not {_written(table.ladder)}')
    elif not isinstance(steps, list) or len(steps) < 2 or not all(map(_is_number, steps)):
        yield Fault("ladder", f"takes at least two magnitudes, such as [1, 2, 5], not {_written(steps)}")
    elif table.kind not in MEASURED and table.range is None:
        yield Fault("ladder", f"{_a(table.kind)} has no magnitudes; only what is a number on a scale has")
    elif min(steps) <= 0:
        yield Fault("ladder", f"magnitudes are more than 0, not {min(steps):g}; both directions are tried")
    elif any(later <= earlier for earlier, later in pairwise(steps)):
        yield Fault("ladder", f"must rise from the smallest to the greatest magnitude, got {_written(steps)}")
    elif unit is not None:
        yield from _ladder_unit(table, unit)


def _ladder_unit(table: QuantityTable, unit: str) -> Iterator[Fault]:
    own = DIMENSIONS.get(table.kind, frozenset())
    if table.unit in UNITS:
        own = frozenset({dimension_of(table.unit)})
    elif table.kind in WHOLE:
        own = frozenset({Dimension.ANGLE})
    fitting = tuple(name for name in UNITS if dimension_of(name) in (*own, Dimension.TIME, Dimension.RATIO))
    if unit not in UNITS:
        yield Fault("ladder", unit, fitting)
    elif unit not in fitting:
        yield Fault("ladder", f"{unit!r} measures no fault of {_a(table.kind)}; use {_listed(fitting)}")


def _written(value: Any) -> str:
    """A value as it stands in the file, where that is short."""
    return str(value) if len(str(value)) < 60 else shown(value)


def _missing(table: QuantityTable, written: bool) -> Iterator[Fault]:
    if table.missing is None:
        return
    if written:
        yield Fault("missing", f"{_a(table.kind)} that is sent is never missing; only a reading is")
    elif table.missing not in ("none", "nan") and target_fault(table.missing) is not None:
        yield Fault(
            "missing", f'write "none", "nan" or an exception (module:Name), not {shown(table.missing)}'
        )


def _tcp(table: QuantityTable, written: bool) -> Iterator[Fault]:
    if table.tcp is not None and not (written and table.kind is Kind.TRANSLATION and table.mode is Mode.TO):
        yield Fault(
            "tcp", 'only a target position (kind = "translation", mode = "to") has a tool in front of it'
        )


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
    return " or ".join(filter(None, (", ".join(names[:-1]), names[-1])))
