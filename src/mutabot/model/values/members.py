"""Members of enumerations, of Python's and of pybind11's, as vocabularies write them.

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
    """Whether a value is a member of an enumeration."""
    kind: Any = type(value)
    return isinstance(value, Enum) or _is_of_pybind11(kind)


@cache
def _is_of_pybind11(kind: Any) -> bool:
    members = getattr(kind, "__members__", None)
    return (
        isinstance(members, Mapping)
        and bool(members)
        and all(type(one) is kind for one in members.values())
        and all(hasattr(kind, name) for name in ("name", "value"))
    )


def member_of(kind: type[Any], written: Any) -> Any | None:
    """The member of an enumeration that is written so; None if it has none."""
    members: Mapping[str, Any] = getattr(kind, "__members__", {})
    if isinstance(written, str) and written in members:
        return members[written]
    for member in members.values():
        if _is_value(member, written) or (isinstance(written, str) and str(member) == written):
            return member
    return _combined(kind, members, written) if issubclass(kind, Flag) else None


def name_of(member: Any) -> str:
    """A member's name; how it prints where it has none of its own."""
    return str(member.name or member)


def written_of(member: Any, values: Sequence[Any], path: str) -> Any:
    """Which of a vocabulary's values stands for a member; its name if none does.

    Raises PathError if its enumeration has no member for one of the values, or one member for two of them.
    """
    kind: Any = type(member)
    found = _members(kind, tuple(map(_Typed, values)), path)
    for value, one in zip(values, found, strict=True):
        if one == member:
            return value
    return name_of(member)


class _Typed:
    """A value that is equal only to one of the same type: 1 is not true."""

    __slots__ = ("value",)

    def __init__(self, value: Any) -> None:
        self.value = value

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Typed) and (type(self.value), self.value) == (
            type(other.value),
            other.value,
        )

    def __hash__(self) -> int:
        return hash((type(self.value), self.value))


@cache
def _members(kind: Any, values: tuple[_Typed, ...], path: str) -> tuple[Any, ...]:
    """The members that these values stand for. Raises PathError."""
    found: list[Any] = []
    for one in values:
        member = member_of(kind, one.value)
        if member is None:
            raise _unknown(kind, one.value, path)
        if member in found:
            raise _error(kind, f"values name {name_of(member)} of {kind.__name__} twice", path)
        found.append(member)
    return tuple(found)


def _unknown(kind: type[Any], value: Any, path: str) -> PathError:
    known = list(kind.__members__)
    near = nearest_name(str(value), known)
    listed = ", ".join(known[:_MOST]) + (" …" if len(known) > _MOST else "")
    hint = f"did you mean {near!r}?" if near else f"it has {listed}"
    return _error(kind, f"{kind.__name__} has no member {value!r}, which values name; {hint}", path)


def _error(kind: type[Any], text: str, path: str) -> PathError:
    return PathError(text, path="", step=path, found=kind.__name__)


def _is_value(member: Any, written: Any) -> bool:
    value = member.value
    try:
        return isinstance(value, str) is isinstance(written, str) and bool(value == written)
    except Exception:  # a value of the user's may compare in any way
        return False


def _combined(kind: type[Any], members: Mapping[str, Any], written: Any) -> Any | None:
    """Several flags at once, by their names (``READ|WRITE``) or their number."""
    if isinstance(written, str):
        names = [name.strip() for name in written.split("|")]
        known = all(name in members for name in names)
        return reduce(or_, (members[name] for name in names)) if known else None
    every = reduce(or_, (member.value for member in members.values()), 0)
    is_known = isinstance(written, int) and written >= 0 and not written & ~every
    return kind(int(written)) if is_known else None
