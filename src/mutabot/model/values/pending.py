"""Futures that are never done: what a command that is lost answers where the original answered a future."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

from mutabot.extensions import brought
from mutabot.model.class_name import class_name


def future_class(value: Any) -> str | None:
    """The kind of future that a value is; None if it is none."""
    # these modules are slow to import, and where nobody has done so there are no futures of theirs
    if isinstance(value, _imported("asyncio", "Task")):
        return "asyncio.Task"
    if isinstance(value, _imported("asyncio", "Future")):
        return "asyncio.Future"
    if type(value) in _imported("concurrent.futures", "Future"):
        return "concurrent.futures.Future"
    name = class_name(type(value))
    return next((one.name for one in brought("futures").values() if one.reference == name), None)


def _imported(module: str, name: str) -> tuple[type, ...]:
    """A class, if its module is imported."""
    found = getattr(sys.modules.get(module), name, None)
    return () if found is None else (found,)


def never_done(kind: str, here: Mapping[str, Any]) -> Any:
    """A new future of this kind that nobody ever completes. Raises LookupError where there can be none."""
    if kind == "concurrent.futures.Future":
        import concurrent.futures  # noqa: PLC0415  # as above

        return concurrent.futures.Future()
    known = brought("futures").get(kind)
    if known is not None:
        if known.reference.partition(":")[0] not in sys.modules:
            raise LookupError(f"{known.reference} is not imported")
        return known.load()()
    import asyncio  # noqa: PLC0415  # as above

    try:
        loop = asyncio.get_running_loop()
    except RuntimeError:
        raise LookupError(f"a future of kind {kind} needs an event loop, and none is running") from None
    if kind != "asyncio.Task":
        return loop.create_future()

    async def never() -> None:
        await loop.create_future()

    return loop.create_task(never())
