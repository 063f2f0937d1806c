"""Tables of a vocabulary turned into quantities."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from mutabot.config.mistakes import DocumentPlace, shown
from mutabot.model import Kind, Path, Quantity
from mutabot.model.path import Step

from .names import CALLABLE, Sides
from .rules import default_unit, default_values, faults, slice_of, split_axes, spread, steps_of
from .schema import QuantityTable

#: keys that a quantity has as its table has them
_ALIKE = ("kind", "frame", "mode", "noise", "order", "relative", "missing", "tcp")


def read_quantities(
    place: DocumentPlace, raw: dict[str, Any] | None, sides: Sides = CALLABLE, *, is_written: bool = False
) -> tuple[Quantity, ...]:
    """Read a table whose keys are paths to quantities; what a callable returns may be one quantity."""
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
        quantities = [replace(one, path=in_message(one.path, root)) for one in quantities]
    return tuple(quantities)


def in_message(path: Path, root: str | None) -> Path:
    """The path to a field that is named by its bare path."""
    return Path(root, (Step(attribute=path.root), *path.steps))


def bare_path(text: str) -> Path:
    """The bare path to a field of a message, whose root is that field. Raises ValueError if it is none."""
    try:
        return Path.parse(text.removeprefix("."), rooted=True)
    except ValueError as error:
        raise ValueError(str(error).replace("an argument's name", "the name of a field")) from None


def is_quantity(raw: dict[str, Any]) -> bool:
    """Whether a table is a quantity, rather than a table of paths."""
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
    axes = split_axes(table.axis) if table.axis is not None else None
    several = axes is not None and len(axes) > 1
    is_vector = slice_of(path) is not None and not several
    broken = list(faults(table, is_written=is_written, is_vector=is_vector, words=sides.words))
    for key, text, known in broken:
        if known is None:
            (place / key).error(text)
        else:
            (place / key).unknown(key, text, known)
    if broken:
        return
    if axes is None or not several:
        yield _quantity(table, path, table.axis, name)
        return
    parts = (place / "axis").attempt(spread, path, axes)
    for axis, part in zip(axes, parts or (), strict=False):
        yield _quantity(table, part, axis, None)


def _leaves(
    raw: dict[str, Any], before: str, place: DocumentPlace
) -> Iterator[tuple[str, Any, DocumentPlace]]:
    """Path, table and place of each quantity; ``arguments.pose.x`` without quotes is nested in TOML."""
    for key, item in raw.items():
        text = f"{before}{key}" if not before or key.startswith((".", "[")) else f"{before}.{key}"
        if isinstance(item, dict) and item and not is_quantity(item):
            yield from _leaves(item, text, place / key)
        else:
            yield text, item, place / key


def _path_of(text: str, sides: Sides, is_written: bool) -> Path:
    """The path to a quantity. Raises ValueError, saying what would be right."""
    if not sides.is_message and not is_written and not text.startswith((".", "[")):
        dotted = f'"[{text}]"' if text.isdigit() else f'".{text}"'
        raise ValueError(f"a path into the result begins with a dot or a bracket: write result.{dotted}")
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
    steps, unit = steps_of(table)
    facts = {key: getattr(table, key) for key in _ALIKE}
    for key in ("range", "clip"):
        limits = getattr(table, key)
        facts[key] = tuple(limits) if limits is not None else None
    return Quantity(
        name=name or str(path),
        path=path,
        axis=axis,
        unit=default_unit(table),
        values=default_values(table),
        ladder=tuple(map(float, steps)) if steps is not None else None,
        ladder_unit=unit,
        **facts,
    )
