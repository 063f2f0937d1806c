"""What an intercepted call costs, and what the part inside the program's process costs to import.

Usage: python benchmarks/interception.py
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
import timeit
from pathlib import Path
from unittest.mock import Mock

from mutabot.config.vocabulary import load_vocabulary
from mutabot.model.events import Event
from mutabot.model.job import Job
from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.session import Session

CALLS = 200_000
ROBOT = "class Arm:\n    def move_by(self, dx):\n        return None\n"
PROGRAM = "def run(arm):\n    arm.move_by(0.1)\n"
VOCABULARY = """
[[operation]]
call = "bench_robot:Arm.move_by"
arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
"""
IMPORT = """
import pytest, time
start = time.process_time()
import mutabot.runtime.session_hooks
print((time.process_time() - start) * 1e3)
"""


class Nowhere:
    """An event writer that writes nothing."""

    def send(self, line: Event) -> None:
        """Forget the line."""


def main() -> None:
    """Print the costs in µs and ms, best of several."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "bench_robot.py").write_text(ROBOT, encoding="utf-8")
        (folder / "bench_program.py").write_text(PROGRAM, encoding="utf-8")
        (folder / "bench_elsewhere.py").write_text(ROBOT + PROGRAM, encoding="utf-8")
        (folder / "robot.toml").write_text(VOCABULARY, encoding="utf-8")
        sys.path.insert(0, name)
        _calls(folder)
    _import()


def _calls(folder: Path) -> None:
    job = Job(str(folder), ("bench_program.py",), (), load_vocabulary(["robot.toml"], folder), 1, 0)
    locator = Locator(job.root, job.program, job.oracle)
    session = Session(job, Nowhere(), locator)
    session.install()
    import bench_elsewhere  # noqa: PLC0415  # made above
    import bench_program  # noqa: PLC0415
    import bench_robot  # noqa: PLC0415

    arm, other, mock = bench_robot.Arm(), bench_elsewhere.Arm(), Mock(spec=bench_robot.Arm)
    plain = _per_call(lambda: bench_elsewhere.run(other))
    of_mock = _per_call(lambda: bench_elsewhere.run(mock))
    print(f"a plain call                        {plain:7.2f} µs")
    print(
        f"of something else of the same name +{_per_call(lambda: bench_program.run(other)) - plain:7.2f} µs"
    )
    print(f"intercepted, nothing active        +{_per_call(lambda: bench_program.run(arm)) - plain:7.2f} µs")
    session.start_test("test")
    print(f"intercepted and recorded           +{_per_call(lambda: bench_program.run(arm)) - plain:7.2f} µs")
    print(
        f"the same where a mock stands       +{_per_call(lambda: bench_program.run(mock)) - of_mock:7.2f} µs"
    )


def _per_call(function: object) -> float:
    """µs per call, the best of seven tries."""
    used = timeit.repeat(function, timer=time.process_time, number=CALLS // 20, repeat=7)  # type: ignore[arg-type]
    return min(used) / (CALLS // 20) * 1e6


def _import() -> None:
    times = []
    for _ in range(9):
        done = subprocess.run([sys.executable, "-c", IMPORT], capture_output=True, text=True, check=True)
        times.append(float(done.stdout))
    print(f"importing the inside, beside pytest {min(times):7.1f} ms of processor time")


if __name__ == "__main__":
    main()
