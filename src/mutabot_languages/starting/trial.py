"""One run of a program on the cell, in a process of its own: where everything ends."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

#: arms of the cell that a program is tried on, in this order
ARMS = ("gen3", "ur5e", "xarm7", "panda")
#: simulated seconds after which a program has no end of its own
LONGEST = 60.0
#: seconds that a trial may take
_PATIENCE = 120.0
_SCRIPT = """
import json, sys
from mutabot_cell import Box, Cell, Scene, robots
from mutabot_languages import load
arm, cell_map, longest, *files = json.loads(sys.argv[1])
cell = Cell(seed=1, robot=getattr(robots, arm)(), scene=Scene(parts=(Box(),)))
run = load(*files, cell_map=cell_map).run(cell, until=lambda: cell.time > longest)
pose, box = cell.truth.tool_pose(), cell.truth.box_position()
print(json.dumps([run.seconds, [pose.x, pose.y, pose.z], [box.x, box.y, box.z], run.notes]))
"""


@dataclass(frozen=True, slots=True)
class ProgramTrial:
    """What one run showed.

    Attributes:
        arm: that it was made with.
        seconds: simulated time, s.
        tool, box: where they end: robot base frame and world frame, m.
        notes: what had no effect.
        problem: why the program stopped; empty if it did not.
    """

    arm: str
    seconds: float = 0.0
    tool: tuple[float, ...] = ()
    box: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()
    problem: str = ""

    @property
    def is_endless(self) -> bool:
        """Whether the program was still running."""
        return self.seconds > LONGEST


def tried(
    files: Sequence[Path], cell_map: str, missing: tuple[str, str, list[str]] | None = None
) -> ProgramTrial:
    """Run a program on the first arm that it runs on; where it runs on none, what the first one showed.

    Args:
        files: of the program.
        cell_map: the text of its cell map.
        missing: the name and the text of one more file, which does not exist yet, if there is one.
    """
    with tempfile.TemporaryDirectory() as folder:
        if missing is not None:
            draft = Path(folder, missing[0])
            draft.write_text(missing[1], encoding="utf-8")
            files = [*files, draft]
        signals = Path(folder, "cell_map.toml")
        signals.write_text(cell_map, encoding="utf-8")
        first: ProgramTrial | None = None
        for arm in ARMS:
            found = _run(arm, [str(signals), LONGEST, *map(str, files)])
            if not found.problem:
                return found
            first = first or found
            if not is_of_the_arm(found.problem):
                break
    assert first is not None
    return first


def is_of_the_arm(problem: str) -> bool:
    """Return whether another arm may carry out what stopped the program."""
    return any(name in problem for name in ("unreachable", "MotionRefused", "ProtectiveStop"))


def _run(arm: str, arguments: list[Any]) -> ProgramTrial:
    command_line = [sys.executable, "-c", _SCRIPT, json.dumps([arm, *arguments])]
    try:
        done = subprocess.run(command_line, capture_output=True, text=True, check=False, timeout=_PATIENCE)
    except subprocess.TimeoutExpired:
        return ProgramTrial(arm, problem=f"the run took more than {_PATIENCE:g} s")
    if done.returncode:
        return ProgramTrial(
            arm, problem=(done.stderr.strip().splitlines() or ["it ended without a word"])[-1]
        )
    seconds, tool, box, notes = json.loads(done.stdout.splitlines()[-1])
    return ProgramTrial(arm, seconds, tuple(tool), tuple(box), tuple(notes))
