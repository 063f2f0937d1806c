"""Read values of the user's program as plain data, without running any of its code.

What is looked at is recognized by its class alone: the plain ones of Python and of its standard library,
arrays and numbers of numpy, and subclasses of these by what they are made of. What else an object may be,
such as a quantity with a unit, a proxy or a mock, is not looked into: to ask it may do anything.
"""

from __future__ import annotations

import operator
import sys
from array import array
from collections import OrderedDict, defaultdict, deque
from collections.abc import Callable
from dataclasses import is_dataclass
from types import MappingProxyType, MemberDescriptorType
from typing import Any

from mutabot.model.enumeration import is_member

#: stands for what is no data
UNKNOWN = object()
#: levels of containers in containers that are looked at
DEPTH = 20
#: an integer beyond it is no number for operators, which calculate with floating-point numbers
_LARGEST = int(sys.float_info.max)
#: types of immutable values, which are their own data
_FIXED = frozenset({type(None), bool, int, float, complex, str, bytes, range, slice})
#: modules of the standard library whose objects say by their texts what they are
_TEXTUAL = ("datetime", "decimal", "fractions")
_SEQUENCES: tuple[type[Any], ...] = (list, tuple, set, frozenset, deque)
_MAPPINGS = (dict, OrderedDict, defaultdict, MappingProxyType)
#: what makes a plain value of one of a subclass
_PLAINLY: tuple[tuple[type[Any], Callable[[Any], Any]], ...] = (
    (int, int.__int__), (float, float.__float__), (str, str.__str__), (bytes, bytes.__bytes__),
)  # fmt: skip


def is_of_numpy(value: Any) -> bool:
    """Return whether a value is an array or a scalar of numpy, without importing numpy."""
    numpy = sys.modules.get("numpy")
    kind = type(value)
    array_kind, scalar_kind = getattr(numpy, "ndarray", None), getattr(numpy, "generic", None)
    if not (isinstance(array_kind, type) and isinstance(scalar_kind, type)):
        return False
    return kind is array_kind or (issubclass(kind, scalar_kind) and kind.__module__.startswith("numpy"))


def is_scalar_of_numpy(value: Any) -> bool:
    """Return whether a value is a scalar of numpy, which cannot be changed, without importing numpy."""
    return is_of_numpy(value) and type(value).__name__ != "ndarray"


def is_mock(value: Any, kind: str = "NonCallableMock") -> bool:
    """Return whether a value is a mock of a class of ``unittest.mock``, whatever class it claims to have."""
    return issubclass(type(value), getattr(sys.modules.get("unittest.mock"), kind, ()))


def is_textual(value: Any) -> bool:
    """Return whether a value is a date, time, decimal or fraction, without importing their modules."""
    kind = type(value)
    module = kind.__module__
    return module in _TEXTUAL and getattr(sys.modules.get(module), kind.__name__, None) is kind


def is_unchangeable(kind: type[Any]) -> bool:
    """Return whether objects of a class cannot be other ones in part: numbers, texts, dates, views."""
    is_dated = kind.__module__ in _TEXTUAL and kind in vars(sys.modules[kind.__module__]).values()
    return kind in _FIXED or kind is MappingProxyType or is_dated


def _is_exact(value: Any) -> bool:
    """Return whether a value is a decimal or fraction, which cannot be combined with operators' floats."""
    return type(value).__name__ in ("Decimal", "Fraction") and is_textual(value)


def data_of(value: Any) -> Any:
    """Return a value as operators see it; ``UNKNOWN`` if it is opaque.

    It is the value itself where it is plain, or of numpy, or a member of an enumeration. Decimals and
    fractions become floating-point numbers, of which ``in_place_of`` makes the like of what was there. An
    integer, decimal or fraction beyond all floating-point numbers is opaque.
    """
    return _data_of(value, DEPTH)


def _data_of(value: Any, depth: int) -> Any:
    kind = type(value)
    if kind in _FIXED or kind is bytearray or kind is array:
        return UNKNOWN if kind is int and abs(value) > _LARGEST else value
    if is_of_numpy(value):
        return value if value.shape or not hasattr(value, "__array_finalize__") else value[()]
    if is_textual(value):
        return _as_float(value) if _is_exact(value) else value
    if is_member(value):
        return value
    for base, plainly in _PLAINLY:
        if issubclass(kind, base):
            return _data_of(plainly(value), depth)
    for base in (list, tuple):
        if issubclass(kind, base):
            return _items(value, base, depth)
    items = items_of(value)
    if items is None or depth <= 0:
        return UNKNOWN
    parts = (*items, *items.values()) if isinstance(items, dict) else items
    return UNKNOWN if any(_data_of(part, depth - 1) is UNKNOWN for part in parts) else value


def _items(value: Any, base: Any, depth: int) -> Any:
    """Convert the items of a list or tuple; return the same object if none changes."""
    given, found = list(base.__iter__(value)), []
    for item in given if depth > 0 else (UNKNOWN,):
        found.append(_data_of(item, depth - 1))
        if found[-1] is UNKNOWN:
            return UNKNOWN
    is_same = type(value) is base and all(map(operator.is_, given, found))
    return value if is_same else base(found)


def in_place_of(before: Any, value: Any) -> Any:
    """Return a value in the class of the value it replaces, if possible; otherwise the value itself."""
    kind = type(before)
    if type(value) in (list, tuple) and issubclass(kind, type(value)):
        return _sequence(before, value)
    if value is None or kind is type(value) or kind in _FIXED:
        return value
    if _is_exact(before):
        return _exactly(before, value) if type(value) in (int, float) else value
    if is_of_numpy(before):
        is_scalar = not is_of_numpy(value) and not before.shape
        return before.dtype.type(value) if is_scalar and before.dtype.kind == "f" else value
    is_subclass = any(issubclass(kind, base) and type(value) is base for base, _ in _PLAINLY)
    return _made(kind, value, value) if is_subclass else value


def _as_float(value: Any) -> Any:
    """Return a decimal or fraction as operators see it; ``UNKNOWN`` if it is too large, or signals."""
    try:
        return float(value)
    except (OverflowError, ValueError):
        return UNKNOWN


def _exactly(before: Any, value: float) -> Any:
    """Return a value as a decimal or fraction, keeping all digits where only the sign differs."""
    number = _as_float(before)
    if value == number:
        return before
    return -before if value == -number else _made(type(before), value, repr(value))


def _sequence(before: Any, value: Any) -> Any:
    """Apply ``in_place_of`` to each item, if there are equally many."""
    base, kind = type(value), type(before)
    given = list(base.__iter__(before))
    if len(given) != len(value):
        return value
    items = [in_place_of(old, new) for old, new in zip(given, value, strict=True)]
    if kind is base:
        return base(items)
    return _made(getattr(kind, "_make", kind), value, items)


def _made(make: Callable[[Any], Any], value: Any, given: Any) -> Any:
    """Return what a class makes of a value; the value itself if the class does not accept it."""
    try:
        return make(given)
    except Exception:  # a class of the user's may do anything
        return value


def fields_of(value: Any) -> dict[str, Any] | None:
    """Return the stored fields of a dataclass or named tuple; None for anything else."""
    kind: Any = type(value)
    if issubclass(kind, tuple):
        names = getattr(kind, "_fields", None)
        return None if type(names) is not tuple else dict(zip(names, tuple.__iter__(value), strict=False))
    if not is_dataclass(kind):
        return None
    try:
        stored = object.__getattribute__(value, "__dict__")
    except AttributeError:  # it has slots
        stored = {}
    found: dict[str, Any] = {}
    for name in getattr(kind, "__dataclass_fields__"):  # noqa: B009  # mypy knows it for none
        found[name] = stored[name] if name in stored else _in_slot(type(value), value, name)
    return found


def _in_slot(kind: type[Any], value: Any, name: str) -> Any:
    for base in kind.__mro__:
        slot = vars(base).get(name)
        if type(slot) is MemberDescriptorType:
            try:
                return slot.__get__(value, kind)
            except AttributeError:  # nothing is in it
                return None
    return None


def items_of(value: Any) -> dict[Any, Any] | list[Any] | None:
    """Return the items of a plain container; None for anything else."""
    kind = type(value)
    if kind in _MAPPINGS:
        return dict(value)
    return list(value) if kind in _SEQUENCES else None
