"""The decorator that declares a function to be a behaviour."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

#: the behaviours by name, in the order in which their modules declare them
DECLARED: dict[str, Behaviour] = {}


@dataclass(frozen=True)
class Behaviour:
    """A function that does something with rclpy and returns a record of what happened."""

    name: str
    act: Callable[[], Any]
    #: the record that the documentation promises, if it does
    expected: Any = None
    #: the document that promises it
    source: str = ""


def behaviour(expected: Any = None, source: str = "") -> Callable[[Callable[[], Any]], Callable[[], Any]]:
    """Declare a behaviour; a record is expected only where a document says so."""
    if (expected is None) != (not source):
        raise ValueError("an expected record needs its source, and a source a record")

    def declare(function: Callable[[], Any]) -> Callable[[], Any]:
        name = function.__name__
        if name in DECLARED:
            raise ValueError(f"two behaviours are called {name}")
        DECLARED[name] = Behaviour(name, function, expected, source)
        return function

    return declare
