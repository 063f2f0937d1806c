"""`_thread` among simulated threads: what `threading` stands on."""

from __future__ import annotations

import _thread as real_thread
import sys
import threading as real_threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from types import ModuleType
from typing import Any
from weakref import WeakKeyDictionary

from mutabot_ros.simulation.machine.scheduler import SCHEDULER, SECOND, SimulatedThread
from mutabot_ros.simulation.machine.who_asks import is_of_project

#: whose `threading` is known to stand on the names of `_thread` below
PYTHONS = {(3, 11), (3, 12), (3, 13)}
_TIMEOUT_MAX = 9_000_000_000.0


def _is_asked_by_project() -> bool:
    """Whether the project itself takes a lock: switching within rclpy would find races of rclpy alone."""
    frame = sys._getframe(2)
    if frame.f_code is Lock.__enter__.__code__ and frame.f_back is not None:
        frame = frame.f_back
    return is_of_project(str(frame.f_globals.get("__file__", "")))


class Lock:
    """`_thread.lock`, among simulated threads."""

    def __init__(self) -> None:
        self._is_held = False
        self._waiting: deque[SimulatedThread] = deque()

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        if not blocking and timeout != -1:
            raise ValueError("can't specify a timeout for a non-blocking call")
        if timeout < 0 and timeout != -1:
            raise ValueError("timeout value must be a non-negative number")
        if SCHEDULER.is_preemptive and _is_asked_by_project():
            SCHEDULER.may_switch()
        if self._is_held and not (blocking and self._wait(timeout)):
            return False
        self._is_held = True
        return True

    def _wait(self, timeout: float) -> bool:
        deadline = None if timeout == -1 else SCHEDULER.now + round(timeout * SECOND)
        while self._is_held:
            task = SCHEDULER.current
            self._waiting.append(task)
            try:
                SCHEDULER.park(deadline, "waits for a lock or a condition")
            finally:
                if task in self._waiting:
                    self._waiting.remove(task)
            if self._is_held and deadline is not None and SCHEDULER.now >= deadline:
                return False
        return True

    def release(self) -> None:
        if not self._is_held:
            raise RuntimeError("release unlocked lock")
        self._is_held = False
        if self._waiting:
            SCHEDULER.wake(self._waiting.popleft())

    def locked(self) -> bool:
        return self._is_held

    def __enter__(self) -> bool:
        if self._is_held or SCHEDULER.is_preemptive:
            return self.acquire()
        self._is_held = True
        return True

    def __exit__(self, kind: object = None, error: object = None, trace: object = None) -> None:
        if self._waiting or not self._is_held:
            self.release()
        self._is_held = False

    def _at_fork_reinit(self) -> None:
        self._is_held = False


class Local:
    """`threading.local`: each thread has attributes of its own."""

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
    """Let the attributes be those of the thread that runs."""
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
    """What `Thread.join` waits for, from Python 3.13 on."""

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
    """The module that stands in the place of `_thread`."""
    module = ModuleType("_thread")
    module.__dict__.update(
        error=RuntimeError, _local=Local,
        LockType=Lock, allocate_lock=Lock, allocate=Lock, TIMEOUT_MAX=_TIMEOUT_MAX,
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
