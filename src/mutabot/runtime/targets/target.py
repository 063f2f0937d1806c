"""How an operation is found at run time, and the arguments of a handler around it.

A target is what an operation of the vocabulary names: a Python callable (``callables``), or a name on a
middleware (``messages``). Each of the two finds its targets in the running program, lets a handler stand
around each, takes it away again, and says what does not fit. Of methods of whatever object has them nothing
is wrapped: their calls are seen where they are written (``program_text``).

Whatever the kind, a handler sees each use of its target as a call: the callable that does what the target
stands for, the object it belongs to or None, and the arguments by position and name.

The contract of a middleware: what a package brings so that operations can be names on it.

Topics, services, actions and parameters have names that are known only when they are used, after remapping
and namespaces. So a package puts hooks into the client library of its middleware, and at each use they ask
``names.find(form, name, node)`` and let the handler that they get stand around it; where there is none,
the use is as ever. The package names its modules in ``mutabot.extensions.Extension``: ``middlewares``, each
by the module of the client library that it hooks, ``environments``, ``futures`` and ``libraries``. No module
of it is imported before it is needed: a ``MiddlewareModule`` when the program imports its client library.

What hooks keep to, so that all operators mean the same in every middleware:

- Each use gives the handler a ``Where`` with ``means`` (``target.MiddlewareControls``): how the node sleeps,
  does something later, what a lost answer looks like, how what was begun is cancelled, how its clock jumps.
  All of it by the clock of the node, so that simulated time counts.
- What comes by itself (``Form.comes_by_itself``: messages, feedback, ticks of a timer) goes through
  ``Where.deliver``, which calls the program's callback, or ``Where.wait_for``, which stands around a wait. A
  handler's own result may be a ``Delivery`` there and nowhere else: late, several times, or not at all.
- An answer that is late or never comes is the handler's matter: it awaits ``means.sleep`` and ``means.lost``.
- What sets something up is ``wrapped(name=…, depth=…)`` with the arguments of ``SETTING_UP``, as they come
  out with the defaults of the middleware; those that it does not know are left out, and a deadline of 0 is
  none. ``wrapped`` has a parameter for each that it is called with.
- A parameter is read by ``wrapped(default=…)``, where the program or its declaration gives a default, and
  what ``wrapped`` returns is the value itself.
- Each message that passes, as it really is, is passed to ``names.heard``; each node that is made to
  ``names.note_node``.
"""

from __future__ import annotations

import inspect
import sys
import threading
import time
from collections.abc import Awaitable, Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from inspect import Signature
from types import CodeType, FrameType, ModuleType
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from mutabot.extensions import brought
from mutabot.frozen import frozen
from mutabot.model import Operation, Role, Span
from mutabot.model.path import class_name

if TYPE_CHECKING:
    from mutabot.model.operation import Form


async def _sleep(seconds: float) -> None:
    time.sleep(seconds)


def _later(seconds: float, action: Callable[[], object]) -> None:
    timer = threading.Timer(seconds, action)
    timer.daemon = True
    timer.start()


@frozen
class MiddlewareControls:
    """The ways in which a middleware's hook can delay a call or withhold its answer.

    Seconds are those of the node's own clock, so that simulated time counts.

    Attributes:
        sleep: waits for a number of seconds. Around a plain call it must not suspend: it blocks. Around a
            coroutine function it may await whatever that may await.
        later: has a callback called after a number of seconds, as the node calls others, and returns at once.
        goes_out: has a message go out after a number of seconds, whatever the node does meanwhile.
        lost: what the program meets when the answer it waits for never comes: raises what the middleware
            raises, or waits as long as it would; None for what has no answer.
        cancel: cancels what the call has begun, given what it returned; None for what cannot be cancelled.
        jump: lets the program's clock jump by a number of seconds; None where it cannot.
        once: whether the program waits for one message: later ones are not received.
        end: ends the node's process, and, if asked to, starts it again, where that is no process of the
            operating system; None where it is one.
    """

    sleep: Callable[[float], Awaitable[None]] = _sleep
    later: Callable[[float, Callable[[], object]], None] = _later
    lost: Callable[[], Awaitable[Any]] | None = None
    cancel: Callable[[Any], Awaitable[None]] | None = None
    jump: Callable[[float], None] | None = None
    goes_out: Callable[[float, Callable[[], object]], None] = _later
    once: bool = False
    end: Callable[[bool], object] | None = None


#: seconds: a topic that keeps its last message gives it at once to who asks again and again
_PAUSE = 0.01
#: the same as a share of the time that a wait has lasted: so late another message may be noticed
_LATE = 0.05
#: where a call stands, and whose text that is
CallPlace = tuple[Span, Role]


@frozen
class Delivery:
    """What the program receives in the place of one message.

    Attributes:
        parts: seconds by which each comes later, and the message; none if it is lost.
    """

    parts: tuple[tuple[float, Any], ...] = ()


class TimeModule(Protocol):
    """The interface of the program's time: the module ``time``, or its replacement in a simulation."""

    def monotonic(self) -> float:
        """Return the seconds since an arbitrary moment."""

    def sleep(self, seconds: float, /) -> None:
        """Wait for this many seconds."""


#: ``handler(wrapped, instance, args, kwargs, where=NOWHERE)``, as wrapt calls it, with a ``Where`` behind it
#: if the frames do not show it; what it returns is what the program receives: a coroutine if ``wrapped`` is a
#: coroutine function. Of what comes by itself it may return a ``Delivery`` in its place
Handler = Callable[..., Any]


@frozen
class Where:
    """The place of a use of a target, if the frames above it do not show it.

    Attributes:
        code: the function of the program's that is called back: its definition is the site. None if the site
            is the nearest call of the program's, as everywhere else.
        node: resolved name of the node.
        means: what can befall the call beside other values; None if nothing can.
        is_again: whether the same call of the program's goes on: it still waits for a message.
        site: the site itself, where the call was seen in the text.
        handed: the place at which what is called was handed on, if the frames show none.
        receiver: what was called was read from this object; None if it was not, or that is the instance.
        is_awaited: whether what the call gives is awaited there.
        signature: by which its arguments are read, where it is not the operation's.
        frame: that makes the call; None if it is the next one.
        stands_in: whether what is called is a mock, or a fake of the project.
    """

    code: CodeType | None = None
    node: str | None = None
    means: MiddlewareControls | None = None
    is_again: bool = False
    site: CallPlace | None = None
    handed: CallPlace | None = None
    receiver: Any = None
    is_awaited: bool = False
    frame: FrameType | None = None
    signature: Signature | None = None
    stands_in: bool = False

    def deliver(self, handler: Handler, message: Any, callback: Callable[[Any], Any]) -> Any:
        """Call the program's callback with a message, as the handler has changed it.

        Returns what the callback returns: a coroutine if it is a coroutine function. A message that is lost
        calls nothing and returns None; one that is late calls it from ``means.later``.
        """
        received = handler(lambda: message, None, (), {}, self)
        if not isinstance(received, Delivery):
            return callback(received)
        returned = []
        for late, part in received.parts:
            if late:
                self._means.later(late, partial(callback, part))
            else:
                returned.append(callback(part))
        if any(inspect.isawaitable(value) for value in returned):
            return _in_turn(returned)
        return returned[-1] if returned else None

    def wait_for(
        self,
        handler: Handler,
        wait: Callable[[], Any],
        is_kept: Callable[[Any], bool],
        time_module: TimeModule,
    ) -> Any:
        """Return the message, or its replacement, for a program that waits for one message.

        A message that is lost is waited past. A program that has a message waits no more, and its next wait
        subscribes anew: a mutant can let nothing come after it (``MiddlewareControls.once``).

        Args:
            handler: stands around the wait.
            wait: waits for the next message and returns it. It may be called again, so it keeps the time-out
                of the whole, and raises what the program is to see when that is over.
            is_kept: whether a message is one that its publisher keeps for late subscribers. Each wait gets
                it once more, but a node that had lost it would not.
            time_module: by which time passes for the program.
        """
        where, wait = (
            replace(self, means=replace(self._means, once=True)),
            _another(wait, is_kept, time_module),
        )
        while True:
            received = handler(wait, None, (), {}, where)
            if not isinstance(received, Delivery):
                return received
            for late, part in received.parts:
                if late:
                    _done(self._means.sleep(late))
                return part
            where = replace(where, is_again=True)
            time_module.sleep(_PAUSE)

    @property
    def _means(self) -> MiddlewareControls:
        return self.means if self.means is not None else MiddlewareControls()


#: the frames above show all
NOWHERE = Where()


def _another(
    wait: Callable[[], Any], is_kept: Callable[[Any], bool], time_module: TimeModule
) -> Callable[[], Any]:
    """Return a function that waits for a message that no earlier wait has received."""
    last: list[Any] = []

    def wait_for_another() -> Any:
        began = time_module.monotonic()
        while True:
            message = wait()
            if not last or not is_kept(message) or message != last[0]:
                last[:] = [message]
                return message
            # a simulation goes through ten seconds at once, but not through thousands of subscriptions
            time_module.sleep(max(_PAUSE, _LATE * (time_module.monotonic() - began)))

    return wait_for_another


def _done(awaitable: Awaitable[None]) -> None:
    """Run an awaitable that does not suspend."""
    for _ in awaitable.__await__():
        raise RuntimeError("the sleep of a plain call suspends; it must block")


async def _in_turn(returned: Sequence[Any]) -> Any:
    last = None
    for awaitable in returned:
        last = await awaitable if inspect.isawaitable(awaitable) else awaitable
    return last


@frozen
class Finding:
    """A mismatch of an operation and its target, or a remark about it.

    Attributes:
        key: the key of the operation it is about.
        text: a sentence.
        name, known: the name that does not exist and those that do, where it is about a name.
        is_remark: whether the operation can be used all the same.
    """

    key: str
    text: str
    name: str | None = None
    known: tuple[str, ...] = ()
    is_remark: bool = False


#: called with a target that turns out wrong when it is found, and what is wrong
OnFinding = Callable[[str, Finding], None]


class NotFoundError(LookupError):
    """A target names something that its module does not have.

    Attributes:
        name: the part that does not exist.
        known: names that exist in its place.
    """

    def __init__(self, message: str, name: str, known: tuple[str, ...]) -> None:
        super().__init__(message)
        self.name, self.known = name, known


def resolve(module: ModuleType, qualname: str) -> tuple[Any, str, Any]:
    """Return owner, last name and raw attribute (descriptors unbound) of a qualified name in a module.

    Raises NotFoundError, naming the part that does not exist and what there is.
    """
    owner: Any = module
    *parents, name = qualname.split(".")
    for parent in parents:
        owner = _attribute(owner, parent, module)
        if isinstance(owner, property):
            text = f"{module.__name__}:{qualname} is a part of a property; name the property itself"
            raise NotFoundError(text, name, ())
    return owner, name, _attribute(owner, name, module)


def _attribute(owner: Any, name: str, module: ModuleType) -> Any:
    places = owner.__mro__ if isinstance(owner, type) else (owner,)
    for place in places:
        if name in vars(place):
            return vars(place)[name]
    try:
        return getattr(owner, name)  # a module may make its attributes on demand
    except AttributeError:
        known = tuple(key for key in dir(owner) if not key.startswith("_"))
        of = f"module {module.__name__}" if owner is module else f"{module.__name__}:{_called(owner)}"
        raise NotFoundError(f"{of} has no {name!r}", name, known) from None


def _called(owner: Any) -> str:
    return str(getattr(owner, "__qualname__", type(owner).__qualname__))  # a mock of a class has no name


def is_named(error: BaseException, names: Iterable[str]) -> bool:
    """Return whether one of these names ``module:Name`` denotes the exception's class or a base of it."""
    kinds = type(error).__mro__
    return any(class_name(kind) in names for kind in kinds) or any(
        named_class(name) in kinds for name in names
    )


def named_class(name: str) -> Any:
    """Return the object at ``module:qualified.name``; None if its module is not loaded or lacks the name.

    A test may have put anything in its place, also nothing: ``sys.modules["robot"] = None``.
    """
    module, _, qualname = name.partition(":")
    if module not in sys.modules:
        return None
    try:
        owner, attribute, _ = resolve(sys.modules[module], qualname)
        return getattr(owner, attribute)
    except Exception:  # a module of the tests may answer in any way
        return None


class Names(Protocol):
    """The interface of this process's names, for the hooks of middlewares.

    Attributes:
        on_heard: None if messages that pass are not wanted.
    """

    on_heard: Callable[[str, Any], None] | None

    def find(self, form: Form, name: str, node: str | None) -> Handler | None:
        """Return the handler around a use under a resolved name, in a node; None if there is none."""

    def heard(self, name: str, message: Any) -> None:
        """Report an unchanged message, received or published under a resolved name.

        Of an action: its result, or the word by which its goal ended (``model.operation.ENDINGS``).
        """

    def note_node(self, name: str) -> None:
        """Note that a node of this resolved name was made in this process."""


class MiddlewareModule(Protocol):
    """A module with the hooks into one client library, which is imported already."""

    def hook(self, names: Names, /) -> Callable[[], None]:
        """Hook into the uses of names in this process. Return a function that removes the hooks."""


@runtime_checkable
class TypedMiddleware(MiddlewareModule, Protocol):
    """A middleware that also knows the types of messages."""

    def check(self, operation: Operation) -> Iterator[Finding]:
        """Yield what of an operation does not fit its type's definition, or the type that is used."""


class Environment(Protocol):
    """A module that sets up the environment of nodes, so that those of several workers do not meet."""

    def prepare(self, root: str, home: str, operations: Sequence[Operation] | None) -> bool:
        """Set up the environment if the program needs it, before any of the program is imported.

        Args:
            root: the project's folder.
            home: the worker's folder, which its forks share: what nodes write there meets what those of forks
                write.
            operations: what the vocabulary describes; None where it is not known yet: the program's files
                decide then.

        Returns whether it did: a fork of this process, whose nodes would meet ours, needs its own then.

        Raises MutabotError if what the program needs cannot be there.
        """


def prepare(root: str, home: str, operations: Sequence[Operation] | None) -> bool:
    """Let all packages set up the environment of nodes. Return whether any did."""
    environments: list[Environment] = [part.load() for part in brought("environments").values()]
    # all of them, not up to the first
    found = [environment.prepare(root, home, operations) for environment in environments]
    return any(found)
