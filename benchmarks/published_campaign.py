"""What processor time does the published campaign take, beside that of another version of mutabot?

    python benchmarks/published_campaign.py OTHER [pairs [rounds]]

OTHER is the `mutabot` command of the other version, in a virtual environment with the same packages. In each
pair, first the other version and then the one beside this Python runs the 26 mutants of `examples/paper`, in
five rounds if nothing else is asked, one process at a time, in a copy of the example. Printed are the
processor times of each pair, of all processes, and in the end the ratio of their sums. The exit code is 1 if
their verdicts differ.
"""

from __future__ import annotations

import json
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

EXAMPLE = Path(__file__).resolve().parent.parent / "examples/paper"
PUBLISHED = EXAMPLE / "published.txt"


def spent() -> float:
    """Processor time of the processes that have ended below this one, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(command: str, folder: Path, rounds: int) -> tuple[float, dict[str, object]]:
    """Processor time of one campaign, s, and of each mutant in how many rounds which verdict came out."""
    before = spent()
    options = ["run", "--fresh", "-j", "1", "--only", f"@{PUBLISHED}", "--rounds", str(rounds)]
    subprocess.run([command, *options], cwd=folder, check=True, capture_output=True)
    took = spent() - before
    told = subprocess.run(
        [command, "results", "--json"], cwd=folder, check=True, capture_output=True, text=True
    )
    mutants = json.loads(told.stdout)["mutants"]
    return took, {mutant["id"]: [outcome["verdict"] for outcome in mutant["rounds"]] for mutant in mutants}


def main(other: str, pairs: int = 4, rounds: int = 5) -> int:
    """Run so many pairs; the exit code."""
    commands = {"other": other, "own": str(Path(sys.executable).with_name("mutabot"))}
    sums = dict.fromkeys(commands, 0.0)
    verdicts = []
    with tempfile.TemporaryDirectory() as folder:
        for name in commands:
            shutil.copytree(EXAMPLE, Path(folder, name), ignore=shutil.ignore_patterns(".mutabot"))
        for _ in range(pairs):
            times = {}
            for name, command in commands.items():
                times[name], found = run(command, Path(folder, name), rounds)
                verdicts.append(found)
                sums[name] += times[name]
            ratio = times["own"] / times["other"]
            print(f"other {times['other']:.1f} s, own {times['own']:.1f} s: {ratio:.2f}", flush=True)
    print(f"all pairs: {sums['own'] / sums['other']:.3f}")
    if all(found == verdicts[0] for found in verdicts):
        return 0
    print("the verdicts differ")
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], *map(int, sys.argv[2:])))
