"""What mocks at hand were called with, as expressions of a test: ``arm.move.call_args.kwargs["x"]``."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from operator import attrgetter
from typing import Any

#: marks the expressions of this module
CALL = ".call_"


def calls_of(text: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Yield how often a mock and its methods were called, and the arguments of each one's last call."""
    mocks = sys.modules.get("unittest.mock")
    if mocks is None or not isinstance(value, mocks.NonCallableMock):
        return
    if isinstance(value, mocks.CallableMixin) and value.called:
        yield from _of_last(text, value)
    for name in dict.fromkeys(name for name, _, _ in value.method_calls if "(" not in name):
        yield from _of_last(f"{text}.{name}", attrgetter(name)(value))


def _of_last(text: str, mock: Any) -> Iterator[tuple[str, Any]]:
    yield f"{text}{CALL}count", mock.call_count
    yield f"{text}{CALL}args.args", mock.call_args.args
    yield f"{text}{CALL}args.kwargs", mock.call_args.kwargs
