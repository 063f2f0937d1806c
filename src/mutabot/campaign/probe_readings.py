"""Readings of probes: the values that they hold, and how often to take them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any

from mutabot.model import Path, Probe, Quantity
from mutabot.model.path import Step

if TYPE_CHECKING:
    from mutabot.model.events import TestEnd

_PARTS = (("w", "x", "y", "z"), ("theta_x", "theta_y", "theta_z"), ("x", "y", "z"))
#: share of a test's processor time that readings along the way may take, and the seconds that any test may
_SHARE, _LEAST = 0.01, 0.005
#: after every how many commands; a coarser one where this takes too long
_STRIDES = (1, 4, 16, 64)
#: readings before the first thinning inside
_FULL = 100


def value_of(quantity: Quantity, keys: Sequence[str], values: Mapping[str, Any]) -> Any:
    """Return the value of a quantity among those of a reading, by its keys."""
    return [values[key] for key in keys] if quantity.is_whole else values[keys[0]]


def parts_of(name: str, quantity: Quantity, values: Mapping[str, Any]) -> Iterator[Any]:
    """Return the values of a quantity that a reading of a probe contains."""
    for part in quantities_meant(name, quantity, values):
        keys = keys_of(name, part, values)
        if keys and all(key in values for key in keys):
            yield value_of(part, keys, values)


def is_pattern(quantity: Quantity) -> bool:
    """Return whether it matches all parts by name, such as ``["*tool"]``; there may be no match."""
    last = quantity.path.steps[-1].item if quantity.path.steps else None
    return isinstance(last, str) and "*" in last


def quantities_meant(name: str, quantity: Quantity, values: Mapping[str, Any]) -> Iterator[Quantity]:
    """Yield the quantities that a pattern matches, or the quantity itself if it is no pattern."""
    if not is_pattern(quantity):
        yield quantity
        return
    *before, last = quantity.path.steps
    tails = [key[len(name) + 1 :] for key in values if key.startswith(f"{name}.")]
    owners = [tail.rpartition(".")[0] if quantity.is_whole else tail for tail in tails]
    for owner in dict.fromkeys(owners):
        if fnmatchcase(owner, last.item):
            yield replace(quantity, path=Path(None, (*before, Step(item=owner))))


def readings_of(probe: Probe, values: Mapping[str, Any]) -> list[str]:
    """Return the probe's names among its values: one for each object."""
    found: dict[str, None] = {}
    for key in values:
        tail = key[len(probe.target) :] if key.startswith(probe.target) else None
        if tail is not None and (not tail or tail[0] in ".[#"):
            number = tail[1:].partition(".")[0].partition("[")[0] if tail[:1] == "#" else ""
            found[f"{probe.target}#{number}" if number else probe.target] = None
    return list(found)


def keys_of(name: str, quantity: Quantity, values: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the flat values that a quantity consists of, in its order; none if they are not there."""
    path = quantity.path
    bounds = path.steps[-1].bounds if path.steps else None
    steps = path.steps[:-1] if bounds is not None else path.steps
    base = name + "".join(
        _step(step.attribute if step.attribute is not None else step.item) for step in steps
    )
    if bounds is None and not quantity.is_whole:
        return (base,)
    count = 0
    while f"{base}[{count}]" in values:
        count += 1
    if count:
        indexes = range(count)[slice(*bounds)] if bounds is not None else range(count)
        return tuple(f"{base}[{index}]" for index in indexes)
    named: tuple[str, ...] = next(
        (parts for parts in _PARTS if all(f"{base}.{part}" in values for part in parts)), ()
    )
    if len(named) == 4 and quantity.order is not None:
        named = tuple(quantity.order)
    return tuple(f"{base}.{part}" for part in named)


def _step(item: Any) -> str:
    return f"[{item}]" if isinstance(item, int) else f".{item}"


def step_text(step: Step) -> str:
    """Return a step of a path as the names of values have it."""
    return str(step) if step.bounds is not None else _step(step.attribute or step.item)


def probe_intervals_of(ends: Mapping[tuple[int, str], TestEnd]) -> dict[int, dict[str, int]]:
    """Return the number of commands between two readings, by round and test; tests without are left out."""
    read = [end for end in ends.values() if end.reading is not None]
    if not read or any(end.not_along for end in ends.values()):
        return {}
    seconds = min(end.reading for end in read if end.reading is not None)
    found: dict[int, dict[str, int]] = {}
    for (round, test), end in ends.items():
        may_take = max(_LEAST, _SHARE * end.cpu)
        possible = [interval for interval in _STRIDES if interval <= end.commands]
        fitting = [
            interval for interval in possible if _readings_at(end.commands, interval) * seconds <= may_take
        ]
        if fitting:
            found.setdefault(round, {})[test] = fitting[0]
    return found


def _readings_at(commands: int, stride: int) -> int:
    """Return about how many readings a test has."""
    moments = commands // stride
    return moments if moments <= _FULL else _FULL + 50 * (moments // _FULL).bit_length()
