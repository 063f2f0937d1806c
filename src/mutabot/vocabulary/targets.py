"""Names of callables and exceptions: ``module:qualified.name``.

An operation that is no Python callable has a key of its own in place of ``call``, as those with a name on a
middleware have (``vocabulary.named``), and the kind that finds it at run time in ``Operation.kind`` (see
``inside.targets.target``). What a command answers while the robot does nothing may be made by a callable.
"""

from __future__ import annotations

import builtins
import keyword
from typing import Any

from mutabot.settings.mistakes import Check, shown
from mutabot.settings.toml_lines import KeyPath


def is_name(text: str) -> bool:
    """Whether Python takes a text for a name."""
    return text.isidentifier() and not keyword.iskeyword(text)


def target_fault(text: str) -> str | None:
    """What is wrong with a target, or None."""
    form = "module:qualified.name"
    if not text.strip():
        return f"is empty; expected {form}"
    if text.count(":") > 1:
        return f"{text!r} has more than one colon; expected {form}"
    if ":" not in text:
        return f"{text!r} has no colon between module and name; write {_with_colon(text)!r}"
    module, _, name = text.partition(":")
    if not module or not name:
        return f"{text!r} has no {'name after' if module else 'module before'} the colon; expected {form}"
    for part in (*module.split("."), *name.split(".")):
        if not part:
            return f"{text!r} has a dot too many; expected {form}"
        if not is_name(part):
            return f"{text!r}: {part!r} is not a Python name; expected {form}"
    return None


def _with_colon(text: str) -> str:
    if isinstance(getattr(builtins, text, None), type):
        return f"builtins:{text}"
    parts = text.split(".")
    if len(parts) == 1:
        return f"module:{text}"
    # robot.Arm.move: by convention a module's name is lower case and a class's is not
    first = next((index for index, part in enumerate(parts) if index and part[:1].isupper()), len(parts) - 1)
    return f"{'.'.join(parts[:first])}:{'.'.join(parts[first:])}"


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
