"""`_thread` for simulated threads, on which `threading` is built."""

from __future__ import annotations

import _thread as real_thread
import threading as real_threading
from collections.abc import Callable
from contextlib import suppress
from types import ModuleType
from typing import Any
from weakref import WeakKeyDictionary

from ros_in_process.machine.locks import Lock, RLock
from ros_in_process.machine.scheduler import SCHEDULER

#: whose `threading` is known to stand on the names of `_thread` below
PYTHONS = {(3, 11), (3, 12), (3, 13)}
_TIMEOUT_MAX = 9_000_000_000.0


class Local:
    """`threading.local` for simulated threads: each has its own attributes."""

    __slots__ = ("__dict__", "_arguments", "_dictionaries")

    def __new__(cls, *args: Any, **kwargs: Any) -> Local:
        self = object.__new__(cls)
        object.__setattr__(self, "_arguments", (args, kwargs))
        object.__setattr__(self, "_dictionaries", WeakKeyDictionary({SCHEDULER.current: {}}))
        return self

    def __getattribute__(self, name: str) -> Any:
        _make_current(self)
        return object.__getattribute__(self, name)

    def __setattr__(self, name: str, value: Any) -> None:
        _make_current(self)
        object.__setattr__(self, name, value)

    def __delattr__(self, name: str) -> None:
        _make_current(self)
        object.__delattr__(self, name)


def _make_current(local: Local) -> None:
    """Switch to the attributes of the running thread."""
    dictionaries = object.__getattribute__(local, "_dictionaries")
    own = dictionaries.get(SCHEDULER.current)
    is_new = own is None
    if is_new:
        own = dictionaries[SCHEDULER.current] = {}
    object.__setattr__(local, "__dict__", own)
    if is_new and type(local) is not Local:  # a class derived from it is set up in each thread
        args, kwargs = object.__getattribute__(local, "_arguments")
        type(local).__init__(local, *args, **kwargs)


def _ident() -> int:
    task = SCHEDULER.current
    return real_threading.main_thread().ident or 0 if task is SCHEDULER.main else task.number


def _start_new_thread(
    function: Callable[..., object], args: tuple[object, ...], kwargs: dict[str, object] | None = None
) -> int:
    def run() -> None:
        with suppress(SystemExit):
            function(*args, **(kwargs or {}))

    owner = getattr(function, "__self__", None)  # the Thread, if it is one
    if owner is not None:
        owner.process = SCHEDULER.current.process
    return SCHEDULER.spawn(run).number


class ThreadHandle:
    """The handle on which `Thread.join` waits from Python 3.13 on."""

    def __init__(self) -> None:
        self.ident = 0
        self._done = Lock()
        self._is_done = False

    def is_done(self) -> bool:
        return self._is_done

    def _set_done(self) -> None:
        self._is_done = True
        if self._done.locked():
            self._done.release()

    def join(self, timeout: float | None = None) -> None:
        if not self._is_done and self._done.acquire(timeout=-1 if timeout is None else max(timeout, 0)):
            self._done.release()


def _start_joinable_thread(
    function: Callable[[], object], handle: ThreadHandle | None = None, daemon: bool = True
) -> ThreadHandle:
    handle = handle or ThreadHandle()
    handle._done.acquire()

    def run() -> None:
        try:
            function()
        finally:
            handle._set_done()

    owner = getattr(function, "__self__", None)  # the Thread
    if owner is not None:
        owner.process = SCHEDULER.current.process
    handle.ident = _start_new_thread(run, ())
    return handle


def _made_handle(ident: int) -> ThreadHandle:
    handle = ThreadHandle()
    handle.ident = ident
    return handle


def _set_sentinel() -> Lock:
    SCHEDULER.current.sentinel = lock = Lock()
    return lock


def thread_module() -> ModuleType:
    """Return the module that replaces `_thread`."""
    module = ModuleType("_thread")
    module.__dict__.update(
        error=RuntimeError, _local=Local,
        LockType=Lock, allocate_lock=Lock, allocate=Lock, RLock=RLock, TIMEOUT_MAX=_TIMEOUT_MAX,
        get_ident=_ident, start_new_thread=_start_new_thread, start_new=_start_new_thread,
        _set_sentinel=_set_sentinel,
        start_joinable_thread=_start_joinable_thread, _ThreadHandle=ThreadHandle,
        _make_thread_handle=_made_handle, _shutdown=lambda: None,
        _get_main_thread_ident=lambda: real_threading.main_thread().ident,
        daemon_threads_allowed=lambda: True, stack_size=lambda size=0: 0, _is_main_interpreter=lambda: True,
        interrupt_main=lambda signum=2: SCHEDULER.interrupt(SCHEDULER.main, KeyboardInterrupt()),
        _excepthook=real_thread._excepthook, _ExceptHookArgs=real_thread._ExceptHookArgs,
    )  # fmt: skip
    return module
