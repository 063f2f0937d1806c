"""Calls that are seen where they are written: the text stays the user's in all that it shows."""

from __future__ import annotations

import ast
import builtins
import dis
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from textwrap import dedent
from types import CodeType, FrameType
from typing import Any

import pytest

from mutabot.model import Role
from mutabot.runtime.program_text.call_sites import CALLS, CallSite, CallSites
from tests.runtime.stage import forget

TEXT = """
    def chain(arm, *more, **named):
        return (arm
                .move(1)
                .turn(2, speed=3)
                .wait(*more)
                .stop(**named))

    class Task:
        grip = staticmethod(move(1))

        @rate.limit(
            3)
        async def go(self, arm):
            await (arm
                   .move(
                       1))
            with arm.hold(
                2
            ) as held:
                return [f"{arm.position():.2f}" for _ in arm.turn(1)], held

        def over(self):
            return super().move(1), (lambda: self.arm.stop())()
"""
NAMES = frozenset({"move", "turn", "wait", "stop", "limit", "hold", "position"})
CALLING = ("CALL", "CALL_KW", "CALL_FUNCTION_EX")


def _program(path: str) -> Role | None:
    return Role.PROGRAM if path == "mission.py" else None


def _as_it_stands(site: CallSite, found: Any, receiver: Any, frame: FrameType) -> Any:
    return found


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)


def _calls(code: CodeType) -> Counter[Any]:
    made = (instruction for instruction in dis.get_instructions(code) if instruction.opname in CALLING)
    return Counter(tuple(instruction.positions) for instruction in made if instruction.positions is not None)


@pytest.fixture
def sites() -> Iterator[Callable[..., CallSites]]:
    made: list[CallSites] = []

    def make(names: Collection[str], stands: Any = _as_it_stands) -> CallSites:
        made.append(CallSites(names, _program, stands))
        made[-1].install()
        return made[-1]

    before = getattr(builtins, CALLS, None)
    yield make
    for site in made:
        forget(site)
    if before is None and hasattr(builtins, CALLS):
        delattr(builtins, CALLS)


def _function(text: str, sites: CallSites) -> Any:
    tree = ast.parse(text)
    sites.change(tree, b"", "mission.py")
    names: dict[str, Any] = {}
    exec(compile(tree, "mission.py", "exec"), names)
    return names["go"]


def test_calls_and_lines_stand_where_they_are_written(sites: Callable[..., CallSites]) -> None:
    plain = compile(ast.parse(dedent(TEXT)), "mission.py", "exec")
    tree = ast.parse(dedent(TEXT))
    sites(NAMES).change(tree, b"", "mission.py")
    asked = compile(tree, "mission.py", "exec")
    for ours, written in zip(_codes(asked), _codes(plain), strict=True):
        assert not _calls(written) - _calls(ours), written.co_name
        lines = [{line for *_, line in code.co_lines() if line} for code in (ours, written)]
        assert lines[0] == lines[1]


def test_what_is_called_gets_its_arguments_as_written_from_whom_they_are(
    sites: Callable[..., CallSites],
) -> None:
    class Arm:
        def move(self, *given: Any, **named: Any) -> Any:
            return given, named, sys._getframe(1).f_code.co_name

    go = _function("def go(arm, more):\n    return arm.move(1, *more, x=2, **{'y': 3})\n", sites({"move"}))
    assert go(Arm(), [5]) == ((1, 5), {"x": 2, "y": 3}, "go")


def test_what_stands_there_is_reported_with_what_it_was_read_from(sites: Callable[..., CallSites]) -> None:
    told: list[Any] = []

    def stands(site: CallSite, found: Any, receiver: Any, frame: FrameType) -> Any:
        told.append((site.name, site.extent, frame.f_code.co_name, receiver))
        return lambda *given: "instead"

    text = "def go(items, append):\n    return items.append(1), append(2)\n"
    items: list[int] = []
    assert _function(text, sites({"append"}, stands))(items, print) == ("instead", "instead")
    assert items == []
    assert told[0][:3] == ("append", (2, 11, 2, 26), "go")
    assert told[1][:3] == ("append", (2, 28, 2, 37), "go")
    assert told[0][3] is items


def test_functions_that_are_translated_are_left_alone(sites: Callable[..., CallSites]) -> None:
    text = "@numba.njit\ndef go(arm):\n    arm.move(1)\n"
    tree = ast.parse(text)
    sites({"move"}).change(tree, b"", "mission.py")
    assert ast.unparse(tree) == ast.unparse(ast.parse(text))


MESSAGES = """
    class Arm:
        def __repr__(self):
            return "<Arm>"

        def position(self, of="tip"):
            return 3.0

    def position(*given):
        return 3.0

    def test_method():
        arm = Arm()
        assert arm.position(of="base") == 4.0

    def test_function():
        x = 1
        assert position(x, *[2]) < x or not position()

    def test_nested():
        assert abs(Arm().position()) == abs(position(Arm().position())) + 1
"""
HOOK = """
    from mutabot.runtime.program_text.call_sites import CallSites
    from mutabot.model import Role

    asked = []

    def stands(site, found, receiver, frame):
        asked.append(site.name)
        return found

    def pytest_configure():
        sites = CallSites({"position"}, lambda path: Role.ORACLE, stands)
        sites.install()
        sites.hook_pytest()

    def pytest_unconfigure():
        print("asked", len(asked))
"""


def test_messages_of_pytest_stay_as_they_are(tmp_path: Path) -> None:
    (tmp_path / "test_it.py").write_text(dedent(MESSAGES), encoding="utf-8")
    (tmp_path / "pytest.ini").write_text("[pytest]\n", encoding="utf-8")

    def run() -> tuple[list[str], str]:
        command = [sys.executable, "-B", "-m", "pytest", "-q", "-vv", "-p", "no:cacheprovider"]
        done = subprocess.run(
            [*command, "--color=no"], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        text = done.stdout
        return [line for line in text.splitlines() if line.startswith(("E ", ">", "test_it.py"))], text

    plain, _ = run()
    (tmp_path / "conftest.py").write_text(dedent(HOOK), encoding="utf-8")
    ours, text = run()
    assert "asked 6" in text
    assert any("where 3.0 = position(" in line for line in plain)
    assert ours == plain


def test_assignments_are_reported_before_they_are_made_and_worked_out_as_ever() -> None:
    told: list[Any] = []

    def stored(site: CallSite, holder: Any, values: list[Any]) -> None:
        told.append((site.name, site.extent[0], type(holder).__name__, values))

    text = """
def go(order, arm, tags):
    order("value", 1)
    tags[order("key", "gate")] = order("value", 2)
    order("holder", arm).speed = order("value", tags["gate"] + 1)
    arm.first = arm.second = 3
    tags[1:2], arm._hidden = [], 5
    arm._hidden = 6
    return arm.speed
"""
    sites = CallSites({"speed", "first", "second"}, _program, _as_it_stands, are_read=True, stored=stored)
    sites.install()
    try:
        go = _function(text, sites)
        worked_out: list[str] = []

        def order(name: str, value: Any) -> Any:
            worked_out.append(name)
            return value

        class Tags(dict[Any, Any]):
            def __setitem__(self, key: Any, value: Any) -> None:
                if isinstance(key, str):
                    super().__setitem__(key, value)

        assert go(order, Arm(), Tags()) == 3
    finally:
        forget(sites)
    assert worked_out == ["value", "value", "key", "value", "holder"]
    assert told == [("__setitem__", 4, "Tags", ["gate", 2]), ("speed", 5, "Arm", [3])]


class Arm:
    """An object that has any attribute."""
