"""Refusals: which calls the robot refuses in the original too, and how data say that it refuses one."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cache
from typing import Any

from mutabot.errors import PathError
from mutabot.model import Call, Path, Span
from mutabot.model.answer import is_member, member_of
from mutabot.model.job import RefusedAt
from mutabot.model.operation import Form, Refused
from mutabot.runtime.interception.adapter import SiteCall

#: a call of a test: its site, operation and pattern, and its number among those of the site
_Key = tuple[Span, str, str | None]


@dataclass(slots=True)
class RefusedCalls:
    """The calls of the running test that the robot refuses in the original.

    The baseline notes them. In all other runs they are known from it: a mutated call that is refused there
    as well shows nothing but what the original shows.

    Attributes:
        on_refused: told of each one in the baseline; None in all other runs.
    """

    on_refused: Callable[[SiteCall], None] | None = None
    _known: dict[_Key, frozenset[int]] = field(default_factory=dict)
    _watched: dict[str, tuple[SiteCall, tuple[Refused, ...]]] = field(default_factory=dict)

    def start(self, known: Iterable[RefusedAt]) -> None:
        """A test begins, of which these are known."""
        self._known = {(one.span, one.operation, one.pattern): frozenset(one.numbers) for one in known}
        self._watched.clear()

    def at(self, span: Span, operation: str, pattern: str | None) -> frozenset[int]:
        """Return the numbers of the refused calls of a site."""
        return self._known.get((span, operation, pattern), frozenset())

    def has(self, made: SiteCall) -> bool:
        """Whether this call of the original's is known to be one."""
        pattern = made.call.pattern.text if made.call.pattern is not None else None
        return made.number in self.at(made.site[0], made.call.operation.target, pattern)

    def begins(self, made: SiteCall) -> None:
        """Note that the original makes a call: as with mutated ones, what is refused from now on is this."""
        if self.on_refused is None:
            return
        self._watched.pop(made.call.operation.target, None)
        refused = refused_of(made.call)
        if any(one.topic is not None for one in refused):  # nothing of the program's is kept without need
            self._watched[made.call.operation.target] = (made, refused)

    def returned(self, made: SiteCall, result: Any) -> None:
        """Look whether the answer to a call of the original's says that the robot refuses it."""
        if self.on_refused is not None and answered(made.call, result) is not None:
            self.on_refused(made)

    def heard(self, name: str, message: Any) -> None:
        """Look whether a message says that the robot refuses a call of the original's."""
        for target, (made, refused) in list(self._watched.items()):
            if self.on_refused is not None and heard(refused, name, message) is not None:
                del self._watched[target]
                self.on_refused(made)


def refused_of(call: Call) -> tuple[Refused, ...]:
    """Return how the robot says that it refuses this command."""
    own = call.pattern.refused if call.pattern is not None else ()
    return own or call.operation.refused


def answered(call: Call, result: Any) -> str | None:
    """Return how the answer to a command says that it is refused, in words; None if it does not."""
    for refused in refused_of(call):
        if refused.topic is None:
            found = _found(refused, result)
            if found is not None:
                return f"answered {found}"
        elif _is_rejected(call, result) and "REJECTED" in refused.values:
            return f"{refused.topic}: REJECTED"
    return None


def heard(refused: Iterable[Refused], name: str, message: Any) -> str | None:
    """Return how a message under this name refuses a command before it, in words; None if it does not.

    Of an action, messages are its results, and the words by which its goals end.
    """
    for one in refused:
        if one.topic is not None and fnmatchcase(name, one.topic):
            found = _found(one, message)
            if found is not None:
                return f"{name}: {found}"
    return None


def is_told_on(refused: Iterable[Refused], name: str) -> bool:
    """Whether messages under this name say how commands end."""
    return any(one.topic is not None and fnmatchcase(name, one.topic) for one in refused)


def _is_rejected(call: Call, result: Any) -> bool:
    named = call.operation.named
    return named is not None and named.form is Form.GOAL and getattr(result, "accepted", None) is False


def _found(refused: Refused, start: Any) -> str | None:
    path = _parsed(refused.path)
    try:
        value = path.get(start)
    except PathError:  # another kind of answer, or of message
        return None
    if not any(_means(wanted, value) for wanted in refused.values):
        return None
    value = value.value if is_member(value) else _plain(value)
    return " ".join(part for part in (str(path).lstrip("."), str(value)) if part)


def _means(wanted: Any, value: Any) -> bool:
    """Whether a value of the vocabulary stands for one of the robot's."""
    if not is_member(value):
        return _same(_plain(value), wanted)
    member = member_of(type(value), wanted)
    return member is not None and bool(member == value)


def _same(value: Any, wanted: Any) -> bool:
    """Whether they are equal; a truth value is no number."""
    try:
        return isinstance(value, bool) is isinstance(wanted, bool) and bool(value == wanted)
    except Exception:  # a value of the user's may compare in any way
        return False


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(type(value), "tolist") else value


@cache
def _parsed(path: str) -> Path:
    return Path.parse(path, rooted=False)
