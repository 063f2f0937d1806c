"""Pass calls of operations from the program to the robot and back.

Every call of an operation takes it, mutated or not, plain or async. ``Dispatcher.handler`` separates the
calls that count from all others; ``Dispatcher.dispatch`` has the phases of the way in their order. It is a
coroutine function, as an operator's middleware is, so that one text serves plain and async calls: of a plain
one nothing ever suspends.
"""

from __future__ import annotations

import inspect
import sys
from collections import Counter
from collections.abc import Callable, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import partial
from sys import _getframe
from types import CodeType, FrameType, FunctionType, MethodType
from typing import TYPE_CHECKING, Any

from mutabot.extensions import packages
from mutabot.model import Call, Reply, Role, Span
from mutabot.model.activation import Activation, Key
from mutabot.model.data import is_mock
from mutabot.model.operation import Form
from mutabot.model.quantity import Value
from mutabot.operators.middleware import Carried, run
from mutabot.runtime.interception.active_mutant import MutatedSite, RefusedCalls
from mutabot.runtime.interception.adapter import Adapter, Caller, Invocation, SiteCall
from mutabot.runtime.interception.coroutines import (
    ASYNC_MOCK,
    called,
    named_as,
    noted,
    noting,
    runs_when_awaited,
)  # fmt: skip
from mutabot.runtime.interception.frames import ModuleCache, border, borders, from_here
from mutabot.runtime.interception.live import is_live
from mutabot.runtime.interception.trace import Locator, Recorder
from mutabot.runtime.meter import Meter
from mutabot.runtime.observation.clock import Instances
from mutabot.runtime.observation.probes import Along
from mutabot.runtime.targets.target import NOWHERE, CallPlace, Handler, Where
from mutabot.runtime.targets.wrapper import bound

if TYPE_CHECKING:  # processes below the tests do not fork mutants
    from mutabot.runtime.program_text.returns import Returns

#: what runs in this context: the program, what an operation does or has begun, or neither
_PROGRAM, _OPERATION, _UNTRACKED = 0, 1, 2
_runs: ContextVar[int] = ContextVar("mutabot_runs", default=_PROGRAM)
#: what a call gives that is none of those that an operation describes
_ALONE = object()


def is_untracked() -> bool:
    """Return whether calls in this context are not attributed to the program."""
    return _runs.get() == _UNTRACKED


class Untracked:
    """Context in which calls are not attributed to the program, in this thread alone.

    A simulator enters it at every step, so it is no generator.

    Args:
        returns: what notes returned values notes none meanwhile; None for what other threads return.
    """

    __slots__ = ("_returns", "_token", "_was")

    def __init__(self, returns: Returns | None) -> None:
        self._returns = returns

    def __enter__(self) -> None:
        self._token = _runs.set(_UNTRACKED)
        if self._returns is not None:
            self._was, self._returns.is_on = self._returns.is_on, False

    def __exit__(self, *error: object) -> None:
        _runs.reset(self._token)
        if self._returns is not None:
            self._returns.is_on = self._was


@dataclass(slots=True, eq=False)
class Dispatcher:
    """Carries out each intercepted call of an operation.

    Attributes:
        locator: finds the site of a frame; None for calls that are neither the program's nor the oracle's.
        recorder: traces the calls.
        instances: notes which objects are used.
        along: reads probes along the way.
        on_error: called for each unmutated call that raised, after it raised.
        on_end: called for each call that is over, with what it read; None if not wanted.
        turn: asked before each call, in a process that does not see its tests begin; None in all others.
        meter: what the running test has used; None between tests: then nothing is noted.
        on_reach: called before each call is made, with its key, and by its number among those of its site;
            None if not wanted.
        oracle_nodes: names of nodes whose calls are the oracle's, wherever they stand.
        mutant: the mutant of calls that is at work; None for the original, and for other mutants.
        on_live: called in the baseline for each call that returned the robot's own memory; None in other
            runs.
        refused: the calls of the running test that the robot refuses in the original.
        given: where functions of the robot were handed on, for calls that no frame shows.
        calls: how often each site has been called in the running test, by operation and pattern.
        unmeant: where a callable was called that is an operation, but for none of its commands; noted only
            in the baseline.
        ours: the packages whose frames lie between the program's call and the handler.
    """

    locator: Locator
    recorder: Recorder
    instances: Instances
    along: Along
    on_error: Callable[[BaseException, SiteCall], None]
    on_end: Callable[[Call, Mapping[str, Value]], None] | None = None
    turn: Callable[[], None] | None = None
    meter: Meter | None = None
    on_reach: Callable[[Key, int], None] | None = None
    mutant: MutatedSite | None = None
    oracle_nodes: tuple[str, ...] = ()
    on_live: Callable[[SiteCall], None] | None = None
    refused: RefusedCalls = field(default_factory=RefusedCalls)
    given: dict[Adapter, CallPlace | None] = field(default_factory=dict)
    calls: Counter[tuple[Span, str, str | None]] = field(default_factory=Counter)
    unmeant: set[Span] = field(default_factory=set)
    ours: frozenset[str] = field(default_factory=packages)

    def handler(self, adapter: Adapter) -> Handler:
        """Return the handler for an operation."""
        named = adapter.operation.named
        # how many ticks and sleeps of a rate there are is a matter of time
        is_counted = named is None or named.form not in (Form.TICK, Form.SLEEP)

        def alone(wrapped: Any, instance: Any, args: Any, kwargs: Any, where: Where) -> Any:
            """Make a call without interception, except by its guard."""
            __tracebackhide__ = True
            if adapter.guard is not None:
                adapter.guard.check(Invocation(bound(wrapped, instance), instance, args, kwargs, where))
            return wrapped(*args, **kwargs)

        def handle(wrapped: Any, instance: Any, args: Any, kwargs: Any, where: Where = NOWHERE) -> Any:
            __tracebackhide__ = True
            try:
                if self.turn is not None:
                    self.turn()
                if self.meter is None:
                    return alone(wrapped, instance, args, kwargs, where)
                if instance is not None and self.instances.is_watching:
                    self.instances.used(instance)
                runs = _runs.get()
                if runs == _UNTRACKED:
                    return alone(wrapped, instance, args, kwargs, where)
                frame: Any = _getframe(1)
                site = where.site or self._site(frame, where, adapter, runs == _OPERATION)
                if runs and site is None:
                    return alone(wrapped, instance, args, kwargs, where)
                if is_counted and not where.is_again:
                    self.meter.operations += 1
                if site is None:
                    return alone(wrapped, instance, args, kwargs, where)
                is_direct = self.recorder.answers is not None and self._is_direct(frame, where)
                wrapped = bound(wrapped, instance)
                is_async = is_coroutine_function(wrapped) or where.is_awaited
                acts_at_once = is_async and not runs_when_awaited(wrapped)
                caller = caller_of(where.frame or frame, is_async and not acts_at_once)
                if acts_at_once:
                    caller = noting(caller)
                invocation: Any = Invocation(wrapped, instance, args, kwargs, where, caller)
                if is_async:  # only what is begun is reported, and by its name, if it is never awaited
                    begin: Any = partial(self.dispatch, adapter, site, invocation, is_async, is_direct)
                    waiting: Any = _awaited(begin, invocation, acts_at_once)
                    return named_as(wrapped, called(waiting, _runs) if acts_at_once else waiting)
                on_its_way: Any = self.dispatch(adapter, site, invocation, is_async, is_direct)
                operator = self.mutant.mutant.operator if self.mutant is not None else ""
                result = run(on_its_way, operator=operator)
                return wrapped(*args, **kwargs) if result is _ALONE else result
            except BaseException as error:
                # who keeps the exception keeps this frame
                wrapped = instance = args = kwargs = frame = invocation = begin = waiting = on_its_way = None
                where = NOWHERE
                error.__traceback__ = from_here(error)
                raise

        return handle

    def _site(self, frame: FrameType, where: Where, adapter: Adapter, in_operation: bool) -> CallPlace | None:
        node, code, locator = where.node, where.code, self.locator
        if code is None:
            site = locator.locate(frame, in_operation=in_operation)
        else:
            site = locator.locate_definition(code)
        if (
            site is not None
            and node is not None
            and any(fnmatchcase(node, pattern) for pattern in self.oracle_nodes)
        ):
            return site[0], Role.ORACLE
        if site is None and code is None:  # in a thread, or in an operation: no frame shows it
            site = where.handed or self._given(frame, adapter, in_operation)
        return site

    def _given(self, frame: FrameType, adapter: Adapter, in_operation: bool) -> CallPlace | None:
        """Return the place where a robot's function was passed on; None if it was called by its name."""
        is_named = adapter.operation.last_name in frame.f_code.co_names
        return None if in_operation and is_named else self.given.get(adapter)

    def _is_direct(self, frame: FrameType | None, where: Where) -> bool:
        """Return whether the program itself makes the call, rather than a library that it calls."""
        if where.code is not None or where.site is not None:
            return where.code is None
        while frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] in self.ours:
            frame = frame.f_back
        return frame is not None and self.locator.locate_definition(frame.f_code) is not None

    @border
    async def dispatch(
        self, adapter: Adapter, site: CallPlace, invocation: Invocation, is_async: bool, is_direct: bool
    ) -> Any:
        """Carry out one call of an operation, and record it.

        Args:
            adapter: its operation's.
            site: where it stands.
            invocation: the call as Python made it.
            is_async: whether what the operation returns is to be awaited.
            is_direct: whether the call that stands there is that of the operation itself.

        Returns what the program receives, or ``_ALONE`` if nothing is to stand around the call.
        """
        __tracebackhide__ = True
        token = _runs.set(_OPERATION)
        reply: Reply | None = None
        clock, around = self.recorder.clock, self.recorder.began
        began = self.recorder.began = clock() if clock is not None else None
        try:
            # 1. The adapter reads which command it is, and the values it writes.
            call = adapter.to_call(invocation)
            if call.pattern is None and adapter.operation.is_partial:  # none of the calls that are meant
                if self.recorder.answers is not None:
                    self.unmeant.add(site[0])
                if invocation.values is None and adapter.operation.signature is not None:  # or not known
                    return (await self._perform(adapter, SiteCall(site, call, 0, is_async))).payload
                if adapter.guard is not None:
                    adapter.guard.check(invocation)
                return _ALONE
            key = (site[0], call.operation.target, call.pattern.text if call.pattern is not None else None)
            self.calls[key] = number = self.calls[key] + 1
            stands_in = invocation.where.stands_in and self.recorder.answers is not None
            made = SiteCall(site, call, number, is_async, is_direct, stands_in)
            try:
                # 2. A fork parent forks for each mutant that differs from here on, and goes on as the
                #    original; a fork comes back from here as its mutant.
                if self.on_reach is not None:
                    self.on_reach(Activation.at_call(*key), made.number)
                # 3. The robot does what the program says, or what a mutant at this site makes of it.
                mutant = self.mutant
                hits = mutant.activity.hits if mutant is not None else 0
                if mutant is not None and mutant.is_here(site, call):
                    result, reply = await mutant.apply(adapter, made)
                else:
                    if mutant is not None:
                        mutant.passed_by(call)
                    reply = await self._perform(adapter, made)
                    result = reply.payload
                if mutant is not None and call.is_command and site[1] is Role.PROGRAM:
                    await mutant.catch_up(is_async, hits)
                # 4. The program receives the result.
                return result
            finally:
                # 5. Whatever came of it is noted.
                self._note(made, reply, began)
                self.recorder.began = around
        finally:
            try:  # noqa: SIM105  # quicker than a context manager, at every call
                _runs.reset(token)
            except ValueError:  # a coroutine that was given up is closed from elsewhere
                pass

    async def _perform(self, adapter: Adapter, made: SiteCall) -> Reply:
        """Make the call unchanged."""
        __tracebackhide__ = True
        call = made.call
        self.refused.begins(made)
        try:
            result = adapter.perform(call, None)
            if made.is_async:
                result = await result
        except BaseException as error:
            self.on_error(error, made)
            if isinstance(error, StopIteration):
                raise Carried(error) from None
            raise
        if self.on_live is not None:
            meant = call.pattern or adapter.operation
            if meant.result and is_live(result, meant.result):
                self.on_live(made)
        self.refused.returned(made, result)
        return adapter.to_reply(call, result)

    def _note(self, made: SiteCall, reply: Reply | None, began: float | None) -> None:
        """Record a call that has ended; ``reply`` is the robot's last reply, None if the call raised."""
        self.recorder.record(made, reply, began)
        if made.call.is_command and self.along.step:
            self.along.after(len(self.recorder.trace))
        if self.on_end is not None:
            self.on_end(made.call, reply.values if reply is not None else {})


async def _awaited(begin: Any, invocation: Any, acts_at_once: bool) -> Any:
    """Make a call, or make it as if it had no handler."""
    __tracebackhide__ = True
    try:
        result = await begin()
        if result is not _ALONE:
            return result
        given = invocation.wrapped(*invocation.args, **invocation.kwargs)
        return await (noted(given) if acts_at_once else given)
    except BaseException as error:
        begin = invocation = None
        error.__traceback__ = from_here(error)
        raise


def is_coroutine_function(wrapped: Callable[..., Any]) -> bool:
    """Return whether the result of a call has to be awaited; mocks and callable objects included."""
    function = wrapped.__func__ if type(wrapped) is MethodType else wrapped
    if type(function) is FunctionType and not function.__dict__:  # the most of them
        return bool(function.__code__.co_flags & inspect.CO_COROUTINE)
    if is_mock(function):  # to ask it for its flags would count as calls
        return is_mock(function, ASYNC_MOCK)
    if inspect.iscoroutinefunction(wrapped) or inspect.iscoroutinefunction(type(wrapped).__call__):
        return True
    coroutines = sys.modules.get("asyncio.coroutines")
    return coroutines is not None and bool(coroutines.iscoroutinefunction(wrapped))


def _call(wrapped: Any, args: Any, kwargs: Any, __tracebackhide__: bool = True) -> Any:
    return wrapped(*args, **kwargs)


async def _async_call(wrapped: Any, args: Any, kwargs: Any, __tracebackhide__: bool = True) -> Any:
    return await wrapped(*args, **kwargs)


#: code of callers by code, instruction and whether they await. The latter code is kept, so that no other can
#: get its address
_codes: dict[tuple[int, int, bool], tuple[CodeType, CodeType]] = {}
#: callers likewise, with the global names that they have
_callers: ModuleCache[tuple[int, int, bool], tuple[Caller, dict[str, Any]]] = ModuleCache()


def caller_of(frame: FrameType, is_async: bool) -> Caller:
    """Return the frame of a caller, with its current position.

    Warnings with ``stacklevel=2``, ``sys._getframe(1)`` and ``inspect.stack()[1]`` show by whom a function
    was called. Between the program and an operation there are frames of ours; the last of them has the
    program's file, line, function and global names.
    """
    code, names = frame.f_code, frame.f_globals
    key = (id(code), frame.f_lasti, is_async)
    known = _callers.known.get(key)
    if known is None or known[1] is not names:
        if key not in _codes:
            _codes[key] = (_made(code, frame.f_lasti, is_async), code)
        made = FunctionType(_codes[key][0], names, code.co_name, (True,))
        known = _callers.keep(names, key, (made, names))
    return known[0]


def _made(code: CodeType, instruction: int, is_async: bool) -> CodeType:
    line = list(code.co_positions())[instruction // 2][0] or code.co_firstlineno
    own = (_async_call if is_async else _call).__code__
    made = own.replace(
        co_name=code.co_name,
        co_qualname=code.co_qualname,
        co_filename=code.co_filename,
        co_firstlineno=code.co_firstlineno,
        co_linetable=_all_in_line(line - code.co_firstlineno, len(own.co_code) // 2),
    )
    borders[id(made)] = made
    return made


def _all_in_line(line: int, units: int) -> bytes:
    """Return a line table that gives all of a code this line, counted from its first, and no columns.

    An entry covers up to eight code units. The format: CPython, Objects/locations.md (3.11 to 3.13). To
    compile a tree takes ten times as long, and every fork calls from places where nothing has called before.
    """
    no_columns, table = 13, bytearray()
    for first in range(0, units, 8):
        table.append(1 << 7 | no_columns << 3 | min(8, units - first) - 1)
        number = (line if first == 0 else 0) << 1  # from the entry before; the lowest bit is its sign
        if number < 0:
            number = -number | 1
        while number >= 64:
            table.append(64 | number & 63)
            number >>= 6
        table.append(number)
    return bytes(table)
