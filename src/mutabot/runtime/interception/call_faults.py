"""Faults of a call beside changed values: delay, cancellation, failure, and death of the process."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import replace
from functools import partial
from importlib import import_module
from typing import Any, NoReturn

from mutabot.model import Call, CallFault, Reply
from mutabot.model.clocks import sleep
from mutabot.model.operation import ANSWERED
from mutabot.runtime.interception.live import copied
from mutabot.runtime.targets.target import Delivery, MiddlewareControls, resolve

#: says to a process that it was begun anew, by its id, which stays the same
RESTARTED = "MUTABOT_RESTARTED"
_NO_SECOND = "who waits for one message hears no second"
_FOLDER = os.getcwd()
_SAYS = "no reading (planted by mutabot)"


def why_not(means: MiddlewareControls | None, call_fault: CallFault) -> str:
    """Return why a fault of the middleware cannot happen to a call here; empty if it can."""
    if means is None:
        return "it is not a call of a middleware"
    if call_fault is CallFault.CANCELLED and means.cancel is None:
        return "what it begins cannot be cancelled"
    if call_fault is CallFault.JUMPED and means.jump is None:
        return "the program's clock cannot be moved"
    if call_fault in (CallFault.KILLED, CallFault.RESTARTED):
        if means.end is None and not _is_node():
            return "the program runs in the tests' own process"
        if os.environ.get(RESTARTED) == str(os.getpid()):
            return "the process was begun anew already"
    return ""


async def before(call: Call, at_end: Callable[[], None]) -> None:
    """Apply the faults that come before a call; ``at_end`` is called before one ends this process."""
    means = _means(call)
    if CallFault.JUMPED in call.call_faults and means.jump is not None:
        means.jump(call.call_faults[CallFault.JUMPED])
    if CallFault.KILLED in call.call_faults or CallFault.RESTARTED in call.call_faults:
        at_end()
        anew = CallFault.RESTARTED in call.call_faults
        if anew:
            os.environ[RESTARTED] = str(os.getpid())
        if means.end is not None:
            means.end(anew)
        else:
            _end(anew=anew)
    if CallFault.LATE in call.call_faults and _is_answered(call):
        await means.sleep(call.call_faults[CallFault.LATE])


def perform(call: Call, action: Callable[[], Any]) -> Any:
    """Make a call now or later; calls that send without an answer are not waited for."""
    if CallFault.LATE not in call.call_faults or _is_answered(call):
        return action()
    return _means(call).goes_out(call.call_faults[CallFault.LATE], partial(_quietly, action))


async def after(call: Call, result: Any) -> None:
    """Apply the fault to the action that a call has started; ``result`` is the call's result."""
    cancel = _means(call).cancel if CallFault.CANCELLED in call.call_faults else None
    if cancel is not None:
        await cancel(result)


def received_part(call: Call, reply: Reply) -> Reply:
    """Return the part of a reply that the program receives; a wait for one message gets the first only."""
    means: MiddlewareControls | None = call.payload.where.means
    if means is None or not means.once or not reply.more:
        return reply
    first = replace(reply.parts[0], more=()) if reply.parts else reply
    return first.as_is(_NO_SECOND)


def hand_over(call: Call, reply: Reply, result: Callable[[Reply], Any]) -> Callable[[], Awaitable[Any]]:
    """Return how the program gets a missing or changed reply; ``result`` makes the program's object.

    Raises LookupError if the middleware has no way. The result raises what the middleware raises for an
    answer that never comes, and what the program gets instead of a reading.
    """
    if reply.error:
        return partial(_raised, missing(reply.error))
    means = _means(call)
    named = call.operation.named
    if named is not None and named.form.comes_by_itself:
        parts = [(part.late, result(part)) for part in reply.parts]
        # the program may change what it got, and would find that in what comes next
        return partial(_given, Delivery((*parts[:1], *((late, copied(later)) for late, later in parts[1:]))))
    if reply.lost and means.lost is None:
        raise LookupError(f"no way to lose the answer of {call.operation.name} is known")
    reply_value = None if reply.lost else result(reply)

    async def handed() -> Any:
        if reply.late:
            await means.sleep(reply.late)
        return await means.lost() if reply.lost and means.lost is not None else reply_value

    return handed


def missing(name: str) -> BaseException:
    """Return the exception (``module:Name``) that replaces a missing reading.

    Raises LookupError if there is none, or if it is no exception.
    """
    module, _, qualname = name.partition(":")
    try:
        kind: Any = resolve(import_module(module), qualname)[2]
    except (ImportError, LookupError) as error:
        raise LookupError(f"missing = {name!r} names nothing: {error}") from error
    if not (isinstance(kind, type) and issubclass(kind, BaseException)):
        raise LookupError(f"missing = {name!r} is not an exception; name one, such as 'camera:NoImageError'")
    for given in ((_SAYS,), ()):
        try:
            return kind(*given)
        except TypeError:  # it wants other arguments
            continue
    bare: BaseException = kind.__new__(kind)
    return bare


async def _raised(error: BaseException) -> NoReturn:
    raise error


async def _given(result: Any) -> Any:
    return result


def _means(call: Call) -> MiddlewareControls:
    means: MiddlewareControls | None = call.payload.where.means
    if means is None:
        raise LookupError(f"no fault of messages is known for {call.operation.name}")
    return means


def _is_answered(call: Call) -> bool:
    named = call.operation.named
    return named is None or named.form in ANSWERED


def _quietly(perform: Callable[[], Any]) -> None:
    """Ignore errors of a late call whose node may be gone."""
    with suppress(Exception):
        perform()


def _is_node() -> bool:
    """Return whether the tests started this process, rather than being run in it."""
    member = sys.modules.get("mutabot.runtime.processes.member")  # it stands on this module
    return member is not None and bool(member.is_member())


def _end(*, anew: bool) -> NoReturn:
    if anew:
        for stream in (sys.stdout, sys.stderr):
            with suppress(Exception):
                stream.flush()
        os.chdir(_FOLDER)
        os.execv(sys.executable, [sys.executable, *sys.orig_argv[1:]])
    os.kill(os.getpid(), signal.SIGKILL)
    while True:  # the signal is on its way
        sleep(1.0)
