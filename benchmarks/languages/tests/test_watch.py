"""Does the arm go up and half of the way down, and does the gripper close after two pulses?"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from mutabot_cell import Cell
from mutabot_languages.loader import RobotProgram


@pytest.mark.parametrize("wanted", [1, 2])
def test_the_gripper_closes_after_two_pulses(
    new_cell: Callable[..., Cell], mutabot_seed: int, program: RobotProgram, wanted: int
) -> None:
    cell = new_cell(mutabot_seed)

    def pulse() -> bool:
        return cell.time < 0.2 * wanted and int(cell.time * 10 + 0.001) % 2 == 1

    before, heights = cell.truth.tool_pose().z, list[float]()

    def note_height() -> bool:
        heights.append(cell.truth.tool_pose().z - before)
        return True

    cell.always(note_height, "heights are noted")
    ended = program.run(cell, inputs={"diPulse": pulse, "$IN[1]": pulse, "standard_digital_in[1]": pulse})

    assert ended.variables["pulses"] == wanted
    assert cell.gripper.commanded() == (1 if wanted == 2 else 0)
    assert max(heights) == pytest.approx(0.04, abs=0.004)
    assert heights[-1] == pytest.approx(0.02, abs=0.004)
    assert ended.seconds < 2.5
