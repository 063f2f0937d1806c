"""Coroutines that stand for those of the robot: their names, and what happens before they are awaited.

A coroutine function does nothing until its coroutine is awaited. A mock of one notes the call at once, and a
decorator may do anything: such a call is made when the program makes it, and only what it gave is awaited.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Coroutine, Generator
from contextvars import ContextVar
from types import FunctionType, coroutine
from typing import TYPE_CHECKING, Any

from mutabot.model.data import is_mock
from mutabot.runtime.interception.frames import from_here
from mutabot.runtime.targets.wrapper import unbound

if TYPE_CHECKING:
    from mutabot.runtime.interception.adapter import Caller

#: the class of mocks of coroutine functions, and what runs when one is called
ASYNC_MOCK, _MOCKS_CALL = "AsyncMockMixin", "_execute_mock_call"
#: what a call gives to whom begins it, when it has been made
_CALLED = object()


def runs_when_awaited(wrapped: Callable[..., Any]) -> bool:
    """Return whether a call does nothing before its result is awaited."""
    function = unbound(wrapped)
    function = function if type(function) is FunctionType else type(function).__call__
    return bool(getattr(getattr(function, "__code__", None), "co_flags", 0) & inspect.CO_COROUTINE)


def named_as(wrapped: Callable[..., Any], waiting: Any) -> Any:
    """Give a coroutine the name of what the callable returns: Python and tests refer to it by that."""
    function = unbound(wrapped)
    is_function = type(function) is FunctionType
    if is_mock(getattr(function, "mock", None) if is_function else function, ASYNC_MOCK):
        waiting.__name__, waiting.__qualname__ = _MOCKS_CALL, f"{ASYNC_MOCK}.{_MOCKS_CALL}"
    elif is_function:
        waiting.__name__, waiting.__qualname__ = function.__name__, function.__qualname__
    return waiting


def noting(caller: Caller) -> Caller:
    """Return a caller whose first call suspends between the call and awaiting what it gave."""
    calls = [noted]

    def noting_caller(wrapped: Any, args: Any, kwargs: Any) -> Any:
        given = caller(wrapped, args, kwargs)
        return calls.pop()(given) if calls else given

    return noting_caller


def called(waiting: Coroutine[Any, Any, Any], runs: ContextVar[int]) -> Coroutine[Any, Any, Any]:
    """Run a coroutine to where the call has been made, and return one that goes on when it is awaited.

    ``runs`` keeps its value.
    """
    before = runs.get()
    try:
        first = waiting.send(None)
    except StopIteration as end:
        return _given(end.value)
    finally:
        runs.set(before)
    return _going_on(_rest(waiting, first))


async def noted(given: Any) -> Any:
    """Await what a call gave, but suspend before."""
    try:
        await _pause()
    except GeneratorExit:
        if inspect.iscoroutine(given):
            given.close()
        raise
    return await given


@coroutine
def _pause() -> Generator[Any, None, None]:
    yield _CALLED


@coroutine
def _rest(waiting: Coroutine[Any, Any, Any], first: Any) -> Generator[Any, Any, Any]:
    if first is not _CALLED:  # it waits for something before the call
        yield first
    return (yield from waiting.__await__())


async def _going_on(rest: Any) -> Any:
    __tracebackhide__ = True
    try:
        return await rest
    except BaseException as error:
        rest = None
        error.__traceback__ = from_here(error)
        raise


async def _given(result: Any) -> Any:
    return result
