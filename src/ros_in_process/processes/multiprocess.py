"""`multiprocessing` for the project's modules: its processes are simulated.

A process starts with modules of its own, and its function is imported anew, as with the start method
`spawn`.
"""

from __future__ import annotations

import copy
import importlib
import importlib.util
import os
import pickle
import sys
from collections.abc import Callable
from itertools import count
from types import ModuleType
from typing import Any

from ros_in_process.errors import NeedsRealRos, note
from ros_in_process.machine.imports import provide, simulated_module
from ros_in_process.machine.scheduler import SCHEDULER
from ros_in_process.processes.process import MAIN, STARTED, Process, current

_numbers = count(1)
_SHARED = "a function that cannot be imported runs in a process of its own: the process shares its modules"


class ChildProcess:
    """`multiprocessing.Process`, simulated."""

    def __init__(
        self, group: None = None, target: Callable[..., object] | None = None, name: str | None = None,
        args: Any = (), kwargs: Any = None, *, daemon: bool | None = None,
    ) -> None:  # fmt: skip
        self._target, self._args, self._kwargs = target, tuple(args), dict(kwargs or {})
        self.name = name or f"Process-{next(_numbers)}"
        self.daemon = bool(daemon)
        self._process: Process | None = None

    def run(self) -> None:
        """Run the process's function."""
        if self._target is not None:
            self._target(*self._args, **self._kwargs)

    def start(self) -> None:
        if self._process is not None:
            raise AssertionError("cannot start a process twice")
        environ = dict(os.environ._data)  # type: ignore[attr-defined]  # as processes keep it
        self._process = Process(self.name, list(sys.argv), os.getcwd(), environ, list(sys.path))
        STARTED.append(self._process)
        args, kwargs = copy.deepcopy((self._args, self._kwargs))
        self._process.start(lambda: self._run_there(args, kwargs))

    def _run_there(self, args: Any, kwargs: Any) -> None:
        if type(self).run is not ChildProcess.run or self._target is None:
            _note_sharing()
            self.run()
            return
        _imported_anew(self._target)(*args, **kwargs)

    def _started(self) -> Process:
        if self._process is None:
            raise AssertionError("can only do this with a started process")
        return self._process

    def join(self, timeout: float | None = None) -> None:
        self._started().wait(timeout)

    def is_alive(self) -> bool:
        SCHEDULER.poll()
        return self._process is not None and self._process.returncode is None

    def terminate(self) -> None:
        self._started().send_signal(15)

    def kill(self) -> None:
        self._started().send_signal(9)

    def close(self) -> None:
        """Do nothing: no resource is held."""

    @property
    def pid(self) -> int | None:
        return None if self._process is None else self._process.pid

    ident = pid

    @property
    def exitcode(self) -> int | None:
        return None if self._process is None else self._process.returncode


def _note_sharing() -> None:
    note(_SHARED)


def _imported_anew(function: Callable[..., object]) -> Callable[..., object]:
    """Return the function with this name in this process's own modules."""
    found: Any = None
    try:
        found = importlib.import_module(function.__module__)
        for part in function.__qualname__.split("."):
            found = getattr(found, part)
    except (ImportError, AttributeError):
        found = None
    if not callable(found):
        _note_sharing()
        return function
    return found  # type: ignore[no-any-return]


class _SharedObject:
    """An object shared by simulated processes."""

    def __deepcopy__(self, memo: object) -> Any:
        return self


def _queue_class(name: str) -> type:
    base = getattr(simulated_module("queue"), name)

    def put(self: Any, item: Any, block: bool = True, timeout: float | None = None) -> None:
        base.put(self, pickle.loads(pickle.dumps(item)), block, timeout)

    nothing = {key: (lambda self: None) for key in ("close", "join_thread", "cancel_join_thread")}
    return type("Queue", (_SharedObject, base), {"put": put, **nothing})


class Connection(_SharedObject):
    """An end of a `multiprocessing.Pipe`."""

    def __init__(self, incoming: Any, outgoing: Any) -> None:
        self._incoming, self._outgoing = incoming, outgoing

    def send(self, item: Any) -> None:
        self._outgoing.put(item)

    def recv(self) -> Any:
        return self._incoming.get()

    def poll(self, timeout: float | None = 0.0) -> bool:
        queue = self._incoming
        with queue.not_empty:
            return bool(queue.not_empty.wait_for(queue._qsize, timeout))

    def close(self) -> None:
        """Do nothing: no resource is held."""


class _SharedValue(_SharedObject):
    def __init__(self, kind: object, value: Any = 0, *, lock: object = True) -> None:
        self.value = value
        self._lock = simulated_module("threading").RLock()

    def get_lock(self) -> Any:
        return self._lock


class _SharedArray(_SharedObject, list[Any]):
    def __init__(self, kind: object, content: Any, *, lock: object = True) -> None:
        super().__init__([0] * content if isinstance(content, int) else content)
        self._lock = simulated_module("threading").RLock()

    def get_lock(self) -> Any:
        return self._lock


def _needs_real(what: str) -> Callable[..., Any]:
    def refuse(*_: object, **__: object) -> None:
        raise NeedsRealRos(f"multiprocessing.{what} is not simulated")

    return refuse


def _multiprocessing() -> ModuleType:
    import multiprocessing as real  # noqa: PLC0415  (needed only where a project uses it)

    threading = simulated_module("threading")
    queue = _queue_class("Queue")

    def pipe(duplex: bool = True) -> tuple[Connection, Connection]:
        first, second = queue(), queue()
        return Connection(first, second), Connection(second, first)

    module = ModuleType("multiprocessing", real.__doc__)
    names = ("Event", "Barrier", "Condition", "Semaphore", "BoundedSemaphore")
    shared = {name: type(name, (_SharedObject, getattr(threading, name)), {}) for name in names}
    module.__dict__.update(
        Process=ChildProcess, Queue=queue, JoinableQueue=queue, SimpleQueue=queue, Pipe=pipe,
        Value=_SharedValue, Array=_SharedArray, RawValue=_SharedValue, RawArray=_SharedArray, **shared,
        Lock=_lock_class(threading.Lock), RLock=_lock_class(threading.RLock),
        get_context=lambda method=None: module, set_start_method=lambda method, force=False: None,
        get_start_method=lambda allow_none=False: "spawn", freeze_support=lambda: None,
        cpu_count=real.cpu_count,
        current_process=_current, active_children=list, TimeoutError=real.TimeoutError,
        Pool=_needs_real("Pool"), Manager=_needs_real("Manager"),
    )  # fmt: skip

    def other(name: str) -> Any:
        is_part = hasattr(real, name) or importlib.util.find_spec(f"multiprocessing.{name}") is not None
        if name.startswith("_") or not is_part:
            raise AttributeError(f"module 'multiprocessing' has no attribute {name!r}")
        _needs_real(name)()

    module.__dict__["__getattr__"] = other
    return module


def _lock_class(make: Callable[[], Any]) -> Callable[[], Any]:
    class SharedLock(_SharedObject):
        def __init__(self) -> None:
            self._inner = make()

        def __getattr__(self, name: str) -> Any:
            return getattr(self._inner, name)

        def __enter__(self) -> Any:
            return self._inner.__enter__()

        def __exit__(self, *error: object) -> None:
            self._inner.__exit__(*error)

    return SharedLock


def _current() -> Any:
    import multiprocessing as real  # noqa: PLC0415

    process = current()
    if process is MAIN:
        return real.current_process()
    found = ChildProcess(name=process.name)
    found._process = process
    return found


def install() -> None:
    """Provide multiprocessing to the modules that see the simulation."""
    provide("multiprocessing", _multiprocessing)
