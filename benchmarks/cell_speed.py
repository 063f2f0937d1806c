"""How much faster than real time is the paper's program in the cell, and how close to bare MuJoCo?

    python benchmarks/cell_speed.py [runs]

Every run prints, side by side, the real-time factors of the whole mission, of its motions alone (without
planning), and of a bare loop of `mj_step` over the same inputs of the servos that reads nothing back; and how
many times longer than bare mission and motions take. All of processor time, which other work on the machine
disturbs less than wall time; the median over the runs is the figure. Start-up is shown apart: from a fresh
interpreter to a ready, homed cell (best and median of several processes). Then the real-time factors of cells
with 1, 8 and 27 boxes in layers of nine, beside that of bare steps of the physics, in turns in one process;
and of the program of `examples/palletising`, which fills a pallet.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

    from mutabot_cell import Box, Cell
    from mutabot_cell.simulation import Simulation

EXAMPLE = Path(__file__).resolve().parent.parent / "examples" / "paper"
sys.path.insert(0, str(EXAMPLE))
# as in campaigns: idle threads of the linear algebra would count as processor time
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

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
        found["bare"].append(1.0 / taken(bare))
        found["waiting"].append(ratio(cell, partial(cell.wait, 1.0)))
        found["moving"].append(ratio(cell, swing))
    told = ", ".join(f"{name} {statistics.median(ratios):.0f}" for name, ratios in found.items())
    print(f"{count} boxes: times real time: {told}")


def palletising() -> None:
    """Print the ratio of a whole pallet of 27 boxes, and of bare steps of that cell afterwards."""
    import mujoco  # noqa: PLC0415

    from mutabot_cell import Cell, gen3, suction_cup  # noqa: PLC0415

    folder = EXAMPLE.parent / "palletising"
    sys.path[:0] = [str(folder), str(folder / "tests")]
    program, layout = import_module("palletising"), import_module("layout")
    robot, scene = gen3().with_tool(suction_cup(0.030)), layout.scene(*layout.on_belt(27))
    cell = Cell(0, robot=robot, scene=scene)
    whole = ratio(cell, partial(program.run, cell))

    def bare() -> None:
        for _ in range(500):
            mujoco.mj_step(cell.simulation.model, cell.simulation.data)

    told = f"whole pallet {whole:.0f} ({cell.time:.0f} s), bare steps {1.0 / taken(bare):.0f}"
    print(f"palletising: times real time: {told}")


def taken(work: Callable[[], object]) -> float:
    """Processor time of `work`, s."""
    start = time.process_time()
    work()
    return time.process_time() - start


def ratio(cell: Cell, work: Callable[[], None]) -> float:
    """Simulated time over processor time."""
    start = cell.time
    spent = taken(work)
    return (cell.time - start) / spent


def recorded_inputs(cell: Cell, program: Callable[[], None]) -> list[np.ndarray]:
    """Inputs of all servos at every physics step while the program runs on the cell."""
    inputs: list[np.ndarray] = []
    cell.simulation.after_tick.append(lambda: inputs.extend(cell.simulation.setpoints.copy()))
    program()
    return inputs


def step_bare(simulation: Simulation, inputs: list[np.ndarray]) -> float:
    """Processor time of `mj_step` with these inputs, s."""
    import mujoco  # noqa: PLC0415  (after the start-up times)

    model, data, step = simulation.model, simulation.data, mujoco.mj_step
    servos = data.ctrl  # each reading of an attribute makes a new view

    def loop() -> None:
        for row in inputs:
            servos[:] = row
            step(model, data)

    return taken(loop)


def run_mission(cell: Cell, program: Callable[[], None]) -> tuple[float, float]:
    """Processor time of the program, and of that what the clock takes: motions and waiting, s."""
    advance, motions = cell.simulation.tick, [0.0]

    def tick(most: int = 1) -> float:
        start = time.process_time()
        now: float = advance(most)
        motions[0] += time.process_time() - start
        return now

    cell.simulation.tick = tick  # type: ignore[method-assign]
    return taken(program), motions[0]


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
    rows = []
    for seed in range(runs):
        recorded = Cell(seed)
        kinova.connect(recorded)
        inputs = recorded_inputs(recorded, mission.run)
        bare = step_bare(Cell(seed).simulation, inputs)
        cell = Cell(seed)
        kinova.connect(cell)
        whole, motions = run_mission(cell, mission.run)
        rows.append((cell.time / whole, cell.time / motions, cell.time / bare, whole / bare, motions / bare))
        print(f"seed {seed}: {cell.time:.2f} s simulated; {_told(rows[-1])}")
    medians = tuple(statistics.median(column) for column in zip(*rows, strict=True))
    print(f"median: {_told(medians)} (aims: mission at least 60, motions at most 1.25 times bare)")
    for count in (1, 8, 27):
        with_boxes(count)
    palletising()


def _told(row: tuple[float, ...]) -> str:
    mission, motions, bare, whole_ratio, motions_ratio = row
    return (
        f"times real time: mission {mission:.0f}, motions {motions:.0f}, bare {bare:.0f}; "
        f"times bare: mission {whole_ratio:.2f}, motions {motions_ratio:.2f}"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10)
