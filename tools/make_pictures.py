"""Draw the pictures of the cell in docs/img.

Use: ``make pictures``, or ``MUJOCO_GL=egl python tools/make_pictures.py [FOLDER]``; docs/cell.md says what
that needs. The drawn pixels differ a little from one graphics library to another.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

from mutabot_cell import Cell, render, robots
from mutabot_cell.scene import BASE_POSITION

ROOT = Path(__file__).parents[1]
#: its box is red
SEED = 2
WIDTH, HEIGHT = 800, 560


def main(folder: Path) -> None:
    """Write all of them."""
    with Cell(SEED) as cell:
        render(
            cell, folder / "cell.png", width=WIDTH, height=HEIGHT, azimuth=112.0, elevation=-24.0,
            distance=2.15, look_at=(0.15, 0.05, 0.96),
        )  # fmt: skip
    _another_arm_with_the_box(folder / "ur5e.png")
    _before_the_box_is_let_go(folder / "place.png")


def _another_arm_with_the_box(picture: Path) -> None:
    """A UR5e that has taken the box from the conveyor, with the tool's path."""
    path: list[tuple[float, float, float]] = []
    with Cell(SEED, robot=robots.ur5e()) as cell:
        tool = cell.simulation.data.site("tool").xpos
        cell.simulation.after_tick.append(lambda: path.append(tuple(tool.tolist())))
        box, down = cell.truth.box_position(), cell.arm.commanded_pose()
        above = replace(down, x=box.x, y=box.y, z=down.z - 0.1)
        cell.gripper.command(0)
        cell.arm.move_to(above)
        cell.arm.move_to(replace(above, z=box.z - BASE_POSITION[2] + 0.03))
        cell.gripper.command(1, wait=True)
        cell.arm.move_to(above)
        cell.arm.move_to(replace(above, y=above.y - 0.25))
        render(
            cell, picture, width=WIDTH, height=HEIGHT, azimuth=125.0, elevation=-18.0,
            distance=1.35, look_at=(0.27, 0.06, 1.15), trace=path,
        )  # fmt: skip


def _before_the_box_is_let_go(picture: Path) -> None:
    """The published program, when it opens the gripper above the table."""
    sys.path.insert(0, str(ROOT / "examples" / "paper"))
    import kinova  # noqa: PLC0415
    import mission  # noqa: PLC0415

    original = kinova.Gripper.command

    def command(gripper: kinova.Gripper, position: float) -> None:
        if cell.gripper.holding():
            render(
                cell, picture, width=WIDTH, height=HEIGHT, azimuth=43.0, elevation=-22.0,
                distance=2.0, look_at=(-0.12, 0.25, 1.0), trace=path,
            )  # fmt: skip
        original(gripper, position)

    kinova.Gripper.command = command
    path: list[tuple[float, float, float]] = []
    with Cell(SEED) as cell:
        tool = cell.simulation.data.site("tool").xpos
        cell.simulation.after_tick.append(lambda: path.append(tuple(tool.tolist())))
        kinova.connect(cell)
        mission.run()


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "img")
