"""The robot is called by the program: what looks at its caller finds the program's line.

Warnings with ``stacklevel=2``, ``sys._getframe(1)`` and ``inspect.stack()[1]`` tell by whom a function was
called. Between the program and an operation there are frames of ours; the last of them has the program's
file, line, function and global names.
"""

from __future__ import annotations

from collections.abc import Callable
from types import CodeType, FrameType, FunctionType
from typing import Any

Caller = Callable[[Callable[..., Any], tuple[Any, ...], dict[str, Any]], Any]


def _call(wrapped: Any, args: Any, kwargs: Any, __tracebackhide__: bool = True) -> Any:
    return wrapped(*args, **kwargs)


async def _async_call(wrapped: Any, args: Any, kwargs: Any, __tracebackhide__: bool = True) -> Any:
    return await wrapped(*args, **kwargs)


#: code units of one entry of a table of places, and its kind: all of a span is told
_MOST_UNITS, _LONG = 8, 14


class Callers:
    """Makes calls in the name of frames."""

    def __init__(self) -> None:
        # the code is kept, so that no other can get its address
        self._made: dict[tuple[int, int, bool], tuple[Caller, CodeType, dict[str, Any]]] = {}

    def of(self, frame: FrameType, is_async: bool) -> Caller:
        """What makes a call as if this frame did, where it stands now."""
        code = frame.f_code
        key = (id(code), frame.f_lasti, is_async)
        known = self._made.get(key)
        if known is None or known[2] is not frame.f_globals:
            made = _made(code, frame.f_lasti, frame.f_globals, is_async)
            known = self._made[key] = (made, code, frame.f_globals)
        return known[0]


def _made(code: CodeType, instruction: int, names: dict[str, Any], is_async: bool) -> Caller:
    line, end_line, column, end_column = list(code.co_positions())[instruction // 2]
    line = line or code.co_firstlineno
    own = (_async_call if is_async else _call).__code__
    own = own.replace(
        co_name=code.co_name,
        co_qualname=code.co_qualname,
        co_filename=code.co_filename,
        co_firstlineno=line,
        co_linetable=_all_at(len(own.co_code) // 2, (end_line or line) - line, column or 0, end_column or 0),
    )
    return FunctionType(own, names, code.co_name, (True,))


def _all_at(units: int, lines: int, column: int, end_column: int) -> bytes:
    """A table that gives the span to all of a code: from its first line on, so many more lines.

    The format: CPython, Objects/locations.md (3.11 to 3.13). Compiling a tree with places takes ten times as
    long, and every fork calls from places where nothing has called before.
    """
    found = bytearray()
    for first in range(0, units, _MOST_UNITS):
        size = min(_MOST_UNITS, units - first)
        found.append(1 << 7 | _LONG << 3 | size - 1)
        for number in (0, lines, column + 1, end_column + 1):
            found += _varint(number)
    return bytes(found)


def _varint(number: int) -> bytes:
    """Six bits a byte, the lowest first; a seventh says that more follow."""
    if number < 1 << 6:
        return bytes([number])
    return bytes([1 << 6 | number & 0x3F]) + _varint(number >> 6)
