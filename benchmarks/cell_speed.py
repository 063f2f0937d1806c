"""How much faster than real time does one run of the paper's program simulate, on one core?

    python benchmarks/cell_speed.py [runs]

Prints per run the simulated time of the program (planning included), the wall time, the processor time and
the ratio to the latter, which other work on the machine does not disturb. Start-up is shown apart: from a
fresh interpreter to a ready, homed cell (best and median of several processes).
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from pathlib import Path

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


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10)
