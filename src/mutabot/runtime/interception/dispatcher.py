"""The way of a call: from the program to the robot, and back.

Every call of an operation goes it, mutated or not, plain or async. ``Passing.handler`` tells the calls
that count from all others; ``Passing._pass`` has the phases of the way in their order. It is a coroutine
function, as an operator's middleware is, so that one text serves plain and async calls: of a plain one
nothing ever suspends.
"""

from __future__ import annotations

import inspect
import sys
from collections import Counter
from collections.abc import Callable, Mapping
from contextvars import ContextVar
from fnmatch import fnmatchcase
from types import CodeType, FrameType, FunctionType, MethodType, TracebackType
from typing import TYPE_CHECKING, Any, Protocol, cast

import wrapt

from mutabot.extensions import packages
from mutabot.model import Call, Reply, Role, Span
from mutabot.model.operation import Form
from mutabot.model.quantity import Value
from mutabot.operators.passage import Carried, run
from mutabot.runtime.evidence import Meter
from mutabot.runtime.interception.active_mutant import Activation, is_live
from mutabot.runtime.interception.adapter import Callers, Door, Returned, here
from mutabot.runtime.interception.refusals import Made, RefusedCalls
from mutabot.runtime.interception.trace import Recorder
from mutabot.runtime.observation.instances import Instances
from mutabot.runtime.observation.probes import Along
from mutabot.runtime.targets.target import Handler, Where

if TYPE_CHECKING:  # processes below the tests fork for nobody
    from mutabot.runtime.isolation.fork_parent import ForkParent

#: whether an operation is already under way here: only the outermost is a site
_under_way: ContextVar[bool] = ContextVar("mutabot_operation_under_way", default=False)
is_under_way = _under_way.get


class _Noting(Protocol):
    is_on: bool


class Aside:
    """Calls of operations in this context, and in this thread alone, are none of the program's.

    A simulator enters it at every step, so it is no generator.

    Args:
        returns: what notes returned values notes none meanwhile; None for what other threads return.
    """

    __slots__ = ("_returns", "_token", "_was")

    def __init__(self, returns: _Noting | None) -> None:
        self._returns = returns

    def __enter__(self) -> None:
        self._token = _under_way.set(True)
        if self._returns is not None:
            self._was, self._returns.is_on = self._returns.is_on, False

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        _under_way.reset(self._token)
        if self._returns is not None:
            self._returns.is_on = self._was


class Passing:
    """What stands on the way of a session's calls.

    Args:
        locate: finds the site of a frame; None for calls that are neither the program's nor the oracle's.
        recorder: traces the calls.
        instances: notes which objects are used.
        along: reads probes along the way.
        on_error: told of each unmutated call that raised, after what it raised.
        locate_definition: finds the site of a function that is called back; None likewise.

    Attributes:
        on_end: told of each call that is over, with what it read; None if nobody asks.
        turn: asked before each call, in a process that does not see its tests begin; None in all others.
        meter: what the running test has used; None between tests: then nothing is noted.
        fork_parent: set while this process runs the original and forks for each mutant.
        oracle_nodes: names of nodes whose calls are the oracle's, wherever they stand.
        activations: the mutants of calls that are at work: none for the original.
        on_live: told in the baseline of each call that returned the robot's own memory; None in other runs.
        refused: the calls of the running test that the robot refuses in the original.
        given: where functions of the robot were handed on, for calls that no frame tells of.
        calls: how often each site has been called in the running test, by operation and pattern.
    """

    def __init__(
        self,
        locate: Callable[[FrameType | None], tuple[Span, Role] | None],
        recorder: Recorder,
        instances: Instances,
        along: Along,
        on_error: Callable[[BaseException, Made], None],
        on_end: Callable[[Call, Mapping[str, Value]], None] | None = None,
        locate_definition: Callable[[CodeType], tuple[Span, Role] | None] = lambda code: None,
    ) -> None:
        self._locate = locate
        self._locate_definition = locate_definition
        self._recorder = recorder
        self._instances = instances
        self._along = along
        self._on_error = on_error
        self.on_end = on_end
        self.turn: Callable[[], None] | None = None
        self.meter: Meter | None = None
        self.fork_parent: ForkParent | None = None
        self.activations: list[Activation] = []
        self.oracle_nodes: tuple[str, ...] = ()
        self._operator = ""
        self.on_live: Callable[[Made], None] | None = None
        self.refused = RefusedCalls()
        self.given: dict[Door, tuple[Span, Role] | None] = {}
        self._callers = Callers()
        self.calls: Counter[tuple[Span, str, str | None]] = Counter()

    def activate(self, activation: Activation) -> None:
        """Let a mutant be at work from now on."""
        self.activations.append(activation)
        self._operator = " and ".join(one.mutant.operator for one in self.activations)

    def handler(self, door: Door) -> Handler:
        """What stands around an operation."""

        def handle(
            wrapped: Callable[..., Any],
            instance: Any,
            args: tuple[Any, ...],
            kwargs: dict[str, Any],
            where: Where | None = None,
        ) -> Any:
            __tracebackhide__ = True
            if self.turn is not None:
                self.turn()
            if self.meter is None:
                return wrapped(*args, **kwargs)
            if instance is not None and not self._instances.is_idle:
                self._instances.used(instance)
            if _under_way.get():
                return wrapped(*args, **kwargs)
            if (where is None or not where.is_again) and not _marks_time(door):
                self.meter.count()
            site = self._site(sys._getframe(1), where, door)
            if site is None:
                return wrapped(*args, **kwargs)
            is_direct = self._recorder.answers is not None and self._is_direct(sys._getframe(1), where)
            wrapped = _bound(wrapped, instance)
            is_async = is_coroutine_function(wrapped) or (where is not None and where.is_awaited)
            means = where.means if where is not None else None
            receiver, frame = (where.receiver, where.frame) if where is not None else (None, None)
            caller = self._callers.of(frame or sys._getframe(1), is_async)
            made = (wrapped, instance, args, kwargs, means, receiver, caller)
            on_its_way = self._pass(door, site, is_direct, is_async, *made)
            if is_async:
                return on_its_way
            return run(on_its_way, operator=self._operator)

        return handle

    def _site(self, frame: FrameType, where: Where | None, door: Door) -> tuple[Span, Role] | None:
        if where is not None and where.site is not None:
            return where.site
        code = where.code if where is not None else None
        site = self._locate(frame) if code is None else self._locate_definition(code)
        node = where.node if where is not None else None
        if site is not None and node is not None and self._is_oracle(node):
            return site[0], Role.ORACLE
        if site is None and code is None:  # in a thread, where no frame tells it
            site = where.handed if where is not None else self.given.get(door)
        return site

    def _is_direct(self, frame: FrameType | None, where: Where | None) -> bool:
        """Whether the program itself makes the call, rather than a library that it calls."""
        if where is not None and (where.code is not None or where.site is not None):
            return where.code is None
        ours = packages()
        while frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] in ours:
            frame = frame.f_back
        return frame is not None and self._locate_definition(frame.f_code) is not None

    def _is_oracle(self, node: str) -> bool:
        return any(fnmatchcase(node, name) for name in self.oracle_nodes)

    async def _pass(
        self, door: Door, site: tuple[Span, Role], is_direct: bool, is_async: bool, *made: Any
    ) -> Any:
        """The phases of one call.

        Args:
            door: its operation's.
            site: where it stands.
            is_direct: whether the call that stands there is that of the operation itself.
            is_async: whether what the operation returns is to be awaited.
            made: the call as Python made it, and what can befall it: what the handler was given.
        """
        __tracebackhide__ = True
        token = _under_way.set(True)
        reply: Reply | None = None
        began = self._recorder.began = self._recorder.clock()
        try:
            # 1. The door reads which command it is, and the values it writes.
            call = door.call(*made)
            if call.pattern is None and door.operation.is_partial:  # none of the calls that are meant
                _under_way.reset(token)
                token = _under_way.set(False)
                return await self._leave_alone(is_async, made[0], made[2], made[3])
            try:
                # 2. A fork parent forks for each mutant that differs from here on, and goes on as the
                #    original; a fork comes back from here as its mutant.
                number = self._counted(site[0], call)
                if self.fork_parent is not None:
                    self.fork_parent.fork_at(site[0], call, number)
                # 3. The robot does what the program says, or what a mutant at this site makes of it.
                mutant = self._mutant_of(site, call)
                if mutant is None:
                    for activation in self.activations:
                        activation.passed_by(call)
                    reply = await self._perform(door, Made(site, call, number), is_async)
                    result = reply.payload
                else:
                    result, reply = await mutant.perform(door, call, is_async, number)
                if self.activations and call.is_command and site[1] is Role.PROGRAM:
                    for activation in self.activations:
                        await activation.catch_up(is_async)
                # 4. The program receives the result.
                return result
            finally:
                # 5. Whatever came of it is noted.
                self._note(site, call, reply, began, is_direct)
        finally:
            try:  # noqa: SIM105  # quicker than a context manager, at every call
                _under_way.reset(token)
            except ValueError:  # a coroutine that was given up is closed from elsewhere
                pass

    def _counted(self, span: Span, call: Call) -> int:
        """The number of a call among those of its site in the running test, from 1."""
        key = (span, call.operation.target, call.pattern.text if call.pattern is not None else None)
        self.calls[key] += 1
        return self.calls[key]

    async def _leave_alone(
        self,
        is_async: bool,
        wrapped: Callable[..., Any],
        args: tuple[Any, ...],
        kwargs: dict[str, Any],
    ) -> Any:
        """Make a call as if there were no handler around it."""
        __tracebackhide__ = True
        try:
            result = wrapped(*args, **kwargs)
            return await result if is_async else result
        except StopIteration as error:
            raise Carried(error) from None

    def _mutant_of(self, site: tuple[Span, Role], call: Call) -> Activation | None:
        """The mutant whose site and command it is."""
        for activation in self.activations:
            if activation.is_here(site, call.operation.target) and activation.fits(call):
                return activation
        return None

    async def _perform(self, door: Door, made: Made, is_async: bool) -> Reply:
        """Let the robot do what the program says."""
        __tracebackhide__ = True
        call = made.call
        self.refused.begins(made)
        try:
            result = door.perform(call, call)
            if is_async:
                result = await result
        except BaseException as error:
            self._on_error(error, made)
            if isinstance(error, StopIteration):
                raise Carried(error) from None
            raise
        if self.on_live is not None:
            meant = call.pattern or door.operation
            if meant.result and is_live(result, meant.result):
                self.on_live(made)
        self.refused.returned(made, result)
        return door.reply(call, result)

    def _note(
        self, site: tuple[Span, Role], call: Call, reply: Reply | None, began: float | None, is_direct: bool
    ) -> None:
        """Trace a call that is over; ``reply`` is the robot's last one, None if the call raised."""
        span, role = site
        pattern = call.pattern.text if call.pattern is not None else None
        read = reply.values if reply is not None else {}
        is_wanted = self._recorder.answers is not None and reply is not None
        returned = None
        if reply is not None and is_wanted:
            returned = Returned(reply.payload, here(call), _can_be_lost(call))
        self._recorder.hit(
            span,
            role,
            call.operation.target,
            pattern,
            call.values,
            read,
            returned,
            began,
            is_direct=is_direct,
        )
        if call.is_command:
            self._along.after(len(self._recorder.trace))
        if self.on_end is not None:
            self.on_end(call, read)


def _bound(wrapped: Callable[..., Any], instance: Any) -> Callable[..., Any]:
    """A method that is called through its class, bound: its arguments are then those of any other call."""
    if instance is None or not isinstance(wrapped, wrapt.PartialCallableObjectProxy):
        return wrapped
    function = getattr(wrapped, "__wrapped__")  # noqa: B009  # its stubs do not name it
    bind = getattr(type(function), "__get__", None)
    return wrapped if bind is None else cast("Callable[..., Any]", bind(function, instance, type(instance)))


def is_coroutine_function(wrapped: Callable[..., Any]) -> bool:
    """Whether what a call gives is to be awaited: also of mocks, and of objects that are called."""
    function = wrapped.__func__ if type(wrapped) is MethodType else wrapped
    if type(function) is FunctionType and not function.__dict__:  # the most of them
        return bool(function.__code__.co_flags & inspect.CO_COROUTINE)
    if inspect.iscoroutinefunction(wrapped) or inspect.iscoroutinefunction(type(wrapped).__call__):
        return True
    coroutines = sys.modules.get("asyncio.coroutines")
    return coroutines is not None and bool(coroutines.iscoroutinefunction(wrapped))


def _can_be_lost(call: Call) -> bool:
    """Whether it sends the goal of an action to a server that may never answer."""
    named, means = call.operation.named, call.payload.means
    is_goal = named is not None and named.form is Form.GOAL
    return is_goal and means is not None and means.lost is not None


def _marks_time(door: Door) -> bool:
    """Whether it is a tick or the sleep of a rate: how many there are is a matter of time."""
    named = door.operation.named
    return named is not None and named.form in (Form.TICK, Form.SLEEP)
