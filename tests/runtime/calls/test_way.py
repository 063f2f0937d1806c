"""How many of our files one mutated call goes through: whoever follows a call opens these, and no more."""

from __future__ import annotations

import sys
from pathlib import Path
from types import FrameType
from typing import Any

import mutabot
from mutabot.model import Mutant, Role, Site
from tests.runtime.stage import Make, take_away

ROBOT = "class Arm:\n    def move_by(self, dx):\n        return None\n"
PROGRAM = "def run(arm):\n    arm.move_by(0.25)\n"
VOCABULARY = """
[[operation]]
call = "robot:Arm.move_by"
arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
"""
#: the call as it is written, what stands for the method, dispatcher, adapter, active mutant, trace, the
#: session that is told of a mutated call, and what drives an operator. The operator itself and plain data
#: do not count
MOST = 8


def test_a_mutated_call_goes_through_few_files(make_stage: Make) -> None:
    stage = make_stage(ROBOT, PROGRAM, VOCABULARY)
    recording = stage.session()
    stage.run(recording, "run", stage.load_robot().Arm())
    take_away(recording)
    sys.modules.pop(stage.program_name)
    (seen,) = stage.sites()
    site = Site(seen.span, "text", 1, Role.PROGRAM)
    session = stage.session(Mutant(1, "robot", "reverse", site, seen.operation, None, "dx", "", "", None))
    arm, program = stage.load_robot().Arm(), stage.load_program()
    program.run(arm)  # the first call makes what later ones find
    visited = files_of(lambda: program.run(arm))
    assert session.mutant is not None
    assert session.mutant.activity.acted == 2
    ours = [name for name in visited if name.startswith("runtime/") or name == "operators/middleware.py"]
    assert len(ours) <= MOST, ours


def files_of(action: Any) -> list[str]:
    """The files of ours whose functions are called, in the order of their first calls."""
    root = Path(mutabot.__file__).parent
    found: dict[str, None] = {}

    def hook(frame: FrameType, event: str, argument: Any) -> None:
        path = Path(frame.f_code.co_filename)
        if event == "call" and path.is_relative_to(root):
            found[path.relative_to(root).as_posix()] = None

    sys.setprofile(hook)
    try:
        action()
    finally:
        sys.setprofile(None)
    return list(found)
