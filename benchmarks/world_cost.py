"""What does a magnitude of a disturbance cost by fork, and what by replay?

A campaign with one magnitude and one with several run in a copy of ``examples/paper``, by both engines in
turn. The difference of their processor times, user and system, is what the magnitudes beyond the first take.

Use: ``python benchmarks/world_cost.py [--magnitudes N] [--when MOMENT …]``. The exit code is 1 if a magnitude
by fork takes more than a third of one by replay.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from suites.corpus import copied  # noqa: E402

_PARAMETER = """
[tool.mutabot.world]
of = ["mutabot_cell.cell:Cell"]
[[tool.mutabot.world.parameter]]
name = "payload"
apply = "mutabot_cell.disturbances:part_mass"
unit = "kg"
directions = ["+"]
when = "{when}"
ladder = {ladder}
"""
#: too light for any test to notice: what is noticed ends early
_FIRST, _STEP = 0.01, 0.001


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--magnitudes", type=int, default=9)
    parser.add_argument("--when", nargs="+", default=["made", "9 s"])
    given = parser.parse_args()
    is_dear = False
    for when in given.when:
        cost = {"fork": 0.0, "replay": 0.0}
        for engine in cost:
            single, several = (spent(engine, when, count) for count in (1, given.magnitudes))
            cost[engine] = (several - single) / (given.magnitudes - 1)
        share = cost["fork"] / cost["replay"]
        is_dear |= share > 1 / 3
        print(f"{when}: fork {cost['fork']:.2f} s, replay {cost['replay']:.2f} s, {share:.0%}", flush=True)
    return int(is_dear)


def spent(engine: str, when: str, count: int) -> float:
    """Processor time of a campaign with so many magnitudes, s."""
    with tempfile.TemporaryDirectory() as folder:
        copy = copied(ROOT / "examples" / "paper", Path(folder).resolve() / "paper")
        ladder = [_FIRST + _STEP * number for number in range(count)]
        with (copy / "pyproject.toml").open("a", encoding="utf-8") as file:
            file.write(_PARAMETER.format(when=when, ladder=ladder))
        words = [sys.executable, "-m", "mutabot.cli.app", "run", "--family", "world", "--rounds", "1"]
        before = _children()
        done = subprocess.run(
            [*words, "-j", "1", "--engine", engine], cwd=copy, capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise SystemExit(f"exit code {done.returncode}: {done.stderr[-1000:]}")
        return _children() - before


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    sys.exit(main())
