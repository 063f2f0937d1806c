"""Calls that are made in the name of a frame: all of them stand where the frame does."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Callable
from types import CodeType
from typing import Any

import pytest

from mutabot.runtime.interception.dispatcher import caller_of

Place = tuple[int | None, int | None, int | None, int | None]


def caller_at(text: str, line: int, *, is_async: bool = False) -> tuple[Callable[..., Any], Place]:
    """What calls as the frame that calls ``here()`` in this text, which begins at this line; and where."""
    found: list[tuple[Callable[..., Any], Place]] = []

    def here(**_: int) -> None:
        frame = sys._getframe(1)
        place = list(frame.f_code.co_positions())[frame.f_lasti // 2]
        found.append((caller_of(frame, is_async), place))

    code = compile("\n" * (line - 1) + text, "mission.py", "exec")
    exec(code, {"here": here, "__name__": "mission"})
    return found[0]


def look() -> tuple[CodeType, Any]:
    frame = sys._getframe(1)
    return frame.f_code, frame.f_globals["__name__"]


@pytest.mark.parametrize("line", [1, 63, 64, 100, 5000, 70000])
@pytest.mark.parametrize(
    ("text", "width", "lines"),
    [
        ("here()", 6, 0),
        ("x = [0, here(), 1]", 6, 0),
        ("x = " + " " * 200 + "here()", 6, 0),
        ("here(\n\n\n a=1)", None, 3),
        ("here(" + "\n" * 200 + ")", None, 200),
    ],
)
def test_every_instruction_stands_where_the_call_does(
    text: str, width: int | None, lines: int, line: int
) -> None:
    caller, place = caller_at(text, line)
    code, name = caller(look, (), {})
    assert set(code.co_positions()) == {place}
    first, last, column, end = place
    assert (first, last) == (line, line + lines)
    assert None not in (column, end)
    if width is not None:
        assert column is not None
        assert (column, end) == (text.index("here()"), column + width)
    assert (code.co_name, code.co_filename, name) == ("<module>", "mission.py", "mission")


def test_calls_that_are_awaited_do_so_too() -> None:
    async def looked() -> tuple[CodeType, Any]:
        return look()

    caller, _ = caller_at("here()", 12, is_async=True)
    coroutine = caller(looked, (), {})
    assert set(coroutine.cr_code.co_positions()) == {(12, 12, 0, 6)}
    assert asyncio.run(coroutine)[1] == __name__
