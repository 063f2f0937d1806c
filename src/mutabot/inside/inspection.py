"""Whether what the vocabulary names can be read the way it is meant, found out without reading it."""

from __future__ import annotations

import sys
from typing import Any

from mutabot.inside.calls.intercept import resolve
from mutabot.inside.readings.probes import is_bound, needed_arguments


def why_not_asked(reading: str, asker: type | None) -> str | None:
    """Why an operation's ``current`` cannot be asked where the robot is, and what is needed; None if it can.

    Args:
        reading: the callable that reads it.
        asker: the class of the object that the operation is called on; None for a function.
    """
    module, _, qualname = reading.partition(":")
    owner, name, _ = resolve(sys.modules[module], qualname)
    if asker is not None and "." in qualname and hasattr(asker, name):
        return _why_not_called(asker, name, reading)
    if isinstance(owner, type) and is_bound(owner, name):
        of = f"the operation is called on {asker.__name__}" if asker else "the operation is a function"
        return (
            f"{reading} is read from an object of {owner.__name__}, but {of}; "
            f"name {'a method of that class' if asker else 'a function'} that needs no arguments"
        )
    return _why_not_called(owner, name, reading)


def _why_not_called(owner: Any, name: str, reading: str) -> str | None:
    found = getattr(owner, name)
    if not callable(found):
        return None
    needed = needed_arguments(found)
    if isinstance(owner, type) and is_bound(owner, name):
        needed = needed[1:]  # self
    if not needed:
        return None
    return f"{reading} needs {', '.join(needed)}, but it is asked without arguments"
