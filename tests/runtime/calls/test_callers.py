"""Calls that are made in the name of a frame: all of them stand where the frame does."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Callable
from types import CodeType
from typing import Any

import pytest

from mutabot.runtime.interception.dispatcher import _made, caller_of


def caller_at(text: str, line: int, *, is_async: bool = False) -> Callable[..., Any]:
    """What calls as the frame that calls ``here()`` in this text, which begins at this line."""
    found: list[Callable[..., Any]] = []

    def here(**_: int) -> None:
        found.append(caller_of(sys._getframe(1), is_async))

    code = compile("\n" * (line - 1) + text, "mission.py", "exec")
    exec(code, {"here": here, "__name__": "mission"})
    return found[0]


def look() -> tuple[CodeType, Any]:
    frame = sys._getframe(1)
    return frame.f_code, frame.f_globals["__name__"]


@pytest.mark.parametrize("line", [1, 63, 64, 100, 5000, 70000])
@pytest.mark.parametrize(
    "text",
    ["here()", "x = [0, here(), 1]", "here(\n\n\n a=1)", "here(" + "\n" * 200 + ")"],
)
def test_every_instruction_stands_in_the_line_of_the_call(text: str, line: int) -> None:
    code, name = caller_at(text, line)(look, (), {})
    assert {place[:2] for place in code.co_positions()} == {(line, line)}
    assert (code.co_name, code.co_filename, name) == ("<module>", "mission.py", "mission")


@pytest.mark.parametrize("distance", [1, 31, 32, 2047, 2048, 70000])
@pytest.mark.parametrize("is_async", [False, True])
def test_the_function_begins_where_it_begins(distance: int, is_async: bool) -> None:
    text = "\n" * 4 + "def tour():" + "\n" * distance + " here()\ntour()"
    code = caller_at(text, 1, is_async=is_async).__code__
    assert code.co_firstlineno == 5
    assert {place[:2] for place in code.co_positions()} == {(5 + distance, 5 + distance)}


def test_a_call_may_stand_before_the_line_in_which_its_code_begins() -> None:
    code = compile("here()", "mission.py", "exec")
    back = bytes([1 << 7 | 13 << 3 | 7, 64 | 27, 1])  # 45 lines before, as the format writes it
    early = code.replace(co_firstlineno=50, co_linetable=back + code.co_linetable)
    made = _made(early, 0, is_async=False)
    assert made.co_firstlineno == 50
    assert {place[0] for place in made.co_positions()} == {5}


def test_calls_that_are_awaited_do_so_too() -> None:
    async def looked() -> tuple[CodeType, Any]:
        return look()

    coroutine = caller_at("here()", 12, is_async=True)(looked, (), {})
    assert {place[:2] for place in coroutine.cr_code.co_positions()} == {(12, 12)}
    assert asyncio.run(coroutine)[1] == __name__
