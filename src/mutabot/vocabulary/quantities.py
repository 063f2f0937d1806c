"""Tables of a vocabulary turned into quantities."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from mutabot.model import Kind, Path, Quantity
from mutabot.model.path import Step
from mutabot.settings.mistakes import Check, shown
from mutabot.settings.toml_lines import KeyPath

from .cases.when import ModeChoice, Undecided, read_mode_choice
from .rules import SIDES, default_unit, default_values, faults, slice_of, split_axes, spread, steps_of
from .schema import QuantityTable


def read_arguments(check: Check, raw: dict[str, Any], place: KeyPath) -> tuple[Quantity, ...]:
    """The quantities of an ``arguments`` table, whose keys are paths that start with an argument's name."""
    return _read_paths(check, raw, place, written=True)


def read_result(check: Check, raw: dict[str, Any] | None, place: KeyPath) -> tuple[Quantity, ...]:
    """The quantities of a ``result``: a quantity, or a table whose keys are paths into the result."""
    if raw is None:
        return ()
    if is_quantity(raw):
        return tuple(read_quantity(check, raw, place, Path(), written=False, name="result"))
    return _read_paths(check, raw, place, written=False)


def read_fields(
    check: Check, raw: dict[str, Any] | None, place: KeyPath, root: str | None, sides: tuple[str, str]
) -> tuple[Quantity, ...]:
    """The quantities of a message's fields, whose keys are bare paths such as ``pose.position.x``.

    ``root`` is the argument that holds a message that is written; None for one that is read. ``sides`` are
    where quantities stand that are written, and those that are read.
    """
    found = _read_paths(check, raw or {}, place, written=root is not None, sides=sides)
    return tuple(replace(quantity, path=in_message(quantity.path, root)) for quantity in found)


def in_message(path: Path, root: str | None) -> Path:
    """The path to a field that is named by its bare path."""
    return Path(root, (Step(attribute=path.root), *path.steps))


def is_quantity(raw: dict[str, Any]) -> bool:
    """Whether a table is a quantity, rather than a table of paths."""
    return isinstance(raw.get("kind"), str) or not all(isinstance(item, dict) for item in raw.values())


def read_quantity(
    check: Check,
    raw: Any,
    place: KeyPath,
    path: Path,
    *,
    written: bool,
    name: str | None = None,
    sides: tuple[str, str] = SIDES,
) -> Iterator[Quantity]:
    """The quantity of a table, or one per axis where a slice has several; mistakes are noted."""
    if sides is not SIDES and isinstance(raw, dict) and raw.get("kind") == Kind.QUATERNION:
        raw = {"order": "xyzw", **raw}  # messages name the parts of a quaternion, or have them in this order
    raw, choice = read_mode_choice(check, raw, place)
    table = check.table(QuantityTable, raw, place)
    if table is None:
        return
    axes = split_axes(table.axis) if table.axis is not None else None
    several = axes is not None and len(axes) > 1
    vector = slice_of(path) is not None and not several
    found = list(faults(table, written=written, vector=vector, sides=sides))
    for fault in found:
        where = (*place, fault.key)
        if fault.known is None:
            check.error(where, fault.text)
        else:
            check.unknown(where, fault.key, fault.text, fault.known)
    if found:
        return
    if axes is None or not several:
        yield _undecided(_quantity(table, path, table.axis, name), choice)
        return
    try:
        for axis, part in zip(axes, _spread(path, axes), strict=True):
            yield _undecided(_quantity(table, part, axis, None), choice)
    except ValueError as error:
        check.error((*place, "axis"), str(error))


def _read_paths(
    check: Check, raw: dict[str, Any], place: KeyPath, *, written: bool, sides: tuple[str, str] = SIDES
) -> tuple[Quantity, ...]:
    quantities: list[Quantity] = []
    for text, item, where in _leaves(raw, "", place):
        if not isinstance(item, dict):
            check.error(where, f"expected a table such as {{ kind = … }}, got {shown(item)}")
            continue
        path = _path(check, text, where, written) if sides is SIDES else _field(check, text, where)
        if path is None:
            continue
        for quantity in read_quantity(check, item, where, path, written=written, sides=sides):
            if any(quantity.name == other.name for other in quantities):
                check.error(where, f"{quantity.name} is described twice")
            quantities.append(quantity)
    return tuple(quantities)


def _leaves(raw: dict[str, Any], before: str, place: KeyPath) -> Iterator[tuple[str, Any, KeyPath]]:
    """Path, table and place of each quantity; ``arguments.pose.x`` without quotes is nested in TOML."""
    for key, item in raw.items():
        text = f"{before}{key}" if not before or key.startswith((".", "[")) else f"{before}.{key}"
        if isinstance(item, dict) and item and not is_quantity(item):
            yield from _leaves(item, text, (*place, key))
        else:
            yield text, item, (*place, key)


def _path(check: Check, text: str, place: KeyPath, written: bool) -> Path | None:
    if not written and not text.startswith((".", "[")):
        check.error(
            place, f"a path into the result begins with a dot or a bracket: write result.{_dotted(text)}"
        )
        return None
    try:
        path = Path.parse(text, rooted=written)
    except ValueError as error:
        check.error(place, str(error))
        return None
    if written and path.root == "self":
        check.error(
            place,
            "self is the object that the call belongs to, not an argument: only what a call is given can be "
            "changed. Name an argument of the call; what lies in the object is set by some other call",
        )
        return None
    return _with_slice_at_end(check, path, place)


def _field(check: Check, text: str, place: KeyPath) -> Path | None:
    """The bare path to a field of a message, whose root is the message's own field."""
    try:
        path = Path.parse(text.removeprefix("."), rooted=True)
    except ValueError as error:
        check.error(place, str(error).replace("an argument's name", "the name of a field"))
        return None
    return _with_slice_at_end(check, path, place)


def _with_slice_at_end(check: Check, path: Path, place: KeyPath) -> Path | None:
    if any(step.bounds is not None for step in path.steps[:-1]):
        check.error(place, f"path {str(path)!r}: a slice can only be the last step")
        return None
    return path


def _dotted(text: str) -> str:
    return f'"[{text}]"' if text.isdigit() else f'".{text}"'


def _spread(path: Path, axes: Sequence[str]) -> list[Path]:
    if slice_of(path) is None:
        raise ValueError(
            f"{''.join(axes)!r} names {len(axes)} axes, for which the path must end with a slice "
            f'such as "{path}[0:{len(axes)}]"'
        )
    return spread(path, tuple(axes))


def _undecided(quantity: Quantity, choice: ModeChoice | None) -> Quantity:
    return quantity if choice is None else Undecided.of(quantity, choice)


def _quantity(table: QuantityTable, path: Path, axis: str | None, name: str | None) -> Quantity:
    steps, unit = steps_of(table)
    return Quantity(
        name=name or str(path),
        path=path,
        kind=table.kind,
        axis=axis,
        unit=default_unit(table),
        frame=table.frame,
        mode=table.mode,
        values=default_values(table),
        range=(table.range[0], table.range[1]) if table.range is not None else None,
        noise=table.noise,
        order=table.order,
        relative=table.relative,
        clip=(table.clip[0], table.clip[1]) if table.clip is not None else None,
        ladder=tuple(map(float, steps)) if steps is not None else None,
        ladder_unit=unit,
        repeatability=table.repeatability,
        missing=table.missing,
        tcp=table.tcp,
    )
