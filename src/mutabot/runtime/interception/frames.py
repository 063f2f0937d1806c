"""Recognise frames that carry out operations, and remove mutabot's frames from tracebacks.

An exception keeps the frames that it came through, and these what a call was given: ours would keep it longer
than the robot's own do.
"""

from __future__ import annotations

import sys
import weakref
from types import CodeType, FrameType, FunctionType, ModuleType, TracebackType
from typing import Any, Generic, TypeVar, cast

from mutabot.extensions import GROUP

F = TypeVar("F")
K = TypeVar("K")
V = TypeVar("V")
#: code whose frames carry an operation out, by identity: that of equal functions is equal
borders: dict[int, CodeType] = {}


def border(function: F) -> F:
    """Mark a function whose frames carry out an operation, so that calls below are not the program's."""
    code = cast("FunctionType", function).__code__
    borders[id(code)] = code
    return function


def is_within_border(frame: FrameType | None) -> bool:
    """Return whether an outer frame carries out an operation."""
    while frame is not None and id(frame.f_code) not in borders:
        frame = frame.f_back
    return frame is not None


class ModuleCache(Generic[K, V]):
    """A cache of facts about modules' global names, which lasts as long as the modules.

    A test may load a module anew, or run a file for its names alone: nothing of these is kept.

    Attributes:
        known: what is remembered, by keys.
    """

    def __init__(self) -> None:
        self.known: dict[K, V] = {}
        self._keys: dict[weakref.ref[ModuleType], set[K]] = {}

    def keep(self, names: dict[str, Any], key: K, value: V) -> V:
        """Store a fact about ``names`` if they are the global names of a module."""
        module = sys.modules.get(names.get("__name__", ""))
        if type(module) is ModuleType and vars(module) is names:
            self.known[key] = value
            self._keys.setdefault(weakref.ref(module, self._forget), set()).add(key)
        return value

    def _forget(self, module: weakref.ref[ModuleType]) -> None:
        for key in self._keys.pop(module, ()):
            self.known.pop(key, None)


def from_here(error: BaseException) -> TracebackType | None:
    """Return the traceback of an exception that is caught here, without the frames below this one."""
    here = error.__traceback__
    if here is not None:
        here.tb_next = without_ours(here.tb_next)
    return here


def without_ours(traceback: TracebackType | None) -> TracebackType | None:
    """Remove mutabot's frames from a traceback; those of the operation stay.

    None of them may be running any more. The frames of the operation lead back to them: what they held is let
    go. What stands between the program and the operation is all ours, also what a package brought; in the
    operation, a package may have put a fault, which stays to be seen.
    """
    frames = []
    while traceback is not None:
        frames.append(traceback)
        traceback = traceback.tb_next
    borders_here = (number for number, frame in enumerate(frames) if id(frame.tb_frame.f_code) in borders)
    callers = (number for number in borders_here if not is_ours(frames[number].tb_frame))
    first, following = next(callers, -1), None
    for number, step in reversed(list(enumerate(frames))):
        if number <= first or is_ours(step.tb_frame):
            step.tb_frame.clear()
        else:
            step.tb_next, following = following, step
    return following


def is_ours(frame: FrameType) -> bool:
    """Return whether a frame runs code of mutabot."""
    return str(frame.f_globals.get("__name__", "")).partition(".")[0] == GROUP
