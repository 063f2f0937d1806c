"""Does the unmutated program of `examples/paper` pass its own test, whatever the seed?

    python benchmarks/paper_seeds.py [seeds]

Runs the program once per seed in this process and judges it by the test's own readings, numbers and rounding.
Prints how many passed per colour, and the largest deviations.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from pathlib import Path

EXAMPLE = Path(__file__).resolve().parent.parent / "examples" / "paper"
sys.path[:0] = [str(EXAMPLE), str(EXAMPLE / "tests")]

import expected as criteria  # noqa: E402
import kinova  # noqa: E402
import mission  # noqa: E402
import sensors  # noqa: E402

from mutabot_cell import Cell, CellError, Position  # noqa: E402


def judge(expected: Position, reading: Position, threshold: float, deviations: list[float]) -> bool:
    """The test's criterion on all three axes; notes the deviations in m."""
    fine = True
    for axis in ("x", "y", "z"):
        wanted, read = getattr(expected, axis), getattr(reading, axis)
        deviations.append(abs(wanted - read))
        fine &= criteria.is_within(wanted, read, threshold)
    return fine


def main(count: int) -> int:
    """Run `count` seeds; the exit code is 0 if all pass."""
    total: Counter[str] = Counter()
    passed: Counter[str] = Counter()
    worst: dict[str, list[float]] = {}
    start = time.perf_counter()
    simulated = 0.0
    for seed in range(count):
        cell = Cell(seed)
        kinova.connect(cell)
        colour = cell.sensors.colour()
        deviations: list[float] = []
        fine = judge(criteria.HOME, sensors.robot_home_position(), 0.02, deviations)
        fine &= judge(criteria.ON_CONVEYOR, sensors.box_start_position(), 0.01, deviations)
        try:
            mission.run()
        except CellError as error:
            print(f"seed {seed}: {error}")
            fine = False
        fine &= judge(criteria.TARGETS[colour], sensors.box_end_position(), 0.02, deviations)
        simulated += cell.time
        total[colour] += 1
        passed[colour] += fine
        worst[colour] = [max(pair) for pair in zip(worst.get(colour, deviations), deviations, strict=True)]
        if not fine:
            shown = " ".join(f"{1000 * value:.1f}" for value in deviations)
            print(f"seed {seed} ({colour}) failed; deviations in mm: {shown}")
    wall = time.perf_counter() - start
    ratio = simulated / wall
    print(f"passed {passed.total()} of {total.total()} seeds; {ratio:.0f} times real time, set-up included")
    for colour in sorted(total):
        columns = [f"{1000 * value:5.1f}" for value in worst[colour]]
        print(f"  {colour:5} {passed[colour]:4} of {total[colour]:4}; largest deviations in mm (x y z):")
        for name, index in (("robot at home", 0), ("box on the conveyor", 3), ("box at the end", 6)):
            print(f"        {name:20} {' '.join(columns[index : index + 3])}")
    return 0 if passed == total else 1


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 200))
