"""Modules of the standard library that wait or read clocks, simulated.

Only `_thread` and `time` are written anew. `threading`, `queue`, `concurrent.futures` and `sched` are
second copies of the library's own source above them, so they behave as they do everywhere.
"""

from __future__ import annotations

import datetime as real_datetime
import importlib
import sys
import threading as real_threading
import time as real_time
import uuid as real_uuid
from collections.abc import Callable
from random import Random
from types import ModuleType
from typing import Any

from ros_in_process.errors import NeedsRealRos
from ros_in_process.machine import imports
from ros_in_process.machine.imports import provide, second_copy, simulated_module, with_replacements
from ros_in_process.machine.scheduler import SCHEDULER, SECOND
from ros_in_process.machine.threads import PYTHONS, thread_module


def _threading() -> ModuleType:
    module = second_copy("threading")
    of_tests = module.__dict__["main_thread"]

    def main_thread() -> Any:
        process = SCHEDULER.current.process
        return of_tests() if process is None or process.main_thread is None else process.main_thread

    def excepthook(args: Any) -> None:
        real_threading.excepthook(args)  # as it is now: pytest sets it for each test

    module.__dict__.update(main_thread=main_thread, excepthook=excepthook)
    return module


def _read() -> int:
    SCHEDULER.poll()
    return SCHEDULER.now


def _read_system() -> int:
    SCHEDULER.poll()
    return SCHEDULER.system_time


def _sleep(seconds: float) -> None:
    if seconds < 0:
        raise ValueError("sleep length must be non-negative")
    SCHEDULER.sleep(round(seconds * SECOND))
    if seconds == 0:
        SCHEDULER.poll()


def _time() -> ModuleType:
    def now_if_none(convert: Callable[[float], Any]) -> Callable[..., Any]:
        return lambda seconds=None: convert(_read_system() / SECOND if seconds is None else seconds)

    return with_replacements(
        "time",
        sleep=_sleep,
        time=lambda: _read_system() / SECOND,
        time_ns=_read_system,
        **dict.fromkeys(
            ("monotonic", "perf_counter", "process_time", "thread_time"), lambda: _read() / SECOND
        ),
        **dict.fromkeys(("monotonic_ns", "perf_counter_ns", "process_time_ns", "thread_time_ns"), _read),
        localtime=now_if_none(real_time.localtime),
        gmtime=now_if_none(real_time.gmtime),
        ctime=now_if_none(real_time.ctime),
        strftime=lambda text, when=None: real_time.strftime(
            text, real_time.localtime(_read_system() / SECOND) if when is None else when
        ),
    )


def _datetime() -> ModuleType:
    class date(real_datetime.date):  # noqa: N801  (the names that it has there)
        @classmethod
        def today(cls) -> Any:
            return cls.fromtimestamp(_read_system() / SECOND)

    class datetime(real_datetime.datetime):  # noqa: N801
        @classmethod
        def now(cls, tz: real_datetime.tzinfo | None = None) -> Any:
            return cls.fromtimestamp(_read_system() / SECOND, tz)

        @classmethod
        def today(cls) -> Any:
            return cls.now()

        @classmethod
        def utcnow(cls) -> Any:
            return cls.now(real_datetime.UTC).replace(tzinfo=None)

    return with_replacements("datetime", datetime=datetime, date=date)


def _queue() -> ModuleType:
    return second_copy("queue")


def _c_queue() -> ModuleType:
    """Return `_queue` without `SimpleQueue`, which would block the native thread; Python's own is used."""
    module = ModuleType("_queue")
    module.Empty = __import__("queue").Empty  # type: ignore[attr-defined]
    return module


def _no_processes(*_: object, **__: object) -> None:
    raise NeedsRealRos("a ProcessPoolExecutor runs on processors of its own")


def _futures() -> ModuleType:
    base = second_copy("concurrent.futures._base")
    module = with_replacements(
        "concurrent.futures",
        **{name: value for name, value in base.__dict__.items() if not name.startswith("_")},
        _base=base,
        ProcessPoolExecutor=_no_processes,
    )
    imports._built["concurrent.futures"] = module
    thread = second_copy("concurrent.futures.thread")
    module.__dict__.update(thread=thread, ThreadPoolExecutor=thread.ThreadPoolExecutor)
    return module


def _concurrent() -> ModuleType:
    return with_replacements("concurrent", futures=simulated_module("concurrent.futures"))


def _importlib() -> ModuleType:
    def import_module(name: str, package: str | None = None) -> ModuleType:
        return simulated_module(name) if imports.is_provided(name) else importlib.import_module(name, package)

    return with_replacements("importlib", import_module=import_module)


def _uuid() -> ModuleType:
    """Return a module whose identifiers are drawn from a seed, so that two runs have the same."""
    random = Random(0)

    def drawn() -> real_uuid.UUID:
        return real_uuid.UUID(int=random.getrandbits(128), version=4)

    return with_replacements("uuid", uuid4=drawn, uuid1=lambda node=None, clock_seq=None: drawn())


def install() -> None:
    """Provide these modules to the modules that see the simulation."""
    if sys.version_info[:2] not in PYTHONS:
        raise NeedsRealRos(f"threads of Python {sys.version.split()[0]} are not simulated")
    for name, build in {
        "_thread": thread_module,
        "time": _time,
        "threading": _threading,
        "_queue": _c_queue,
        "queue": _queue,
        "sched": lambda: second_copy("sched"),
        "concurrent": _concurrent,
        "concurrent.futures": _futures,
        "concurrent.futures._base": lambda: simulated_module("concurrent.futures")._base,
        "concurrent.futures.thread": lambda: simulated_module("concurrent.futures").thread,
        "datetime": _datetime,
        "importlib": _importlib,
        "uuid": _uuid,
    }.items():
        provide(name, build)
    imports.install()
    for name in ("threading", "queue", "concurrent.futures"):
        simulated_module(name)
