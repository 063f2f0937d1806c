"""Names on a middleware as targets: which handler stands around the use of a name, and what does not fit."""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection, Iterable, Iterator
from difflib import SequenceMatcher
from functools import partial
from typing import TYPE_CHECKING, Any

import wrapt

from mutabot.errors import ExtensionError
from mutabot.extensions import ExtensionPart, brought
from mutabot.model.operation import Form, Named, Refused, named_of
from mutabot.runtime.targets.target import Finding, Handler, MiddlewareModule, OnFinding, TypedMiddleware

if TYPE_CHECKING:
    from mutabot.model import Operation

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


#: names that are listed
_MOST = 4


class Messages:
    """The handlers of all operations that have a name.

    Args:
        on_finding: called for a target that turns out wrong when it is found.

    Attributes:
        used: what was done under which names, in this process and those below the tests.
        on_heard: called with each message that passes under a name; None if not wanted.
        on_node: called with the resolved name of each node that is made here; None if not wanted.
    """

    def __init__(self, on_finding: OnFinding) -> None:
        self._on_finding = on_finding
        self.on_heard: Callable[[str, Any], None] | None = None
        self.on_node: Callable[[str], None] | None = None
        self._handlers: list[tuple[Named, Handler]] = []
        self._found: dict[tuple[Form, str, str | None], Handler | None] = {}
        self._undo: list[Callable[[], None]] = []
        self._removed = False
        self._here: set[str] = set()
        self.used: set[Named] = set()
        for part in brought("middlewares").values():
            wrapt.register_post_import_hook(partial(self._hook, part), part.name)

    def wrap(self, target: str, handler: Handler) -> None:
        """Put a handler around the uses of a name; the middleware's own function is never replaced."""
        self._handlers.append((Named.of(target), handler))
        self._found.clear()

    def find(self, form: Form, name: str, node: str | None) -> Handler | None:
        """Return the handler for a use under a resolved name in a node; None if the vocabulary has none.

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
        """Report an unchanged message under a resolved name; see ``target.Names``."""
        if self.on_heard is not None:
            self.on_heard(name, message)

    def note_node(self, name: str) -> None:
        """Note that a node of this resolved name was made in this process."""
        if self.on_node is not None:
            self.on_node(name)

    def remove(self) -> None:
        """Remove all hooks."""
        self._removed = True
        self._found.clear()
        self._handlers.clear()
        while self._undo:
            self._undo.pop()()

    def seek(self) -> Iterator[tuple[str, Finding]]:
        """Yield the operations whose names were never used; names exist only while nodes use them."""
        return unused([named for named, _ in self._handlers], self.used)

    def unheard(self, operation: Operation) -> Iterator[Finding]:
        """Yield topics and actions of an operation to which no process of the tests listens."""
        return unheard(operation.all_refused, self.used)

    def here(self) -> Iterable[str]:
        """Return the targets of the names that were used."""
        return tuple(self._here)  # at once: another thread may come by under a new name

    def found_elsewhere(self, targets: Iterable[str]) -> None:
        """Note targets that a process below the tests has used."""
        self.used.update(named for target in targets if (named := named_of(target)) is not None)

    def check(self, operation: Operation) -> Iterator[Finding]:
        """Yield what of an operation does not fit the installed definition of its type."""
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
        """Hook into a client library that the program has imported."""
        if self._removed:
            return
        try:
            middleware: MiddlewareModule = part.load()
        except ExtensionError as error:  # the program might catch it
            for named, _handler in self._handlers:
                self._on_finding(named.target, Finding(named.form.value, str(error)))
            raise
        self._undo.append(middleware.hook(self))


def unused(wanted: Collection[Named], used: Collection[Named]) -> Iterator[tuple[str, Finding]]:
    """Yield each operation of the vocabulary that was never used, with the uses that come nearest."""
    for named in wanted:
        if named.form not in _FORMS or any(named.fits(use.form, use.name, use.node) for use in used):
            continue
        where = f" in a node {named.node}" if named.node is not None else ""
        sentence = f"{_FORMS[named.form][0].format(named.name)}{where}; {_instead(named, used)}"
        yield named.target, Finding(named.form.value, sentence, is_remark=True)


def unheard(refused: Collection[Refused], used: Collection[Named]) -> Iterator[Finding]:
    """Yield names on which the vocabulary expects refusals, and to which nothing listens."""
    for name in dict.fromkeys(refusal.topic for refusal in refused if refusal.topic is not None):
        wanted = [Named(form, name) for form in _LISTENING]
        if any(target.fits(use.form, use.name, use.node) for target in wanted for use in used):
            continue
        instead = _instead(Named(Form.RECEIVE, name), used)
        sentence = f"no node listens to {name}, so refusals published there are not seen; {instead}"
        yield Finding("refused", sentence, is_remark=True)


def _instead(named: Named, used: Collection[Named]) -> str:
    """Describe other uses of the same name or type, nearest first."""
    wanted = (_FORMS[named.form][1], named.form)  # of one name, what was done, not what was set up
    similar = sorted((wanted.index(use.form), use.target, use.name) for use in used if use.form in wanted)
    alike = {name: target for _, target, name in similar}
    if not alike:
        known = f"; middlewares that are known here: {', '.join(brought('middlewares')) or 'none'}"
        return f"nothing of that kind was seen under any name{'' if used else known}"
    likeness = {name: SequenceMatcher(None, name, named.name).ratio() for name in alike}
    targets = [alike[name] for name in sorted(alike, key=lambda name: (-likeness[name], name))]
    more = f" and {len(targets) - _MOST} more" if len(targets) > _MOST else ""
    return f"seen: {', '.join(targets[:_MOST])}{more}"
