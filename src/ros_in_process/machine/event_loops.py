"""asyncio in simulated time: an event loop that waits with the scheduler instead of the operating system.

Tasks, futures and all else of asyncio are the real ones.
"""

from __future__ import annotations

import asyncio
import selectors
from collections.abc import Callable, Coroutine
from types import ModuleType
from typing import Any

from ros_in_process.errors import note
from ros_in_process.machine.imports import provide, simulated_module, with_replacements
from ros_in_process.machine.scheduler import SCHEDULER, SECOND, SimulatedThread

_OWN_FILES = 1  # the pipe by which a loop wakes itself


class _Selector(selectors.SelectSelector):
    """Waits for files as long as simulated time does not pass."""

    def __init__(self) -> None:
        super().__init__()
        self.waiting: SimulatedThread | None = None

    def select(self, timeout: float | None = None) -> list[Any]:
        if len(self.get_map()) > _OWN_FILES:
            note("an event loop waits for sockets or files, in real time")
            return super().select(timeout)
        if timeout is not None and timeout <= 0:
            SCHEDULER.poll()
            SCHEDULER.pause()
            return []
        end = None if timeout is None else SCHEDULER.now + round(timeout * SECOND)
        self.waiting = SCHEDULER.current
        try:
            SCHEDULER.park(end, "runs an event loop in which all wait")
        finally:
            self.waiting = None
        return []


class SimulatedEventLoop(asyncio.SelectorEventLoop):
    """An event loop in simulated time."""

    def __init__(self) -> None:
        self._waits_in = _Selector()
        self._was_called = False
        super().__init__(self._waits_in)

    def time(self) -> float:
        return SCHEDULER.now / SECOND

    def _write_to_self(self) -> None:
        if self._waits_in.waiting is not None:
            SCHEDULER.wake(self._waits_in.waiting)

    def run_in_executor(  # type: ignore[override]  # any executor will do
        self, executor: Any, func: Callable[..., Any], *args: Any
    ) -> Any:
        pool = executor or self._threads()
        return _awaitable(pool.submit(func, *args), self)

    def _threads(self) -> Any:
        if self._default_executor is None:  # type: ignore[has-type]
            self._default_executor = simulated_module("concurrent.futures").ThreadPoolExecutor(
                thread_name_prefix="asyncio"
            )
        return self._default_executor

    async def shutdown_default_executor(self, timeout: float | None = None) -> None:
        if self._default_executor is not None:
            self._default_executor.shutdown(wait=True)


def _copy_result(source: Any, target: Any) -> None:
    if target.done():
        return
    if source.cancelled():
        target.cancel()
    elif source.exception() is not None:
        target.set_exception(source.exception())
    else:
        target.set_result(source.result())


def _awaitable(future: Any, loop: asyncio.AbstractEventLoop) -> Any:
    waiting = loop.create_future()
    future.add_done_callback(lambda done: loop.call_soon_threadsafe(_copy_result, done, waiting))
    return waiting


def _wrap_future(future: Any, *, loop: asyncio.AbstractEventLoop | None = None) -> Any:
    if asyncio.isfuture(future):
        return future
    return _awaitable(future, loop or asyncio.get_running_loop())


def _run_threadsafe(coroutine: Coroutine[Any, Any, Any], loop: asyncio.AbstractEventLoop) -> Any:
    future = simulated_module("concurrent.futures").Future()

    def start() -> None:
        task = asyncio.ensure_future(coroutine, loop=loop)
        task.add_done_callback(lambda done: _copy_result(done, future))

    loop.call_soon_threadsafe(start)
    return future


def _run(main: Coroutine[Any, Any, Any], *, debug: bool | None = None) -> Any:
    with asyncio.Runner(debug=debug, loop_factory=SimulatedEventLoop) as runner:
        return runner.run(main)


_loops: dict[SimulatedThread, asyncio.AbstractEventLoop | None] = {}


def _get_event_loop() -> asyncio.AbstractEventLoop:
    running = asyncio._get_running_loop()
    if running is not None:
        return running
    loop = _loops.get(SCHEDULER.current)
    if loop is None:
        loop = _loops[SCHEDULER.current] = SimulatedEventLoop()
    return loop


def _set_event_loop(loop: asyncio.AbstractEventLoop | None) -> None:
    _loops[SCHEDULER.current] = loop
    asyncio.set_event_loop(loop)


def _asyncio() -> ModuleType:
    SCHEDULER.on_switch.append(_change_running_loop)
    return with_replacements(
        "asyncio",
        run=_run,
        Runner=lambda *, debug=None, loop_factory=SimulatedEventLoop: asyncio.Runner(
            debug=debug, loop_factory=loop_factory
        ),
        new_event_loop=SimulatedEventLoop,
        get_event_loop=_get_event_loop,
        set_event_loop=_set_event_loop,
        SelectorEventLoop=SimulatedEventLoop,
        run_coroutine_threadsafe=_run_threadsafe,
        wrap_future=_wrap_future,
    )


_running: dict[SimulatedThread, Any] = {}


def _change_running_loop(old: SimulatedThread, new: SimulatedThread) -> None:
    """Exchange asyncio's running loop, kept per native thread, when the simulated thread changes."""
    running = asyncio._get_running_loop()
    if running is not None or _running:
        _running[old] = running
        asyncio._set_running_loop(_running.pop(new, None))


def install() -> None:
    """Provide asyncio to the modules that see the simulation."""
    provide("asyncio", _asyncio)
