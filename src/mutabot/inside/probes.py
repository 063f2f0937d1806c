"""Probes: readings that mutabot itself takes at the end of a test."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

from mutabot.model import Probe

from .intercept import resolve

#: parts reported per probe; a probe is meant to be a handful of numbers
LIMIT = 200


def take(probes: tuple[Probe, ...]) -> dict[str, Any]:
    """All probes' values, flat: ``target.part`` to number, text or truth value.

    A probe whose module the test did not import is left out. One that raises reports its error as its
    value, so that two worlds of which one cannot be read never count as equal.
    """
    values: dict[str, Any] = {}
    for probe in probes:
        module, _, qualname = probe.target.partition(":")
        if module not in sys.modules:
            continue
        try:
            owner, name, _ = resolve(sys.modules[module], qualname)
            found = getattr(owner, name)()
        except Exception as error:  # whatever the user's probe does, the test's outcome stands
            found = f"{type(error).__name__}: {error}"
        values.update(flatten(found, probe.target))
    return values


def flatten(value: Any, name: str) -> dict[str, Any]:
    """A nested value as flat parts."""
    parts: dict[str, Any] = {}
    _flatten(value, name, parts)
    return dict(list(parts.items())[:LIMIT])


def _flatten(value: Any, name: str, parts: dict[str, Any]) -> None:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if is_dataclass(value) and not isinstance(value, type):
        value = {field.name: getattr(value, field.name) for field in fields(value)}
    elif hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, Mapping):
        for key, item in value.items():
            _flatten(item, f"{name}.{key}", parts)
    elif isinstance(value, list | tuple):
        for index, item in enumerate(value):
            _flatten(item, f"{name}[{index}]", parts)
    else:
        parts[name] = value if isinstance(value, int | float | str | bool | None) else repr(value)
