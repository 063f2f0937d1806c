"""How much faster than real time does one run of the paper's program simulate, on one core?

    python benchmarks/cell_speed.py [runs]

Prints per run the simulated time of the program (planning included), the wall time, the processor time and
the ratio to the latter, which other work on the machine does not disturb. Start-up is shown apart: from a
fresh interpreter to a ready, homed cell (best and median of several processes). Then the same ratio for cells
with 1, 8 and 27 boxes in layers of nine, beside that of bare steps of the physics, in turns in one process.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mutabot_cell import Box, Cell

EXAMPLE = Path(__file__).resolve().parent.parent / "examples" / "paper"
sys.path.insert(0, str(EXAMPLE))

START = "from mutabot_cell import Cell; Cell(1)"
START_AND_PLAN = START + ".arm.move_by(z=0.001)"


def start_up(code: str, processes: int = 7) -> tuple[float, float]:
    """Best and median wall time of a fresh interpreter that runs `code`, s."""
    times = []
    for _ in range(processes):
        start = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True)
        times.append(time.perf_counter() - start)
    return min(times), statistics.median(times)


def layers(count: int) -> tuple[Box, ...]:
    """Boxes on the table in layers of three by three, 2 mm apart."""
    from mutabot_cell import Box  # noqa: PLC0415

    return tuple(
        Box(
            name=f"box {number}",
            position=(-0.6 + number // 3 % 3 * 0.052, 0.1 + number % 3 * 0.052, 0.76 + number // 9 * 0.05),
        )
        for number in range(count)
    )


def with_boxes(count: int, rounds: int = 5) -> None:
    """Print the ratios of a cell that falls in, that waits and that moves, and of bare steps beside each."""
    import mujoco  # noqa: PLC0415

    from mutabot_cell import Cell, Scene  # noqa: PLC0415

    def bare() -> None:
        for _ in range(500):
            mujoco.mj_step(cell.simulation.model, cell.simulation.data)

    def swing() -> None:
        cell.arm.move_by(y=0.2)
        cell.arm.move_by(y=-0.2)

    found: dict[str, list[float]] = {"settling": [], "bare": [], "waiting": [], "moving": []}
    for seed in range(rounds):
        cell = Cell(seed, scene=Scene(parts=layers(count)))
        found["settling"].append(ratio(cell, partial(cell.wait, 0.2)))
        cell.wait(1.0)
        found["bare"].append(1.0 / processor_time(bare))
        found["waiting"].append(ratio(cell, partial(cell.wait, 1.0)))
        found["moving"].append(ratio(cell, swing))
    told = ", ".join(f"{name} {statistics.median(ratios):.0f}" for name, ratios in found.items())
    print(f"{count} boxes: times real time: {told}")


def processor_time(work: Callable[[], None]) -> float:
    """What `work` takes, s."""
    start = time.process_time()
    work()
    return time.process_time() - start


def ratio(cell: Cell, work: Callable[[], None]) -> float:
    """Simulated time over processor time."""
    start = cell.time
    spent = processor_time(work)
    return (cell.time - start) / spent


def main(runs: int) -> None:
    """Print the figures."""
    for label, code in (
        ("interpreter alone", "pass"),
        ("to a ready, homed cell", START),
        ("to the end of a first straight-line move", START_AND_PLAN),
    ):
        best, median = start_up(code)
        print(f"start-up, {label}: best {best:.2f} s, median {median:.2f} s")

    import kinova  # noqa: PLC0415  (after the start-up times, so that they share nothing)
    import mission  # noqa: PLC0415

    from mutabot_cell import Cell  # noqa: PLC0415

    kinova.connect(Cell(0))
    kinova.Arm().move_by(z=0.001)  # loads the planner's libraries
    ratios = []
    for seed in range(runs):
        cell = Cell(seed)
        kinova.connect(cell)
        wall, processor = time.perf_counter(), time.process_time()
        mission.run()
        wall, processor = time.perf_counter() - wall, time.process_time() - processor
        ratios.append(cell.time / processor)
        print(
            f"seed {seed}: {cell.time:.2f} s simulated in {wall:.3f} s "
            f"({processor:.3f} s of processor time): {ratios[-1]:.0f} times real time"
        )
    median = statistics.median(ratios)
    print(f"real-time ratio: median {median:.0f}, lowest {min(ratios):.0f} (aim: at least 60)")
    for count in (1, 8, 27):
        with_boxes(count)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10)
