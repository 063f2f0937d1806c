"""Calls that are also places of the program text: what is asked there, and what of it stands where."""

from __future__ import annotations

import ast
import asyncio
import builtins
import inspect
from pathlib import Path
from textwrap import indent
from types import FrameType
from typing import Any

import pytest

from mutabot.model import Role
from mutabot.model.program_text import RUNTIME
from mutabot.runtime.program_text import call_sites
from mutabot.runtime.program_text.call_sites import CALLS, CallSite, CallSites
from mutabot.runtime.program_text.instrument import instrumented
from mutabot.runtime.program_text.switches import Alternatives, Sightings
from mutabot_source.registry import names
from mutabot_source.texts import find_texts

NAMES = frozenset({"move_left", "move_right", "position"})
#: the last one has an alternative that calls an operation as well: move_right
CALLING = """
await arm.position()
x = (await arm.position()) + 1
(arm.move_left if arm.position() else arm.move_right)(2)
if arm.position or arm.move_left: pass
go = arm.move_left
go(3)
list(map(arm.move_left, [1, 2]))
arm.move_left(4)
(arm
 .move_left(
    5))
"""


class _Arm:
    def __init__(self) -> None:
        self.log: list[Any] = []

    def move_left(self, dx: float) -> None:
        self.log.append(("left", dx))

    def move_right(self, dx: float) -> None:
        self.log.append(("right", dx))

    def position(self) -> Any:
        return _Awaitable()


class _Awaitable(int):
    def __await__(self) -> Any:
        yield from ()
        return 1


def _seen(text: str, tree: ast.Module) -> tuple[list[Any], list[Any]]:
    """What the hooks are asked while the program runs, and what the arm does."""
    asked = []

    def note(site: CallSite, found: Any, receiver: Any, frame: FrameType) -> Any:
        position = inspect.getframeinfo(frame).positions
        what = site.name, site.extent, site.is_handed, site.is_given, site.is_awaited
        asked.append((*what, found.__name__, position.lineno if position is not None else None))
        return found

    sites = CallSites(NAMES, lambda path: Role.PROGRAM, note, hands=note)
    sites.change(tree, text.encode(), "mission.py")
    program: dict[str, Any] = {}
    exec(compile(tree, "mission.py", "exec"), program)
    arm = _Arm()
    asyncio.run(program["run"](arm))
    return asked, arm.log


@pytest.mark.parametrize("record", [True, False])
@pytest.mark.parametrize("family", ["conventional", "bugs"])
def test_places_of_the_text_change_nothing_of_the_calls_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, family: str, record: bool
) -> None:
    text = f"async def run(arm):\n{indent(CALLING, '    ')}"
    (tmp_path / "mission.py").write_text(text)
    monkeypatch.setattr(builtins, CALLS, call_sites._entries, raising=False)
    plain = _seen(text, ast.parse(text))
    (found,) = find_texts(tmp_path, ["mission.py"], names(family), first=1)
    places = {place.number: place for place in found.places}
    assert places
    switches = Sightings(max(places), places) if record else Alternatives(max(places))
    monkeypatch.setattr(builtins, RUNTIME, switches.switches, raising=False)
    assert _seen(text, instrumented(ast.parse(text), found.places, record=record)) == plain
    assert len(plain[0]) > len(plain[1]) == 6
