"""Calls that are made in the name of a frame: all of them stand where the frame does."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Callable
from types import CodeType
from typing import Any

import pytest

from mutabot.runtime.interception.dispatcher import caller_of


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


def test_calls_that_are_awaited_do_so_too() -> None:
    async def looked() -> tuple[CodeType, Any]:
        return look()

    coroutine = caller_at("here()", 12, is_async=True)(looked, (), {})
    assert {place[:2] for place in coroutine.cr_code.co_positions()} == {(12, 12)}
    assert asyncio.run(coroutine)[1] == __name__
