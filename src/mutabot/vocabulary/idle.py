"""What the vocabulary says a command answers while the robot does nothing."""

from __future__ import annotations

from typing import Any

from mutabot.settings.mistakes import Check, shown
from mutabot.settings.toml_lines import KeyPath

from .targets import target_fault


def read_idle(check: Check, raw: Any, place: KeyPath) -> Any:
    """``idle = …`` as data that ``model.values.answer.restore`` understands; mistakes are noted.

    A TOML value is the answer itself; ``{ call = "module:name" }`` names a function that makes it.
    """
    if isinstance(raw, dict) and set(raw) == {"call"}:
        target = raw["call"]
        fault = target_fault(target) if isinstance(target, str) else f"must be a text, not {shown(target)}"
        if fault is not None:
            check.error((*place, "call"), fault)
        return {"call": target}
    return _data(check, raw, place)


def _data(check: Check, raw: Any, place: KeyPath) -> Any:
    if isinstance(raw, list):
        return {"list": [_data(check, item, place) for item in raw]}
    if isinstance(raw, dict):
        return {"dict": [[key, _data(check, item, (*place, key))] for key, item in raw.items()]}
    if raw is not None and not isinstance(raw, str | bool | int | float):
        wanted = 'a text, a number, true, false, an array or table of these, or { call = "module:name" }'
        check.error(place, f"must be {wanted}, not {shown(raw)}")
    return raw
