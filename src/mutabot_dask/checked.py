"""Whether data that a worker sent are what they should be, before anything is made of them.

Workers may be broken, of another version, or hostile. What does not fit is told in words that name the place.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import is_dataclass
from functools import cache
from typing import Any, TypeVar, get_type_hints

from mutabot.border.codec import from_data

#: bytes of an answer, levels of lists in it, and the size of counts: none that makes sense comes near
MOST_BYTES, _DEEPEST, _MOST = 64 << 20, 64, 10**15
#: integers in the user's own data; greater ones are no fractions that could be compared
_GREATEST = 2**1023
#: fields that are measured by us, and finite
_MEASURED = {"wall", "cpu"}
#: characters of a message
_SHOWN = 200

T = TypeVar("T")


class Misfit(ValueError):  # noqa: N818  # it is a finding
    """Data that are not what they should be."""


def read(data: bytes) -> Any:
    """What stands in bytes of JSON, with texts that can be stored. Raises Misfit."""
    if len(data) > MOST_BYTES:
        raise Misfit(f"{len(data)} bytes, more than {MOST_BYTES}")
    try:
        return _plain(json.loads(data.decode("utf-8")), 0)
    except RecursionError:
        raise Misfit(f"lists deeper than {_DEEPEST} levels") from None
    except UnicodeDecodeError:
        raise Misfit("no text in UTF-8") from None
    except Misfit:
        raise
    except ValueError as error:
        raise Misfit(f"no JSON ({error})"[:_SHOWN]) from None


def checked(kind: type[T], data: Any) -> T:
    """The value of a type in such data. Raises Misfit."""
    try:
        found = from_data(kind, data)
        _check_numbers(found)
    except (TypeError, ValueError, KeyError, OverflowError) as error:
        text = str(error) if isinstance(error, Misfit) else f"{type(error).__name__}: {error}"
        raise Misfit(text[:_SHOWN]) from None
    return found


def _plain(value: Any, depth: int) -> Any:
    """A value with storable texts: of characters that come in halves only the whole ones."""
    if depth > _DEEPEST:
        raise Misfit(f"lists deeper than {_DEEPEST} levels")
    if isinstance(value, str):
        return value if value.isascii() else value.encode("utf-8", "backslashreplace").decode("utf-8")
    if isinstance(value, list):
        return [_plain(item, depth + 1) for item in value]
    if isinstance(value, dict):
        return {_plain(key, depth): _plain(item, depth + 1) for key, item in value.items()}
    if isinstance(value, int) and abs(value) >= _GREATEST:
        raise Misfit("a number of more than 300 digits")
    return value


def _check_numbers(value: Any) -> None:
    """Raise Misfit for counts and times that are none; the user's own data may hold any number."""
    kind: Any = type(value)
    for name, is_own in _fields(kind).items():
        item = getattr(value, name)
        for one in item if isinstance(item, tuple) else (item,):
            if is_dataclass(one):
                _check_numbers(one)
        if is_own and any(abs(number) > _MOST for number in _integers(item)):
            raise Misfit(f"{name}: {item!r} is no count")
        if name in _MEASURED and not 0 <= item < math.inf:
            raise Misfit(f"{name}: {item} is no time")


def _integers(item: Any) -> Iterator[int]:
    if isinstance(item, int):
        yield item
    elif isinstance(item, Mapping | tuple):
        for one in item.values() if isinstance(item, Mapping) else item:
            yield from _integers(one)


@cache
def _fields(kind: Any) -> dict[str, bool]:
    """The fields of a dataclass, and whether each is mutabot's own: then its type says all."""
    return {name: "Any" not in str(hint) for name, hint in get_type_hints(kind).items()}
