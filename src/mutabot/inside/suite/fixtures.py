"""The objects that the fixtures of a test hold, whichever test they were set up for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import islice
from typing import Any

import pytest

#: parts that are looked at in what a fixture gives
_MOST = 1000


def objects_of_fixtures(item: pytest.Item) -> Iterator[Any]:
    """What the test's fixtures gave and what lies right in that; the object of its class likewise."""
    given = list(getattr(item, "funcargs", {}).values())
    owner = getattr(getattr(item, "obj", None), "__self__", None)
    for one in given if owner is None else [*given, type(owner), owner]:
        yield one
        yield from islice(_parts(one), _MOST)


def _parts(value: Any) -> Iterator[Any]:
    if isinstance(value, Mapping):
        yield from value.values()
    elif isinstance(value, list | tuple | set | frozenset):
        yield from value
    else:
        yield from list(getattr(value, "__dict__", {}).values())
