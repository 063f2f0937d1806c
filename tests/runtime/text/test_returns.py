"""What a program returns to its tests is noted, and nothing about the program changes."""

from __future__ import annotations

import asyncio
import importlib
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path
from textwrap import dedent
from types import ModuleType
from typing import Any

import pytest

from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.observation.probes import LONGEST, MOST, json_data
from mutabot.runtime.program_text.returns import LIMIT, Returns
from tests.runtime.stage import forget

PROGRAM = '''
    """A program."""
    from __future__ import annotations
    import asyncio
    import sys
    from dataclasses import dataclass

    @dataclass
    class Report:
        grips: int
        where: tuple

    class Mission:
        def __init__(self, start):
            self.start = start

        def report(self):
            return Report(inner(1), (self.start, 2.5))

        @property
        def double(self):
            return 2 * self.start

        @staticmethod
        def name():
            return "mission"

    def inner(value):
        "Only called by the program."
        return value

    def nothing():
        inner(2)

    def fails(text):
        """Fails."""
        inner(3)
        raise ValueError(text)

    def catches(text):
        try:
            fails(text)
        except ValueError:
            return "caught"

    def numbers():
        yield inner(1)
        return 5

    async def later(value):
        await asyncio.sleep(0)
        return value

    def twice(call):
        return [call(), call()]

    def deep(depth):
        return 0 if depth == 0 else 1 + deep(depth - 1)

    def njit(function):
        return function

    @njit
    def translated():
        return 1
'''


@pytest.fixture
def program(tmp_path: Path) -> Iterator[tuple[Returns, ModuleType]]:
    """A program in a project of its own; this file is a test of that project."""
    name = f"returning_{tmp_path.name}"
    path = tmp_path / f"{name}.py"
    path.write_text(dedent(PROGRAM), encoding="utf-8")
    root = Path(__file__).parents[3]
    returns = Returns(Locator(str(root), (str(path),), ()))
    sys.path.insert(0, str(tmp_path))
    returns.install()
    try:
        module = importlib.import_module(name)
        returns.start()
        yield returns, module
    finally:
        returns.stop()
        forget(returns)
        sys.path.remove(str(tmp_path))
        sys.modules.pop(name, None)


Noted = tuple[Returns, Any]


def test_values_that_leave_the_program_are_noted(program: Noted) -> None:
    returns, module = program
    mission = module.Mission(4)
    assert mission.report() == module.Report(1, (4, 2.5))
    assert mission.double == 8
    assert module.Mission.name() == "mission"
    assert module.nothing() is None
    assert returns.entries == [
        ("Mission.report", [{"grips": 1, "where": [4, 2.5]}]),
        ("Mission.double", [8]),
        ("Mission.name", ["mission"]),
    ]


def test_what_functions_raise_is_noted_and_the_traceback_stays(program: Noted) -> None:
    returns, module = program
    with pytest.raises(ValueError, match="too far") as caught:
        module.fails("too far")
    assert module.catches("x") == "caught"
    assert returns.entries == [("fails", {"raised": "ValueError: too far"}), ("catches", ["caught"])]
    last = traceback.extract_tb(caught.value.__traceback__)[-1]
    assert (last.line, last.name) == ("raise ValueError(text)", "fails")
    assert len(traceback.extract_tb(caught.value.__traceback__)) == 2
    assert caught.value.__context__ is None


def test_coroutines_are_noted_where_they_are_awaited_or_run(program: Noted) -> None:
    returns, module = program

    async def test() -> None:
        await module.later(1)

    asyncio.run(test())
    asyncio.run(module.later(2))
    assert returns.entries == [("later", [1]), ("later", [2])]


def test_generators_and_translated_functions_are_left_alone(program: Noted) -> None:
    returns, module = program
    assert list(module.numbers()) == [1]
    assert module.translated() == 1
    assert [name for name, _ in returns.entries] == []


def test_a_recursion_goes_as_deep_as_ever(program: Noted) -> None:
    returns, module = program
    depth = sys.getrecursionlimit() - len(traceback.extract_stack()) - 60
    assert module.deep(depth) == depth
    assert returns.entries == [("deep", [depth])]


def test_docstrings_names_and_signatures_stay(program: Noted) -> None:
    _, module = program
    assert module.inner.__doc__ == "Only called by the program."
    assert module.fails.__doc__ == "Fails."
    assert module.__doc__ == "A program."
    assert module.inner.__code__.co_varnames == ("value",)


def test_only_so_many_are_noted_and_those_of_fixtures_are_distinguished(program: Noted) -> None:
    returns, module = program
    module.inner(0)
    returns.begin_call()
    for _ in range(LIMIT):
        module.inner(1)
    assert (len(returns.entries), returns.prepared, returns.is_on) == (LIMIT, 1, False)
    returns.stop()
    returns.start()
    assert returns.entries == []


@pytest.mark.parametrize(
    ("value", "data"),
    [
        (True, True),
        (b"ab", "b'ab'"),
        ({1: {"b", "a"}}, {"1": ["a", "b"]}),
        (1 + 2j, "(1+2j)"),
        (-(2**1024), "-0x1" + 256 * "0"),  # 1024 bits are 256 hexadecimal digits
        ([object()], [{"opaque": "builtins:object"}]),
        (list(range(MOST + 1)), {"opaque": "builtins:list"}),
    ],
)
def test_values_become_plain_data(value: object, data: object) -> None:
    assert json_data(value) == data


def test_large_values_are_distinguished_by_a_digest() -> None:
    first, second = list(range(LONGEST)), list(range(LONGEST + 1))
    assert json_data(first) == json_data(list(first)) != json_data(second)
    assert json_data("a" * 1000) == json_data("a" * 1000) != json_data("a" * 999 + "b")


def test_arrays_are_values_or_digests() -> None:
    numpy = pytest.importorskip("numpy")
    assert json_data(numpy.float32(0.5)) == 0.5
    assert json_data(numpy.eye(2)) == [[1.0, 0.0], [0.0, 1.0]]
    assert json_data(numpy.zeros(1000)) == json_data(numpy.zeros(1000)) != json_data(numpy.ones(1000))
