"""The picture of README: a survivor of the published program, with the original as a ghost beside it.

The mutant leaves out the last way down, so it lets the box go half a metre above the table. Both are shown at
the moment at which they let go; of the falling box there are several moments.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from PIL import Image, ImageDraw

from mutabot_cell import Cell
from mutabot_cell.display.camera import View
from mutabot_cell.display.looks.trace import draw_trace
from mutabot_cell.display.looks.visual import VisualModel
from mutabot_motion.pictures.fonts import font_of_size

ROOT = Path(__file__).parents[1]
#: its box is red
SEED = 2
VIEW = View(azimuth=42.0, elevation=-14.0, distance=1.62, look_at=(-0.16, 0.25, 1.13))
WIDTH, HEIGHT = 1200, 675
#: pictures are drawn larger by this: what belongs to which thing is known for whole pixels only
_FINER = 2
ORIGINAL, MUTANT = (64, 156, 222), (245, 107, 26)
#: the way down that the mutant leaves out, m, and when the box is shown after it was let go, s
_WAY_DOWN, _FALLING = -0.3, (0.12, 0.19, 0.245, 0.29)
_GHOST = 0.7

Trace = list[tuple[float, float, float]]


@dataclass(frozen=True)
class Shot:
    """A picture of a cell.

    Attributes:
        pixels: red, green and blue from 0 to 255, shape (height, width, 3).
        depth: from the camera, m, shape (height, width).
        bodies: the number of the body that each pixel shows, likewise; -1 for none.
        robot, box: which numbers are the robot's, and the box's.
    """

    pixels: Any
    depth: Any
    bodies: Any
    robot: frozenset[int]
    box: int

    def shows(self, *bodies: int) -> Any:
        """Which pixels show one of the bodies."""
        return np.isin(self.bodies, bodies)


class _Photographer:
    """Takes shots of a cell."""

    def __init__(self, cell: Cell, colour: tuple[int, int, int]) -> None:
        self._visual = VisualModel(cell.simulation)
        model = self._visual.model
        model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH * _FINER, HEIGHT * _FINER
        model.vis.quality.offsamples = 0  # numbers of shapes must not be mixed at edges
        self._renderer = mujoco.Renderer(model, HEIGHT * _FINER, WIDTH * _FINER)
        self._camera = mujoco.MjvCamera()
        self._camera.azimuth, self._camera.elevation = VIEW.azimuth, VIEW.elevation
        self._camera.distance, self._camera.lookat[:] = VIEW.distance, VIEW.look_at
        self._colour = colour
        root = model.body("robot").id
        self._robot = frozenset(body for body in range(model.nbody) if _is_below(model, body, root))
        self._box = int(model.body("box").id)

    def close(self) -> None:
        self._renderer.close()

    def shot(self, trace: Trace) -> Shot:
        self._visual.pose()
        renderer = self._renderer
        renderer.update_scene(self._visual.data, self._camera, self._visual.options)
        draw_trace(renderer.scene, trace, (*(part / 255 for part in self._colour), 1.0))
        pixels = renderer.render().astype(float)
        renderer.enable_depth_rendering()
        depth = renderer.render().copy()
        renderer.disable_depth_rendering()
        renderer.update_scene(self._visual.data, self._camera, self._visual.options)  # without the path
        renderer.enable_segmentation_rendering()
        found, kinds = np.moveaxis(renderer.render(), -1, 0)
        renderer.disable_segmentation_rendering()
        geoms = np.where(kinds == int(mujoco.mjtObj.mjOBJ_GEOM), found, -1)
        bodies = np.where(geoms < 0, -1, self._visual.model.geom_bodyid[geoms])
        return Shot(pixels, depth, bodies, self._robot, self._box)


def _is_below(model: mujoco.MjModel, body: int, root: int) -> bool:
    while body and body != root:
        body = int(model.body_parentid[body])
    return body == root


class _SeenEnoughError(Exception):
    """What comes then is of no interest."""


def main(picture: Path) -> None:
    """Write it, as JPEG."""
    sys.path.insert(0, str(ROOT / "examples" / "paper"))
    [original] = _shots(ORIGINAL, (0.0,))
    with _without_the_way_down():
        first, *falling = _shots(MUTANT, (0.0, *_FALLING))
    last = falling.pop()
    image = _with_ghost(last, original)
    for number, shot in enumerate((first, *falling)):
        image = _blended(image, shot.pixels, shot.shows(shot.box), 0.35 + 0.12 * number)
    small = image.reshape(HEIGHT, _FINER, WIDTH, _FINER, 3).mean(axis=(1, 3))
    done = Image.fromarray(small.round().clip(0, 255).astype(np.uint8))
    _label(done)
    done.save(picture, quality=90, optimize=True)


def _shots(colour: tuple[int, int, int], after: tuple[float, ...]) -> list[Shot]:
    """Shots of the published program so many seconds after it lets the box go."""
    import kinova  # noqa: PLC0415
    import mission  # noqa: PLC0415

    found: list[Shot] = []
    path: Trace = []
    waiting: list[float] = []
    command = kinova.Gripper.command

    def watched(gripper: kinova.Gripper, position: float) -> None:
        if cell.gripper.holding():
            waiting.extend(cell.time + seconds for seconds in after)
        command(gripper, position)

    def look() -> None:
        if not waiting:
            path.append(tuple(tool.tolist()))
        elif cell.time >= waiting[0]:
            found.append(photographer.shot(path))
            waiting.pop(0)
            if not waiting:
                raise _SeenEnoughError

    with Cell(SEED) as cell, _patched(kinova.Gripper, "command", watched):
        photographer = _Photographer(cell, colour)
        tool = cell.simulation.data.site("tool").xpos
        cell.simulation.after_tick.append(look)
        kinova.connect(cell)
        with suppress(_SeenEnoughError):
            mission.run()
        photographer.close()
    return found


@contextmanager
def _without_the_way_down() -> Iterator[None]:
    import kinova  # noqa: PLC0415

    move_by = kinova.Arm.move_by

    def moved(arm: kinova.Arm, **way: float) -> None:
        if way != {"z": _WAY_DOWN}:
            move_by(arm, **way)

    with _patched(kinova.Arm, "move_by", moved):
        yield


@contextmanager
def _patched(owner: type, name: str, function: Callable[..., Any]) -> Iterator[None]:
    before = getattr(owner, name)
    setattr(owner, name, function)
    try:
        yield
    finally:
        setattr(owner, name, before)


def _with_ghost(shot: Shot, other: Shot) -> Any:
    """A shot with robot, box and path of the other as a ghost, where nothing of its own is before them."""
    ghost = other.shows(*other.robot, other.box) & (other.depth < shot.depth + 0.002)
    ghost &= ~shot.shows(*shot.robot, shot.box)
    tinted = 0.5 * other.pixels + 0.5 * np.array(ORIGINAL)
    image = _blended(shot.pixels, tinted, ghost, _GHOST)
    way = (np.abs(other.pixels - np.array(ORIGINAL)).sum(axis=2) < 90) & ~ghost & ~other.shows(*other.robot)
    way &= ~shot.shows(*shot.robot, shot.box)
    return _blended(image, other.pixels, way, 0.9)


def _blended(image: Any, other: Any, where: Any, share: float) -> Any:
    mixed = (1.0 - share) * image + share * other
    return np.where(where[..., None], mixed, image)


def _label(image: Image.Image) -> None:
    draw = ImageDraw.Draw(image)
    lines = (
        ("original", "lowers the box before it lets go", ORIGINAL),
        ("mutant", "one motion left out: the box falls half a metre, and the test passes", MUTANT),
    )
    draw.rectangle((0, HEIGHT - 76, WIDTH, HEIGHT), fill=(17, 20, 23))
    for number, (name, text, colour) in enumerate(lines):
        y = HEIGHT - 66 + 30 * number
        draw.rectangle((20, y + 4, 34, y + 18), fill=colour)
        font_of_size(20).draw(draw, (46, y - 2), name, colour)
        font_of_size(18).draw(draw, (150, y), text, (233, 236, 239))


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "img" / "survivor.jpg")
