"""Runs coroutines around rclpy's futures: they can only await a future or a pause.

A call without waiting (``call_async``) gives the program a future at once. What a mutant does around it is a
coroutine. It takes its first step at once, as the call itself would, and each further one as soon as what it
waits for is there, in the thread that brings it. The program has a future of ours, which ends with the
coroutine.
"""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Generator
from contextvars import copy_context
from importlib import import_module
from typing import Any

_INNER = "_mutabot_inner"


class FutureAnswer:
    """Awaits a future of rclpy."""

    def __init__(self, future: Any) -> None:
        self.future = future

    def __await__(self) -> Generator[Any, None, Any]:
        if not _is_over(self.future):
            yield self
        return self.future.result()

    def then(self, go_on: Callable[[Any], None]) -> None:
        """Continue when the future is done."""
        future = self.future
        schedule = future._schedule_or_invoke_done_callbacks

        def scheduled() -> None:
            schedule()
            go_on(future._executor() if future._executor is not None else None)

        # a callback of the future's would come one turn of the executor later
        future._schedule_or_invoke_done_callbacks = scheduled
        if _is_over(future):  # meanwhile
            scheduled()


class Pause:
    """Awaits the end of an action; ``begin`` gets the function to call then."""

    def __init__(self, begin: Callable[[Callable[[], object]], None]) -> None:
        self._begin = begin

    def __await__(self) -> Generator[Any, None, None]:
        yield self

    def then(self, go_on: Callable[[Any], None]) -> None:
        """Continue when the action is over."""
        self._begin(lambda: go_on(None))


class Never:
    """Awaits something that never happens."""

    def __await__(self) -> Generator[Any, None, None]:
        while True:
            yield self

    def then(self, go_on: Callable[[Any], None]) -> None:
        """Do nothing: no further step follows."""


def future_of(coroutine: Coroutine[Any, Any, Any]) -> Any:
    """Return a future of rclpy with a coroutine's result; raises what the coroutine's first step raises."""
    return _Driven(coroutine).begin()


def inner_of(future: Any) -> Any:
    """Return rclpy's future inside one of mutabot's; any other future as it is."""
    return getattr(future, _INNER, future)


class _Driven:
    def __init__(self, coroutine: Coroutine[Any, Any, Any]) -> None:
        self._coroutine = coroutine
        self._context = copy_context()
        self._future: Any = import_module("rclpy.task").Future()
        self._is_running = False
        self._is_due = False

    def begin(self) -> Any:
        try:
            awaited = self._context.run(self._coroutine.send, None)
        except StopIteration as end:
            self._future.set_result(end.value)
        else:
            self._future.add_done_callback(self._given_up)
            self._wait(awaited)
        return self._future

    def _wait(self, awaited: Any) -> None:
        setattr(self._future, _INNER, getattr(awaited, "future", self._future))
        awaited.then(_once(self._go_on))

    def _go_on(self, executor: Any) -> None:
        if _is_over(self._future):
            return
        if executor is not None:
            self._future._set_executor(executor)
        try:
            awaited = self._context.run(self._coroutine.send, None)
        except StopIteration as end:
            self._future.set_result(end.value)
        except Exception as error:
            self._future.set_exception(error)
        else:
            self._wait(awaited)

    def _given_up(self, future: Any) -> None:
        """Cancel the inner future when the program cancels its own."""
        inner = inner_of(future)
        if future.cancelled() and inner is not future:
            inner.cancel()


def _once(go_on: Callable[[Any], None]) -> Callable[[Any], None]:
    left = [go_on]

    def going(executor: Any) -> None:
        if left:
            left.pop()(executor)

    return going


def _is_over(future: Any) -> bool:
    return bool(future.done() or future.cancelled())
