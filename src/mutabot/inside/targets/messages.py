"""Targets that have a name on a middleware: topics, services, actions, parameters.

Which name something has is known only when it is used, after remapping and namespaces. So the hooks of a
middleware (``mutabot_ros``, one file each) ask here at each use, and let the handler they get stand around
it. They are put in place as soon as the program imports the middleware.

What hooks keep to, so that all operators mean the same in every middleware:

- Each use gives the handler a ``Where`` with ``means`` (``means.Means``): how the node sleeps, does something
  later, what a lost answer looks like, how what was begun is cancelled, how its clock jumps. All of it by the
  clock of the node, so that simulated time counts.
- What comes by itself (``COMING``: messages, feedback, ticks of a timer) goes through ``delivery``:
  ``deliver`` calls the program's callback, ``wait_for`` stands around a wait. A handler's own result
  may be a ``Delivery`` there and nowhere else.
- An answer that is late or never comes is the handler's matter: it awaits ``means.sleep`` and ``means.lost``.
- What sets something up is ``wrapped(name=…, depth=…)`` with the arguments of ``SETTING_UP``, as they come
  out with the defaults of the middleware; those that it does not know are left out, and a deadline of 0 is
  none. ``wrapped`` has a parameter for each that it is called with.
- A parameter is read by ``wrapped(default=…)``, where the program or its declaration gives a default, and
  what ``wrapped`` returns is the value itself.
"""

from __future__ import annotations

import pkgutil
import sys
from collections.abc import Callable, Iterable, Iterator
from importlib import import_module
from types import ModuleType
from typing import Any

import wrapt

from mutabot.model import Operation
from mutabot.model.named import Form, Named, named_of

from .target import Finding, Handler, Targets, Tell
from .unused import unheard, unused

#: the rooms in which middlewares are: each file says in ``MODULE`` which module it is about, and has ``hook``
_MIDDLEWARES = "mutabot_ros"


class Messages(Targets):
    """The handlers of all operations that have a name.

    Attributes:
        used: what was done under which names, in this process and those below the tests.
    """

    def __init__(self, tell: Tell) -> None:
        self._tell = tell
        self._handlers: list[tuple[Named, Handler]] = []
        self._found: dict[tuple[Form, str, str | None], Handler | None] = {}
        self._undo: list[Callable[[], None]] = []
        self._removed = False
        self._here: set[str] = set()
        self.used: set[Named] = set()
        _when_imported(self._hook)

    def wrap(self, target: str, handler: Handler, overrides: object = None) -> None:
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
        """A message passed under a resolved name, received or published, as it is in truth.

        Of an action: its result, or the word by which its goal ended (``model.named.ENDINGS``).
        """
        if self.on_heard is not None:
            self.on_heard(name, message)

    def tell(self, target: str, finding: Finding) -> None:
        """Say what is wrong with a target that was found."""
        self._tell(target, finding)

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
        for middleware in _loaded():
            yield from middleware.check(operation)

    def _note(self, used: Named) -> None:
        self.used.add(used)
        self._here.add(used.target)
        for named, _ in self._handlers:
            if named.fits(used.form, used.name, used.node):
                self._here.add(named.target)

    def _hook(self, middleware: ModuleType) -> None:
        if not self._removed:
            self._undo.append(middleware.hook(self))


def _loaded() -> Iterator[ModuleType]:
    for middleware in _middlewares():
        if middleware.MODULE in sys.modules:
            yield middleware


def _middlewares() -> Iterator[ModuleType]:
    for found in pkgutil.iter_modules(import_module(_MIDDLEWARES).__path__):
        if not found.name.startswith("_"):
            yield import_module(f"{_MIDDLEWARES}.{found.name}")


def _when_imported(hook: Callable[[ModuleType], None]) -> None:
    for middleware in _middlewares():

        def imported(_: ModuleType, middleware: ModuleType = middleware) -> None:
            hook(middleware)

        wrapt.register_post_import_hook(imported, middleware.MODULE)


#: what this file is, to ``interception``
KIND = Messages
