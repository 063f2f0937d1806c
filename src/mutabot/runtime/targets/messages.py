"""Targets that have a name on a middleware: topics, services, actions, parameters.

What stands around each use are hooks that packages bring (``target.Middleware``). They are put in place as
soon as the program imports the client library of a middleware, and not imported before.

Giving the program what comes by itself, as a mutant would have it: late, several times, or not at all.

Around a message that comes by itself (``model.operation.COMING``) a handler may return a ``Delivery``. The
hooks of all middlewares leave it to the two functions here: ``deliver`` where a callback of the program is
called, ``wait_for`` where the program waits.
"""

from __future__ import annotations

import inspect
import sys
import time
from collections.abc import Awaitable, Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from difflib import SequenceMatcher
from functools import partial
from typing import Any

import wrapt

from mutabot.errors import ExtensionError
from mutabot.extensions import ExtensionPart, brought
from mutabot.frozen import frozen
from mutabot.model import Operation
from mutabot.model.operation import Form, Named, Refused, named_of
from mutabot.runtime.targets.target import (
    Finding,
    Handler,
    Middleware,
    MiddlewareControls,
    Tell,
    TypedMiddleware,
    Where,
)

#: of the forms that vocabularies speak of: what did not happen under a name, and what is set up for it
_FORMS: dict[Form, tuple[str, Form | None]] = {
    Form.PUBLISH: ("no test published {}", Form.ADVERTISE),
    Form.RECEIVE: ("no test received anything on {}", Form.SUBSCRIBE),
    Form.CALL: ("no test called the service {}", Form.CLIENT),
    Form.GOAL: ("no test sent a goal to {}", Form.CLIENT),
    Form.PARAMETER: ("no test read the parameter {}", None),
    Form.TICK: ("no test was called back by a timer as {}", Form.TIMER),
    Form.SLEEP: ("no test slept by a rate in {}", Form.RATE),
    Form.TRANSFORM: ("no test looked up the transform {}", None),
}
#: forms by which a process hears what is said under a name
_LISTENING = (Form.RECEIVE, Form.SUBSCRIBE, Form.GOAL, Form.CLIENT, Form.RESULT)
#: names that are told
_MOST = 4


class Messages:
    """The handlers of all operations that have a name.

    Args:
        tell: told about a target that turns out wrong when it is found.

    Attributes:
        used: what was done under which names, in this process and those below the tests.
        on_heard: told of each message that passes under a name; None if nobody asks.
    """

    def __init__(self, tell: Tell) -> None:
        self._tell = tell
        self.on_heard: Callable[[str, Any], None] | None = None
        self._handlers: list[tuple[Named, Handler]] = []
        self._found: dict[tuple[Form, str, str | None], Handler | None] = {}
        self._undo: list[Callable[[], None]] = []
        self._removed = False
        self._here: set[str] = set()
        self.used: set[Named] = set()
        for part in brought("middlewares").values():
            wrapt.register_post_import_hook(partial(self._hook, part), part.name)

    def wrap(self, target: str, handler: Handler) -> None:
        """Let a handler stand around what is done under a name; nothing is ever put in its place."""
        self._handlers.append((Named.of(target), handler))
        self._found.clear()

    def find(self, form: Form, name: str, node: str | None) -> Handler | None:
        """The handler for what is done in a node under a resolved name; None if the vocabulary names none.

        The first operation that fits, in the order of the vocabulary.
        """
        key = (form, name, node)
        try:
            return self._found[key]
        except KeyError:
            self._note(Named(form, name, node))
            fitting = (handler for named, handler in self._handlers if named.fits(form, name, node))
            found = self._found[key] = None if self._removed else next(fitting, None)
            return found

    def heard(self, name: str, message: Any) -> None:
        """A message passed under a resolved name, as it is in truth; see ``target.Names``."""
        if self.on_heard is not None:
            self.on_heard(name, message)

    def remove(self) -> None:
        """Take all hooks away."""
        self._removed = True
        self._found.clear()
        self._handlers.clear()
        while self._undo:
            self._undo.pop()()

    def seek(self) -> Iterator[tuple[str, Finding]]:
        """Names come and go with the nodes: what was never used is all that can be said."""
        return unused([named for named, _ in self._handlers], self.used)

    def unheard(self, operation: Operation) -> Iterator[Finding]:
        """Topics and actions that no process of the tests listens to."""
        return unheard(operation.told_as_refused, self.used)

    def here(self) -> Iterable[str]:
        """What was done under which names, and the targets that these are."""
        return tuple(self._here)  # at once: another thread may come by under a new name

    def found_elsewhere(self, targets: Iterable[str]) -> None:
        """A process below the tests did this."""
        self.used.update(named for target in targets if (named := named_of(target)) is not None)

    def check(self, operation: Operation) -> Iterator[Finding]:
        """What of an operation does not fit the installed definition of its type."""
        for part in brought("middlewares").values() if operation.named is not None else ():
            middleware = part.load() if part.name in sys.modules else None
            if isinstance(middleware, TypedMiddleware):
                yield from middleware.check(operation)

    def _note(self, used: Named) -> None:
        self.used.add(used)
        self._here.add(used.target)
        for named, _ in self._handlers:
            if named.fits(used.form, used.name, used.node):
                self._here.add(named.target)

    def _hook(self, part: ExtensionPart, _: object) -> None:
        """The program has imported a client library."""
        if self._removed:
            return
        try:
            middleware: Middleware = part.load()
        except ExtensionError as error:  # the program might catch it
            for named, _handler in self._handlers:
                self._tell(named.target, Finding(named.form.value, str(error)))
            raise
        self._undo.append(middleware.hook(self))


def unused(wanted: Collection[Named], used: Collection[Named]) -> Iterator[tuple[str, Finding]]:
    """Tell of each operation of the vocabulary that was never used, with what was used instead."""
    for named in wanted:
        if named.form not in _FORMS or any(named.fits(one.form, one.name, one.node) for one in used):
            continue
        where = f" in a node {named.node}" if named.node is not None else ""
        sentence = f"{_FORMS[named.form][0].format(named.name)}{where}; {_instead(named, used)}"
        yield named.target, Finding(named.form.value, sentence, is_remark=True)


def unheard(refused: Collection[Refused], used: Collection[Named]) -> Iterator[Finding]:
    """Tell of names under which the vocabulary expects refusals, and nothing listens."""
    for name in dict.fromkeys(one.topic for one in refused if one.topic is not None):
        wanted = [Named(form, name) for form in _LISTENING]
        if any(one.fits(other.form, other.name, other.node) for one in wanted for other in used):
            continue
        instead = _instead(Named(Form.RECEIVE, name), used)
        sentence = f"no node listens to {name}, so that no refusal told there is seen; {instead}"
        yield Finding("refused", sentence, is_remark=True)


def _instead(named: Named, used: Collection[Named]) -> str:
    """Say what was used or set up for the same, nearest first."""
    wanted = (_FORMS[named.form][1], named.form)  # of one name, what was done is told, not what was set up
    told = sorted((wanted.index(one.form), one.target, one.name) for one in used if one.form in wanted)
    alike = {name: target for _, target, name in told}
    if not alike:
        known = f"; middlewares that are known here: {', '.join(brought('middlewares')) or 'none'}"
        return f"nothing of that kind was seen under any name{'' if used else known}"
    likeness = {name: SequenceMatcher(None, name, named.name).ratio() for name in alike}
    targets = [alike[name] for name in sorted(alike, key=lambda name: (-likeness[name], name))]
    more = f" and {len(targets) - _MOST} more" if len(targets) > _MOST else ""
    return f"seen: {', '.join(targets[:_MOST])}{more}"


#: seconds of wall clock: a topic that keeps its last message gives it at once to who asks again and again
_PAUSE = 0.01


@frozen
class Delivery:
    """What the program is to receive in the place of one message.

    Attributes:
        parts: seconds by which each comes later, and the message; none if it is lost.
    """

    parts: tuple[tuple[float, Any], ...] = ()


def deliver(handler: Handler, message: Any, callback: Callable[[Any], Any], where: Where) -> Any:
    """Call the program's callback with a message, or with whatever the handler makes of it.

    Returns what the callback returns: a coroutine if it is a coroutine function. A message that is lost calls
    nothing and returns None; one that is late calls it from ``where.means.later``.
    """
    received = handler(lambda: message, None, (), {}, where)
    if not isinstance(received, Delivery):
        return callback(received)
    returned = []
    for late, part in received.parts:
        if late:
            _means(where).later(late, partial(callback, part))
        else:
            returned.append(callback(part))
    if any(inspect.isawaitable(one) for one in returned):
        return _in_turn(returned)
    return returned[-1] if returned else None


def wait_for(handler: Handler, wait: Callable[[], Any], where: Where) -> Any:
    """What a program receives that waits for one message; ``wait`` waits for the next and returns it.

    A message that is lost is waited past, so ``wait`` may be called again: it keeps the time-out of the
    whole, and raises what the program is to see when that is over. Who has a message waits no more, and the
    next wait subscribes anew: a mutant can let nothing come after it (``MiddlewareControls.once``).
    """
    where = replace(where, means=replace(_means(where), once=True))
    while True:
        received = handler(wait, None, (), {}, where)
        if not isinstance(received, Delivery):
            return received
        for late, part in received.parts:
            if late:
                _done(_means(where).sleep(late))
            return part
        where = replace(where, is_again=True)
        time.sleep(_PAUSE)


def anew(wait: Callable[[], Any], is_kept: Callable[[Any], bool]) -> Callable[[], Any]:
    """Wait for a message that no wait before has brought.

    Each wait subscribes anew, and so gets once more what is kept for late subscribers: a node that had lost
    it would not. ``is_kept`` says whether a message is of that kind.
    """
    last: list[Any] = []

    def wait_for_another() -> Any:
        while True:
            message = wait()
            if not last or not is_kept(message) or message != last[0]:
                last[:] = [message]
                return message
            time.sleep(_PAUSE)

    return wait_for_another


def _means(where: Where) -> MiddlewareControls:
    return where.means if where.means is not None else MiddlewareControls()


def _done(awaitable: Awaitable[None]) -> None:
    """Await what does not suspend."""
    for _ in awaitable.__await__():
        raise RuntimeError("the sleep of a plain call suspends; it must block")


async def _in_turn(returned: Sequence[Any]) -> Any:
    last = None
    for one in returned:
        last = await one if inspect.isawaitable(one) else one
    return last
