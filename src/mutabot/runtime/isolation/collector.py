"""Freeze objects for the garbage collector in copies of the fork server, until code could notice.

The objects that exist before any test are frozen: a collection would write to each, and so take from every
fork what it shares with its parent. They are thawed before the first question or collection of the program's
or its tests' that could show that, and then stay so. Pytest itself collects at the end of each session, when
no test can look any more: that leaves them frozen, unless warnings are errors, such as of what a finalizer
raises then.

Where the program or a plug-in of pytest has frozen objects itself, nothing else is frozen: they could not be
thawed alone.
"""

from __future__ import annotations

import gc
import warnings
from collections.abc import Callable
from functools import wraps
from sys import _getframe
from types import FrameType
from typing import Any

from mutabot.runtime.processes.environment import listen

#: audit events of the questions for objects
_QUESTIONS = ("gc.get_objects", "gc.get_referrers")
#: what else could show what is frozen, of which there are no audit events
_FUNCTIONS = ("collect", "freeze", "get_freeze_count")
#: pytest's module that collects when all tests are over
_AT_THE_END = "_pytest.unraisableexception"

_is_frozen = False


def watch() -> None:
    """Thaw objects before code could notice, from now on. Call it before user code is imported."""
    listen(_QUESTIONS, lambda event, arguments: _thaw())
    for name in _FUNCTIONS:
        setattr(gc, name, _thawing(getattr(gc, name)))


def freeze() -> None:
    """Freeze all existing objects, unless some are frozen already."""
    global _is_frozen  # noqa: PLW0603  # a process has one collector
    if gc.get_freeze_count():
        return
    gc.collect()
    gc.freeze()
    _is_frozen = True


def _thaw() -> None:
    global _is_frozen  # noqa: PLW0603
    if _is_frozen:
        _is_frozen = False
        gc.unfreeze()


def _thawing(function: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(function)
    def asked(*arguments: Any, **named: Any) -> Any:
        caller = _getframe().f_back  # a thread may begin here, and has none
        if caller is None or caller.f_globals.get("__name__") != _AT_THE_END or _counts(caller):
            _thaw()
        return function(*arguments, **named)

    return asked


def _counts(frame: FrameType) -> bool:
    """Return whether a finalizer that raises in this collection at the end makes the session fail.

    Since 9.2, pytest collects once more, and what is garbage now is so then. What its settings make an error
    is one until then; the program may have made errors of warnings for a shorter time.
    """
    caller, last = frame.f_back, frame.f_globals.get("cleanup")
    if (
        caller is not None
        and caller.f_code.co_name == "pytest_unconfigure"
        and frame.f_code.co_name in getattr(getattr(last, "__code__", None), "co_names", ())
        and any(text.startswith("error") for text in caller.f_locals["config"].getini("filterwarnings"))
    ):
        return False
    return any(action == "error" for action, *_ in warnings.filters)
