"""Members of enumerations, Python's and pybind11's.

A vocabulary names a member by its name, by its number or other value, or as it prints (``Mode.AUTO``).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import Enum, Flag
from functools import cache, reduce
from operator import or_
from typing import Any

from mutabot.errors import PathError, nearest_name

#: members that a message lists
_MOST = 12


def is_member(value: Any) -> bool:
    """Return whether a value is a member of an enumeration."""
    kind: Any = type(value)
    return issubclass(kind, Enum) or _is_of_pybind11(kind)


@cache
def _is_of_pybind11(kind: Any) -> bool:
    members = getattr(kind, "__members__", None)
    return (
        isinstance(members, Mapping)
        and bool(members)
        and all(type(member) is kind for member in members.values())
        and all(hasattr(kind, name) for name in ("name", "value"))
    )


def member_of(kind: type[Any], written: Any) -> Any | None:
    """Return the member of an enumeration that is written so; None if it has none."""
    members: Mapping[str, Any] = getattr(kind, "__members__", {})
    if isinstance(written, str) and written in members:
        return members[written]
    for member in members.values():
        if _is_value(member, written) or (isinstance(written, str) and str(member) == written):
            return member
    return _combined(kind, members, written) if issubclass(kind, Flag) else None


def name_of(member: Any) -> str:
    """Return a member's name, or its text if it has no name."""
    return str(member.name or member)


def written_of(member: Any, values: Sequence[Any]) -> Any:
    """Return which of a vocabulary's values denotes a member; its name if none does.

    Raises PathError if its enumeration has no member for one of the values, or one member for two of them.
    """
    kind: Any = type(member)
    members = [member_of(kind, value) for value in values]
    if None in members:
        raise PathError(_unknown(kind, values[members.index(None)]))
    twice = [name_of(found) for found in members if members.count(found) > 1]
    if twice:
        raise PathError(f"values name {twice[0]} of {kind.__name__} twice")
    return values[members.index(member)] if member in members else name_of(member)


def _unknown(kind: type[Any], value: Any) -> str:
    known = list(kind.__members__)
    near = nearest_name(str(value), known)
    listed = ", ".join(known[:_MOST]) + (" …" if len(known) > _MOST else "")
    hint = f"did you mean {near!r}?" if near else f"it has {listed}"
    return f"{kind.__name__} has no member {value!r}, which values name; {hint}"


def _is_value(member: Any, written: Any) -> bool:
    value = member.value
    try:
        return isinstance(value, str) is isinstance(written, str) and bool(value == written)
    except Exception:  # a value of the user's may compare in any way
        return False


def _combined(kind: type[Any], members: Mapping[str, Any], written: Any) -> Any | None:
    """Return several flags at once, by their names (``READ|WRITE``) or their number."""
    if isinstance(written, str):
        names = [name.strip() for name in written.split("|")]
        known = all(name in members for name in names)
        return reduce(or_, (members[name] for name in names)) if known else None
    every = reduce(or_, (member.value for member in members.values()), 0)
    is_known = isinstance(written, int) and written >= 0 and not written & ~every
    return kind(int(written)) if is_known else None
