"""Copies of values, and of answers that are the robot's own memory.

To write to an array that a simulator hands out is to command the robot. A mutated reading is a copy of it:
what the program writes to the copy is lost, so such a run says nothing of the tests.
"""

from __future__ import annotations

import copy
import sys
from collections.abc import Iterable, Iterator
from functools import cached_property
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from mutabot.errors import PathError
from mutabot.model.path import Path, Step

if TYPE_CHECKING:
    from mutabot.model import Quantity

#: copies that are looked at after each call
_LAST = 8
_MISSING = object()
#: the first item of a list, as if a vocabulary described it
_FIRST: Any = SimpleNamespace(path=Path(None, (Step(item=0),)))
#: immutable values
_FIXED = (int, float, complex, str, bytes, bool, type(None), frozenset, range)


def copied(value: Any) -> Any:
    """Return a copy of a value, or the value itself if it cannot be copied."""
    try:
        return copy.deepcopy(value)
    except Exception:  # objects of the user's may refuse to be copied in any way
        return value


def is_live(answer: Any, quantities: Iterable[Quantity]) -> bool:
    """Return whether an object other than the program holds an answer or a described part of it.

    To be asked as soon as the answer is there, by the one function that has it.
    """
    try:
        return _is_held(answer, _OF_ANSWER) or any(
            _is_held(part, _OF_PART) for quantity in quantities for part in _parts(answer, quantity.path)
        )
    except Exception:  # objects of the user's may do anything when they are looked at: then it may be
        return True


def _is_held(value: Any, known: int) -> bool:
    """Return whether a value is held elsewhere; ``known`` is the number of its references here."""
    if issubclass(type(value), (*_FIXED, tuple)):  # of a tuple, the parts may be written to
        return False
    if sys.getrefcount(value) > known:
        return True
    arrays: Any = getattr(sys.modules.get("numpy"), "ndarray", ())
    if not issubclass(type(value), arrays):
        return False
    base = arrays.base.__get__(value)
    if base is None or not arrays.flags.__get__(value).writeable:
        return False
    # a view of an array without another reference is as good as that array
    return not issubclass(type(base), arrays) or _is_held(base, _OF_ANSWER)


def _parts(answer: Any, path: Path) -> Iterator[Any]:
    """Yield the parts of an answer on the way to a quantity, except the answer itself and fresh copies."""
    value = answer
    for step in path.steps:
        if step.bounds is not None:
            return
        try:
            value = Path(None, (step,)).get(value)
        except PathError:
            return
        yield value


#: the references to an answer, and to a part of it, that make no new list live. They are counted, since what
#: a call adds differs between versions of Python
_OF_ANSWER = _OF_PART = 0
_NEW: list[Any] = []
while is_live(_NEW, ()):
    _OF_ANSWER += 1
_NEW = [[]]
while is_live(_NEW, (_FIRST,)):
    _OF_PART += 1


class HandedCopies:
    """Copies of live answers that the program got from a mutated reading.

    Attributes:
        written: whether it has written to one.
    """

    def __init__(self) -> None:
        self.written = False
        self._handed: list[_CopyRecord] = []

    def note(self, original: Any, handed: Any, quantities: Iterable[Quantity]) -> None:
        """Note that the program gets ``handed`` in the place of a live answer."""
        pairs = [(original, handed)]
        for quantity in quantities:
            pairs += zip(_parts(original, quantity.path), _parts(handed, quantity.path), strict=False)
        known: set[int] = set()
        for before, after in pairs:
            if after is not before and id(after) not in known and not isinstance(after, (*_FIXED, tuple)):
                known.add(id(after))
                self._handed.append((after, _content(after)))

    def look(self, *, at_all: bool = False) -> bool:
        """Return whether the program has written to a copy; forget copies that it dropped.

        Without ``at_all`` only the last ones are looked at: a program may keep every reading that it takes.
        """
        start = 0 if at_all else max(0, len(self._handed) - _LAST)
        waiting = self._handed[start:]
        del self._handed[start:]
        while waiting and not self.written:
            entry = waiting.pop(0)  # what it is a part of comes before a part, and goes before it
            self.written = not _is_as_before(*entry)
            if sys.getrefcount(entry[0]) > _IN_RECORD:
                self._handed.append(entry)
        return self.written


#: a copy that the program was given, and what was in it
_CopyRecord = tuple[Any, dict[Any, Any]]


_record: _CopyRecord = ([], {})
#: references to a value that nothing but such a record holds
_IN_RECORD = sys.getrefcount(_record[0])


def _content(value: Any) -> dict[Any, Any]:
    """Return the content of an object itself, for a later comparison, without that of its parts."""
    if hasattr(value, "tobytes") and hasattr(value, "dtype"):
        return {None: (str(value.dtype), value.tobytes())}
    if isinstance(value, list):
        return dict(enumerate(value))
    if isinstance(value, set | bytearray) or hasattr(value, "typecode"):
        return {None: copy.copy(value)}
    own = value if isinstance(value, dict) else getattr(value, "__dict__", None)
    if own is not None:
        return dict(own)
    return {name: getattr(value, name, None) for kind in type(value).__mro__ for name in _slots(kind)}


def _slots(kind: type) -> tuple[str, ...]:
    slots = kind.__dict__.get("__slots__", ())
    return (slots,) if isinstance(slots, str) else tuple(slots)


def _is_as_before(value: Any, before: dict[Any, Any]) -> bool:
    """Return whether an object holds the same objects as before, or equal plain values."""
    now = _content(value)
    return all(
        _is_alike(before.get(key, _MISSING), now.get(key, _MISSING))
        or (before.get(key) is None and _is_remembered(value, key))
        for key in before | now
    )


def _is_remembered(value: Any, key: Any) -> bool:
    """Return whether a new attribute is a value that the object caches for itself."""
    if isinstance(value, dict) or not isinstance(key, str):
        return False
    return key.startswith("_") or isinstance(getattr(type(value), key, None), cached_property)


def _is_alike(first: Any, second: Any) -> bool:
    if first is second:
        return True
    try:
        return type(first) is type(second) and bool(first == second or (first != first and second != second))  # noqa: PLR0124  # NaN
    except Exception:  # a value of the user's may compare in any way; it is another object
        return False
