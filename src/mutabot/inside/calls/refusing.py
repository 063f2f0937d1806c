"""Refusals as data: how an answer, or a message that follows a command, says that the robot refuses it."""

from __future__ import annotations

from collections.abc import Iterable
from fnmatch import fnmatchcase
from functools import cache
from typing import Any

from mutabot.errors import PathError
from mutabot.model import Call, Path
from mutabot.model.named import Form, Refused
from mutabot.model.values.members import is_member, member_of


def refused_of(call: Call) -> tuple[Refused, ...]:
    """How the robot says that it refuses this command."""
    own = call.pattern.refused if call.pattern is not None else ()
    return own or call.operation.refused


def answered(call: Call, result: Any) -> str | None:
    """How the answer to a command says that it is refused, in words; None if it does not."""
    for refused in refused_of(call):
        if refused.topic is None:
            found = _found(refused, result)
            if found is not None:
                return f"answered {found}"
        elif _is_rejected(call, result) and "REJECTED" in refused.values:
            return f"{refused.topic}: REJECTED"
    return None


def heard(refused: Iterable[Refused], name: str, message: Any) -> str | None:
    """How a message under this name says that a command before it is refused, in words; None if it does not.

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
    return value.tolist() if hasattr(value, "dtype") and hasattr(value, "tolist") else value


@cache
def _parsed(path: str) -> Path:
    return Path.parse(path, rooted=False)
