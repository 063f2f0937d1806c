"""Draw the pictures of the larger examples in docs/img, or film their programs.

Use: ``make pictures``, or ``MUJOCO_GL=egl python tools/example_pictures.py [NAMES] [--film FOLDER]``;
docs/cell.md says what that needs.
"""

from __future__ import annotations

import argparse
import importlib
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
from PIL import Image

from mutabot_cell import Cell
from mutabot_cell.clock import simulated_time
from mutabot_cell.display.camera import Camera, Pixels, View

ROOT = Path(__file__).parents[1]
SEED = 2
WIDTH, HEIGHT = 960, 600
#: pictures of a film in a second; it runs so many times faster than the clock of the cell
_RATE, _FASTER = 24, 4


Line = list[tuple[float, float, float]]


@dataclass(frozen=True)
class Scene:
    """What is drawn of an example.

    Attributes:
        begin: makes the station, given what makes cells, and returns what runs the program. It may add points
            to a line that is drawn, world frame, m.
        time: of the picture, simulated, s.
    """

    begin: Callable[[Callable[..., Cell], Line], Callable[[], object]]
    time: float
    view: View


def bin_picking(new_cell: Callable[..., Cell], _line: Line) -> Callable[[], object]:
    """The heap of the example's own tests."""
    station, program = _modules("station", "picking")
    built = station.build(new_cell, SEED, parts=12)
    return lambda: program.run(built.cell)


def dispensing(new_cell: Callable[..., Cell], line: Line) -> Callable[[], object]:
    """A housing that lies a little off, and its bead."""
    station, program = _modules("station", "sealing")
    nominal = station.Housing(program.NOMINAL_X, program.NOMINAL_Y, program.NOMINAL_Z, 0.0)
    built = station.build(new_cell, SEED, nominal, list(program.SEAM))
    tip = built.cell.simulation.data.site("tool").xpos
    drops = built.dispenser.drops

    def trace() -> None:
        if len(drops) > len(line):
            line.append(tuple(tip.tolist()))

    built.cell.simulation.after_tick.append(trace)
    return lambda: program.run(built)


def assembly(new_cell: Callable[..., Cell], _line: Line) -> Callable[[], object]:
    """A housing that gets a pin, a cover and four screws."""
    station, program = _modules("station", "assembling")
    built = station.build(new_cell, SEED)
    return lambda: program.run(built)


def handover(new_cell: Callable[..., Cell], _line: Line) -> Callable[[], object]:
    """Two bars."""
    station, program = _modules("station", "line")
    built = station.build(new_cell, SEED)
    return lambda: program.run(built)


SCENES = {
    "assembly": Scene(assembly, 35.0, View(135.0, -24.0, 1.05, (0.42, 0.0, 1.03))),
    "bin_picking": Scene(bin_picking, 9.0, View(165.0, -33.0, 1.6, (0.33, 0.0, 1.02))),
    "dispensing": Scene(dispensing, 14.0, View(150.0, -30.0, 1.15, (0.40, 0.0, 1.02))),
    "handover": Scene(handover, 6.6, View(100.0, -14.0, 2.3, (0.65, 0.0, 1.05))),
}


def _modules(*names: str) -> list[Any]:
    return [importlib.import_module(name) for name in names]


def main(arguments: list[str] | None = None) -> int:
    """The command. Examples have modules of equal names, so each has a process of its own."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(SCENES)}; all without")
    parser.add_argument("--to", type=Path, default=ROOT / "docs" / "img", help="folder of the pictures")
    parser.add_argument("--film", type=Path, metavar="FOLDER", help="write films there instead of pictures")
    given = parser.parse_args(arguments)
    if unknown := set(given.names) - SCENES.keys():
        parser.error(f"no example {', '.join(sorted(unknown))}; there are {', '.join(SCENES)}")
    if len(given.names) == 1:
        draw(given.names[0], given.to, given.film)
        return 0
    options = ["--to", str(given.to), *(["--film", str(given.film)] if given.film else [])]
    commands = [[sys.executable, __file__, name, *options] for name in given.names or SCENES]
    return max(subprocess.run(command, check=False).returncode for command in commands)


def draw(name: str, pictures: Path, films: Path | None) -> None:
    """Run the program of an example, and take a picture or a film of it."""
    sys.path.insert(0, str(ROOT / "examples" / name))
    scene, line = SCENES[name], Line()
    with ExitStack() as stack:

        def new_cell(*args: Any, **options: Any) -> Cell:
            cell = Cell(*args, **options)
            stack.enter_context(simulated_time(cell))
            camera = Camera(cell.simulation, HEIGHT, WIDTH, scene.view)
            stack.callback(camera.close)

            def picture() -> Pixels:
                return camera.picture([line] if len(line) > 1 else [])

            if films is None:
                take = _picture(picture, pictures / f"{name}.jpg", scene.time)
            else:
                films.mkdir(parents=True, exist_ok=True)
                take = stack.enter_context(_film(picture, films / f"{name}.mp4"))
            cell.simulation.after_tick.append(lambda: take(cell.simulation.time))
            return cell

        scene.begin(new_cell, line)()


def _picture(picture: Callable[[], Pixels], file: Path, time: float) -> Callable[[float], None]:
    """Return what writes a picture when the clock comes to a time, s."""
    left = [time]

    def take(now: float) -> None:
        if left and now >= left[0]:
            left.clear()
            Image.fromarray(picture()).save(file, quality=85, optimize=True)

    return take


@contextmanager
def _film(picture: Callable[[], Pixels], file: Path) -> Iterator[Callable[[float], None]]:
    """Give what adds a picture to a film whenever one is due."""
    frame: Any = av.VideoFrame
    with av.open(str(file), "w") as video:
        stream: Any = video.add_stream("libx264", rate=_RATE, options={"crf": "23"})
        stream.width, stream.height, stream.pix_fmt = WIDTH, HEIGHT, "yuv420p"
        stream.time_base = Fraction(1, _RATE)
        count = 0

        def take(now: float) -> None:
            nonlocal count
            if now >= count * _FASTER / _RATE:
                count += 1
                for packet in stream.encode(frame.from_ndarray(picture(), format="rgb24")):
                    video.mux(packet)

        yield take
        for packet in stream.encode():
            video.mux(packet)


if __name__ == "__main__":
    sys.exit(main())
