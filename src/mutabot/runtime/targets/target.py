"""How an operation is found at run time, and what a handler around it is told.

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
of it is imported before it is needed: a ``Middleware`` when the program imports its client library.

What hooks keep to, so that all operators mean the same in every middleware:

- Each use gives the handler a ``Where`` with ``means`` (``target.MiddlewareControls``): how the node sleeps,
  does something later, what a lost answer looks like, how what was begun is cancelled, how its clock jumps.
  All of it by the clock of the node, so that simulated time counts.
- What comes by itself (``COMING``: messages, feedback, ticks of a timer) goes through ``messages``:
  ``deliver`` calls the program's callback, ``wait_for`` stands around a wait. A handler's own result
  may be a ``Delivery`` there and nowhere else.
- An answer that is late or never comes is the handler's matter: it awaits ``means.sleep`` and ``means.lost``.
- What sets something up is ``wrapped(name=…, depth=…)`` with the arguments of ``SETTING_UP``, as they come
  out with the defaults of the middleware; those that it does not know are left out, and a deadline of 0 is
  none. ``wrapped`` has a parameter for each that it is called with.
- A parameter is read by ``wrapped(default=…)``, where the program or its declaration gives a default, and
  what ``wrapped`` returns is the value itself.
- Each message that passes, as it is in truth, is told to ``names.heard``; each node that is made to
  ``processes.member.note_node``.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Awaitable, Callable, Iterable, Iterator
from inspect import Signature
from types import CodeType, FrameType, ModuleType
from typing import Any, Protocol, runtime_checkable

from mutabot.extensions import brought
from mutabot.frozen import frozen
from mutabot.model import Operation, Role, Span, Vocabulary
from mutabot.model.operation import Form
from mutabot.model.path import class_name


async def _sleep(seconds: float) -> None:
    time.sleep(seconds)


def _later(seconds: float, action: Callable[[], object]) -> None:
    timer = threading.Timer(seconds, action)
    timer.daemon = True
    timer.start()


@frozen
class MiddlewareControls:
    """How a call of a middleware comes late, or its answer never; the hook that has the call knows.

    Seconds are those of the node's own clock, so that simulated time counts.

    Attributes:
        sleep: waits for so many seconds. Around a plain call it must not suspend: it blocks. Around a
            coroutine function it may await whatever that may await.
        later: has a callback called after so many seconds, as the node calls others, and returns at once.
        goes_out: has a message go out after so many seconds, whatever the node does meanwhile.
        lost: what the program meets when the answer it waits for never comes: raises what the middleware
            raises, or waits as long as it would; None for what has no answer.
        cancel: cancels what the call has begun, given what it returned; None for what cannot be cancelled.
        jump: lets the program's clock jump by so many seconds; None where it cannot.
        once: whether the program waits for one message: what comes after it comes to nobody.
        end: ends the node's process, and begins it anew if told so, where that is no process of the operating
            system; None where it is one.
    """

    sleep: Callable[[float], Awaitable[None]] = _sleep
    later: Callable[[float, Callable[[], object]], None] = _later
    lost: Callable[[], Awaitable[Any]] | None = None
    cancel: Callable[[Any], Awaitable[None]] | None = None
    jump: Callable[[float], None] | None = None
    goes_out: Callable[[float, Callable[[], object]], None] = _later
    once: bool = False
    end: Callable[[bool], object] | None = None


@frozen
class Where:
    """Where a use of a target is, if the frames above it do not tell.

    Attributes:
        code: the function of the program's that is called back: its definition is the site. None if the site
            is the nearest call of the program's, as everywhere else.
        node: resolved name of the node.
        means: what can befall the call beside other values; None if nothing can.
        is_again: whether the same call of the program's goes on: it still waits for a message.
        site: the site itself, where the call was seen in the text.
        handed: the place at which what is called was handed on, if the frames tell none.
        receiver: what was called was read from this object; None if it was not, or that is the instance.
        is_awaited: whether what the call gives is awaited there.
        signature: by which its arguments are read, where it is not the operation's.
        frame: that makes the call; None if it is the next one.
    """

    code: CodeType | None = None
    node: str | None = None
    means: MiddlewareControls | None = None
    is_again: bool = False
    site: tuple[Span, Role] | None = None
    handed: tuple[Span, Role] | None = None
    receiver: Any = None
    is_awaited: bool = False
    frame: FrameType | None = None
    signature: Signature | None = None


#: the frames above tell all
NOWHERE = Where()

#: ``handler(wrapped, instance, args, kwargs, where=NOWHERE)``, as wrapt calls it, with a ``Where`` behind it
#: if the frames do not tell; what it returns is what the program receives: a coroutine if ``wrapped`` is a
#: coroutine function. Of what comes by itself it may return a ``messages.Delivery`` in its place
Handler = Callable[..., Any]


@frozen
class Finding:
    """What does not fit, or what is worth saying.

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


#: told about a target that turns out wrong when it is found
Tell = Callable[[str, Finding], None]


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
    """Owner, last name and raw attribute (descriptors unbound) of a qualified name in a module.

    Raises NotFoundError, naming the part that does not exist and what there is.
    """
    owner: Any = module
    *parents, name = qualname.split(".")
    for parent in parents:
        owner = _attribute(owner, parent, module)
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
    """Whether one of the names ``module:Name`` means the exception's class, re-exported names included."""
    kinds = type(error).__mro__
    return any(class_name(kind) in names for kind in kinds) or any(
        named_class(name) in kinds for name in names
    )


def named_class(name: str) -> Any:
    """What ``module:qualified.name`` is now; None if its module is not loaded or has no such name.

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
    """The names of this process, as hooks know them.

    Attributes:
        on_heard: None if nobody asks for messages that pass.
    """

    on_heard: Callable[[str, Any], None] | None

    def find(self, form: Form, name: str, node: str | None) -> Handler | None:
        """What is to stand around a use under a resolved name, in a node; None if nothing is."""

    def heard(self, name: str, message: Any) -> None:
        """A message passed under a resolved name, received or published, as it is in truth.

        Of an action: its result, or the word by which its goal ended (``model.operation.ENDINGS``).
        """


class Middleware(Protocol):
    """A module with the hooks into one client library, which is imported already."""

    def hook(self, names: Names, /) -> Callable[[], None]:
        """Let what nodes of this process do pass by; returns what takes the hooks away."""


@runtime_checkable
class TypedMiddleware(Middleware, Protocol):
    """One that knows the types of messages as well."""

    def check(self, operation: Operation) -> Iterator[Finding]:
        """What of an operation does not fit the definition of its type, or the type that the program uses."""


class Environment(Protocol):
    """A module that sets up what nodes find when they start, so that those of several workers do not meet."""

    def prepare(self, root: str, home: str, vocabulary: Vocabulary | None) -> bool:
        """Set it up if the program needs it; nothing of the program's has been imported yet.

        Args:
            root: the project's folder.
            home: the worker's folder, which its forks share: what nodes write there meets what those of forks
                write.
            vocabulary: the robot API; None where it is not known yet: the program's files tell then.

        Returns whether it did: a fork of this process, whose nodes would meet ours, needs its own then.

        Raises MutabotError if what the program needs cannot be there.
        """


def prepare(root: str, home: str, vocabulary: Vocabulary | None) -> bool:
    """Let all packages set up what nodes will find; returns whether any did. See ``Environment``."""
    environments: list[Environment] = [part.load() for part in brought("environments").values()]
    found = [one.prepare(root, home, vocabulary) for one in environments]  # all of them, not up to the first
    return any(found)
