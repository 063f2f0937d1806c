"""The contract of a middleware: what a package brings so that operations can be names on it.

Topics, services, actions and parameters have names that are known only when they are used, after remapping
and namespaces. So a package puts hooks into the client library of its middleware, and at each use they ask
``names.find(form, name, node)`` and let the handler that they get stand around it; where there is none,
the use is as ever. The package names its modules in ``mutabot.extensions.Extension``: ``middlewares``, each
by the module of the client library that it hooks, ``environments``, ``futures`` and ``libraries``. No module
of it is imported before it is needed: a ``Middleware`` when the program imports its client library.

What hooks keep to, so that all operators mean the same in every middleware:

- Each use gives the handler a ``Where`` with ``means`` (``target.Means``): how the node sleeps, does
  something later, what a lost answer looks like, how what was begun is cancelled, how its clock jumps. All of
  it by the clock of the node, so that simulated time counts.
- What comes by itself (``COMING``: messages, feedback, ticks of a timer) goes through ``delivery``:
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

from collections.abc import Callable, Iterator
from typing import Any, Protocol, runtime_checkable

from mutabot.extensions import brought
from mutabot.model import Operation, Vocabulary
from mutabot.model.named import Form

from .target import Finding, Handler


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

        Of an action: its result, or the word by which its goal ended (``model.named.ENDINGS``).
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
            home: the worker's folder.
            vocabulary: the robot API; None where it is not known yet: the program's files tell then.

        Returns whether it did: a fork of this process, whose nodes would meet ours, needs its own then.

        Raises MutabotError if what the program needs cannot be there.
        """


def prepare(root: str, home: str, vocabulary: Vocabulary | None) -> bool:
    """Let all packages set up what nodes will find; returns whether any did. See ``Environment``."""
    environments: list[Environment] = [part.load() for part in brought("environments").values()]
    found = [one.prepare(root, home, vocabulary) for one in environments]  # all of them, not up to the first
    return any(found)
