"""Read quantities from the tables of a vocabulary, and check the rules of each kind."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

from mutabot.config.mistakes import DocumentPlace, shown
from mutabot.errors import nearest_name
from mutabot.model import Kind, Mode, Path, Quantity
from mutabot.model.path import Step
from mutabot.model.quantity import DIMENSIONS, HEADER, MEASURED, READ, WHOLE, WRITTEN, is_number, measures_of
from mutabot.model.units import OF_ANY, QUATERNION_ORDERS, UNITS, dimension_of, is_euler_order, units_of

from .schema import CALLABLE, QuantityTable, Sides, is_target

#: every axis a quantity may have
AXES = ("x", "y", "z", *(f"j{number}" for number in range(1, 13)))

_AXES_IN_SHORT = ("x", "y", "z", "j1 … j12")
_AXIS = re.compile(r"[xyz]|j(?:1[0-2]|[1-9])")
_JOINTS = re.compile(r"j(\d{1,2})(?:\.\.|-)j(\d{1,2})")


def _split_axes(text: str) -> tuple[str, ...] | None:
    """Return the axes in ``x``, ``xyz``, ``j1j2j3`` or ``j1..j7``; None if it is anything else."""
    joints = _JOINTS.fullmatch(text)
    if joints is not None:
        axes = tuple(f"j{number}" for number in range(int(joints[1]), int(joints[2]) + 1))
    else:
        axes = tuple(_AXIS.findall(text))
        if "".join(axes) != text:
            return None
    return axes if axes and set(axes) <= set(AXES) else None


def _slice_of(path: Path) -> Step | None:
    """Return the slice a path ends with, or None."""
    return path.steps[-1] if path.steps and path.steps[-1].bounds is not None else None


def _spread(path: Path, axes: tuple[str, ...]) -> list[Path]:
    """Return a path per axis, for a path that ends with a slice.

    Raises ValueError if it ends with none, or with one that does not have as many elements.
    """
    step = _slice_of(path)
    if step is None or step.bounds is None:
        raise ValueError(
            f"{''.join(axes)!r} names {len(axes)} axes, for which the path must end with a slice "
            f'such as "{path}[0:{len(axes)}]"'
        )
    start, stop, stride = step.bounds[0] or 0, step.bounds[1], step.bounds[2] or 1
    if stop is None:  # counted from the end, a sequence ends at 0
        stop = 0 if start < 0 else start + len(axes) * stride
    has_one_end = not (start >= 0 > stop or start < 0 < stop)
    indices = range(start, stop, stride)
    if stride < 1 or not has_one_end or len(indices) != len(axes):
        raise ValueError(
            f"the slice {step} must have an element for each of the {len(axes)} axes ({', '.join(axes)}), "
            "forwards, with start and stop counted from the same end of the sequence"
        )
    return [replace(path, steps=(*path.steps[:-1], Step(item=index))) for index in indices]


#: keys that a quantity has as its table has them
_ALIKE = ("kind", "frame", "mode", "noise", "order", "relative", "missing", "tcp")


def read_quantities(
    place: DocumentPlace, raw: dict[str, Any] | None, sides: Sides = CALLABLE, *, is_written: bool = False
) -> tuple[Quantity, ...]:
    """Read a table whose keys are paths to quantities; the result of a callable may be one quantity."""
    raw = raw or {}
    if not is_written and not sides.is_message and raw and is_quantity(raw):
        name = str(place.path[-1])
        return tuple(read_quantity(place, raw, Path(), sides, is_written=False, name=name))
    quantities: list[Quantity] = []
    for text, item, at in _leaves(raw, "", place):
        if not isinstance(item, dict):
            at.error(f"expected a table such as {{ kind = … }}, got {shown(item)}")
            continue
        path = at.attempt(_path_of, text, sides, is_written)
        if path is None:
            continue
        for quantity in read_quantity(at, item, path, sides, is_written=is_written):
            if any(quantity.name == other.name for other in quantities):
                at.error(f"{quantity.name} is described twice")
            quantities.append(quantity)
    if sides.is_message:
        root = sides.root if is_written else None
        quantities = [replace(quantity, path=in_message(quantity.path, root)) for quantity in quantities]
    return tuple(quantities)


def in_message(path: Path, root: str | None) -> Path:
    """Return the path to a field that is named by its bare path."""
    return Path(root, (Step(attribute=path.root), *path.steps))


def bare_path(text: str) -> Path:
    """Return a path to a field of a message, with that field as root. Raises ValueError for other texts."""
    try:
        return Path.parse(text.removeprefix("."), rooted=True)
    except ValueError as error:
        raise ValueError(str(error).replace("an argument's name", "the name of a field")) from None


def is_quantity(raw: dict[str, Any]) -> bool:
    """Return whether a table is a quantity, rather than a table of paths."""
    return isinstance(raw.get("kind"), str) or not all(isinstance(item, dict) for item in raw.values())


def read_quantity(
    place: DocumentPlace,
    raw: Any,
    path: Path,
    sides: Sides = CALLABLE,
    *,
    is_written: bool,
    name: str | None = None,
) -> Iterator[Quantity]:
    """Read the quantity of a table, or one per axis where a slice has several; mistakes are noted."""
    if sides.is_message and isinstance(raw, dict) and raw.get("kind") == Kind.QUATERNION:
        raw = {"order": "xyzw", **raw}  # messages name the parts of a quaternion, or have them in this order
    table = place.table(QuantityTable, raw)
    if table is None:
        return
    axes = _split_axes(table.axis) if table.axis is not None else None
    several = axes is not None and len(axes) > 1
    is_vector = _slice_of(path) is not None and not several
    if note_faults(place, table, sides, is_written=is_written, is_vector=is_vector):
        return
    if axes is None or not several:
        yield _quantity(table, path, table.axis, name)
        return
    parts = (place / "axis").attempt(_spread, path, axes)
    for axis, part in zip(axes, parts or (), strict=False):
        yield _quantity(table, part, axis, None)


def _leaves(
    raw: dict[str, Any], before: str, place: DocumentPlace
) -> Iterator[tuple[str, Any, DocumentPlace]]:
    """Yield path, table and place of each quantity; ``arguments.pose.x`` without quotes is nested in TOML."""
    for key, item in raw.items():
        text = f"{before}{key}" if not before or key.startswith((".", "[")) else f"{before}.{key}"
        if isinstance(item, dict) and item and not is_quantity(item):
            yield from _leaves(item, text, place / key)
        else:
            yield text, item, place / key


def _path_of(text: str, sides: Sides, is_written: bool) -> Path:
    """Return the path to a quantity. Raises ValueError, saying what would be right."""
    if not sides.is_message and not is_written and not text.startswith((".", "[")):
        dotted = f"[{text}]" if text.isdigit() else f".{text or 'x'}"
        raise ValueError(
            f'a path into the result begins with a dot or a bracket: write result."{dotted}", '
            "or result = { … } if the result itself is the value"
        )
    path = bare_path(text) if sides.is_message else Path.parse(text, rooted=is_written)
    if not sides.is_message and path.root == "self":
        raise ValueError(
            "self is the object that the call belongs to, not an argument: only what a call is given can be "
            "changed. Name an argument of the call; what lies in the object is set by some other call"
        )
    if any(step.bounds is not None for step in path.steps[:-1]):
        raise ValueError(f"path {str(path)!r}: a slice can only be the last step")
    return path


def _quantity(table: QuantityTable, path: Path, axis: str | None, name: str | None) -> Quantity:
    ladder = table.ladder
    facts = {key: getattr(table, key) for key in _ALIKE}
    for key in ("range", "clip"):
        limits = getattr(table, key)
        facts[key] = tuple(limits) if limits is not None else None
    values = tuple(table.values) if table.values is not None else None
    return Quantity(
        name=name or str(path),
        path=path,
        axis=axis,
        unit=_unit(table),
        values=(False, True) if values is None and table.kind is Kind.FLAG else values,
        ladder=tuple(ladder.steps) if ladder is not None else None,
        ladder_unit=ladder.unit if ladder is not None else None,
        **facts,
    )


_MOVED = frozenset({Kind.TRANSLATION, Kind.ROTATION})
_WITH_AXIS = MEASURED - {Kind.DURATION} - WHOLE
#: keys that kinds do not have, and what is said beside that
_LACKING: Sequence[tuple[Sequence[str], frozenset[Kind], str]] = (
    (("values", "range", "clip"), WHOLE, ": its numbers mean something only together"),
    (("values",), frozenset({Kind.STAMP}), ": it is any moment"),
    (("range",), frozenset({Kind.LABEL, Kind.FLAG}), ", but values"),
    (("range", "clip"), HEADER, ""),
    (("unit",), frozenset(Kind) - DIMENSIONS.keys(), ""),
    (("axis",), frozenset(Kind) - _WITH_AXIS, ""),
    (("mode",), frozenset(Kind) - _MOVED, "; only a translation or rotation has"),
    (("order",), frozenset(Kind) - {Kind.QUATERNION, Kind.EULER}, ""),
    (("noise",), frozenset(Kind) - (MEASURED & READ), "; only a measured reading has"),
)
#: a rule: the key, whether it is broken, and what is said then
_RowRule = tuple[str, object, str]


def note_faults(
    place: DocumentPlace, table: QuantityTable, sides: Sides, *, is_written: bool, is_vector: bool
) -> bool:
    """Note the rules that a quantity breaks, the first of each key; if its kind is wrong, only that.

    ``is_vector``: whether it is a slice that stays one quantity. Returns whether there are any.
    """
    noted: set[str] = set()
    rules = _of_kind(table, is_written, sides)
    if not any(is_broken for _, is_broken, _ in rules):
        for key, name, known in _unknown(table):
            noted.add(key)
            (place / key).unknown(key, name, known)
        rules = [
            (key, kind in kinds and getattr(table, key) is not None, f"{_a(kind)} has no {key}{beside}")
            for keys, kinds, beside in _LACKING
            for key in keys
            for kind in (table.kind,)
        ]
        rules += [*_of_meaning(table, is_written, is_vector), *_of_values(table, is_written, is_vector)]
        rules += [*_of_reading(table, is_written), *_of_ladder(table)]
    for key, is_broken, text in rules:
        if is_broken and key not in noted:
            noted.add(key)
            (place / key).error(text)
    return bool(noted)


def _of_kind(table: QuantityTable, is_written: bool, sides: Sides) -> list[_RowRule]:
    kind = table.kind
    written = "what is sent" if sides.written in (None, "fields") else sides.written
    read = "what is received" if sides.read in (None, "fields") else sides.read
    text = f"{_a(kind)} is sent to the robot, so it belongs to {written}, not to {read}"
    if is_written:
        text = f"{_a(kind)} is read from the robot, so it belongs to {read}, not to {written}"
    known = "settings are known from what is set up; no vocabulary describes them"
    is_wrong = kind not in (WRITTEN if is_written else READ)
    return [("kind", kind is Kind.SETTING, known), ("kind", is_wrong, text)]


def _unknown(table: QuantityTable) -> Iterator[tuple[str, str, Sequence[str]]]:
    """Yield names that do not exist: the key, the name, and those that do."""
    units, of_ladder = (
        units_of(DIMENSIONS.get(table.kind, ())),
        table.ladder.unit if table.ladder is not None else None,
    )
    if table.unit is not None and units and table.unit not in UNITS:
        yield "unit", table.unit, units
    if table.axis is not None and table.kind in _WITH_AXIS and _split_axes(table.axis) is None:
        yield "axis", table.axis, AXES if nearest_name(table.axis, AXES) else _AXES_IN_SHORT
    if of_ladder is not None and of_ladder not in UNITS:
        yield "ladder", of_ladder, _units_of_ladder(table)


def _of_meaning(table: QuantityTable, is_written: bool, is_vector: bool) -> list[_RowRule]:
    """Return the rules of unit, mode, axis and order."""
    a, kind, order, units, unit = (
        _a(table.kind),
        table.kind,
        table.order,
        units_of(DIMENSIONS.get(table.kind, ())),
        _unit(table),
    )
    is_named = kind is Kind.OPENING and any(isinstance(value, str | bool) for value in table.values or ())
    is_target = kind in _MOVED and table.mode is Mode.TO
    is_position = is_written and is_target and kind is Kind.TRANSLATION
    hidden = (
        'only a translation or rotation with mode = "to" can hide a relative move: the program computes '
        "its target from where the robot is"
    )
    several = "give the axes of the slice, or indices: each has a place of its own"
    in_front = 'only a target position (kind = "translation", mode = "to") has a tool in front of it'
    modes = f'{a} needs mode = "by" (relative) or "to" (absolute target)'
    scalar = f'{a} needs order = "wxyz" or "xyzw": the position of its real part w'
    angles = (
        f"{kind} angles need order = three axes in the order of the angles, "
        'such as "xyz" for axes that stay, or "ZYX" for axes that turn along'
    )
    return [
        ("unit", units and unit is None and not is_named, f"{a} needs a unit: {_listed(units)}"),
        (
            "unit",
            units and unit in UNITS and unit not in units,
            f"{unit!r} is not a unit for {a}; use {_listed(units)}",
        ),
        ("unit", unit in units and is_named, f"{a} with named values has no unit"),
        ("mode", kind in _MOVED and table.mode is None, modes),
        ("relative", table.relative and not is_target, hidden),
        ("relative", table.relative and is_vector, several),
        ("tcp", table.tcp is not None and not is_position, in_front),
        ("order", kind is Kind.QUATERNION and order not in QUATERNION_ORDERS, scalar),
        ("order", kind is Kind.EULER and not is_euler_order(order or ""), angles),
    ]


def _of_values(table: QuantityTable, is_written: bool, is_vector: bool) -> list[_RowRule]:
    """Return the rules of values, range and clip."""
    a, kind, values, limits, clip = _a(table.kind), table.kind, table.values or [], table.range, table.clip
    is_given, is_measured = table.values is not None, kind in MEASURED
    needs_values = kind in (Kind.OPENING, Kind.OUTPUT) and not (is_given or limits or clip)
    wrong = [value for value in values if not _fits(kind, value)]
    wanted = "numbers" if is_measured else "texts, numbers, true or false"
    twice = [value for position, value in enumerate(values) if value in values[:position]]
    least, most = limits or (-math.inf, math.inf)
    outside = [value for value in values if _is_number(value) and not least <= value <= most]
    indices = "a slice that stays one quantity cannot have values; give indices instead"
    two = f"a flag has two values, false first, not {len(values)}; use a label"
    rises = "must rise from the least to the greatest value, got"
    read = f"{a} is read, not sent: only what is sent can be limited by the robot"
    left = "values are all that can be sent, so nothing is left to limit"
    return [
        ("kind", is_vector and not is_measured, f"{a} is a single value; give an index instead of a slice"),
        ("values", is_vector and is_measured and is_given, indices),
        ("values", kind is Kind.LABEL and not is_given, "a label needs values: all that it can read"),
        ("values", needs_values, f"{a} needs values (all that can be sent), a range or a clip"),
        ("values", wrong, f"values must be {wanted}, not {shown(next(iter(wrong), None))}"),
        ("values", is_given and len(values) < 2, f"needs at least two different values, got {len(values)}"),
        ("values", twice, f"{next(iter(twice), None)!r} occurs twice"),
        ("values", kind is Kind.FLAG and is_given and len(values) != 2, two),
        ("values", outside, f"{next(iter(outside), None)} lies outside the range {limits}"),
        ("range", limits and not limits[0] < limits[1], f"{rises} {limits}"),
        ("clip", clip and not is_written, read),
        ("clip", clip and is_given, left),
        ("clip", clip and not clip[0] < clip[1], f"{rises} {clip}"),
    ]


def _of_reading(table: QuantityTable, is_written: bool) -> list[_RowRule]:
    missing = table.missing
    never = f"{_a(table.kind)} that is sent is never missing; only a reading is"
    ways = f'write "none", "nan" or an exception (module:Name), not {shown(missing)}'
    is_odd = missing is not None and missing not in ("none", "nan") and not is_target(missing)
    return [("missing", missing is not None and is_written, never), ("missing", is_odd, ways)]


def _unit(table: QuantityTable) -> str | None:
    """Return the unit, which may be left out for an opening between 0 and 1: that is a fraction."""
    if table.unit is None and table.kind is Kind.OPENING:
        numbers = [*(table.values or ()), *(table.range or table.clip or ())]
        if numbers and all(_is_number(number) and 0 <= number <= 1 for number in numbers):
            return "fraction"
    return "s" if table.kind is Kind.STAMP else table.unit


def _of_ladder(table: QuantityTable) -> list[_RowRule]:
    if table.ladder is None:
        return []
    a, steps, unit, units = _a(table.kind), table.ladder.steps, table.ladder.unit, _units_of_ladder(table)
    falls = any(later <= earlier for earlier, later in pairwise(steps))
    no_scale = f"{a} has no magnitudes; only what is a number on a scale has"
    positive = f"magnitudes are more than 0, not {min(steps):g}; both directions are tried"
    other = f"{unit!r} measures no fault of {a}; use {_listed(units)}"
    rises = (
        f"must rise from the smallest to the greatest magnitude, got {', '.join(map('{:g}'.format, steps))}"
    )
    return [
        ("ladder", table.kind not in MEASURED and table.range is None, no_scale),
        ("ladder", min(steps) <= 0, positive),
        ("ladder", falls, rises),
        ("ladder", unit in UNITS and unit not in units, other),
    ]


def _units_of_ladder(table: QuantityTable) -> tuple[str, ...]:
    """Return the units that faults in the quantity may have: its own measure, a time or a share."""
    if table.unit in UNITS:
        return units_of((dimension_of(table.unit), *OF_ANY))
    return units_of((*measures_of(table.kind), *OF_ANY))


def _fits(kind: Kind, value: Any) -> bool:
    if kind in MEASURED:
        return _is_number(value)
    return isinstance(value, str | bool) or _is_number(value)


def _is_number(value: Any) -> bool:
    return is_number(value) and abs(value) < math.inf


def _a(kind: Kind) -> str:
    return f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"


def _listed(names: tuple[str, ...]) -> str:
    return " or ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))
