"""The engines side by side on the examples: what it is worth to share what comes before a fault.

    python benchmarks/engines.py [--examples paper …] [--engines auto …] [--sample N] [--page FILE]

Each row is one `mutabot run --fresh` in a copy of the example, with as many processes as there are cores;
baseline, plan, controls, and what the journal takes are included. `auto` forks the suite where a mutant first
differs and replays what cannot be forked; `replay` runs the suite in a new process for each mutant and round.
Beside them stands one run of plain pytest with the whole suite, which a tool without shortcuts needs for each
mutant and round that survives. Processor time and the memory of the largest process are the kernel's figures
of the whole command. Of what forks, the median of three runs is shown. The exit code is 1 if the engines
differ in a verdict.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MUTABOT = str(Path(sys.executable).with_name("mutabot"))
ENGINES = ("auto", "replay")
#: options of `mutabot run` for each example; what takes hours with all mutants is drawn at random
EXAMPLES: dict[str, list[str]] = {
    "paper": ["--only", "@published.txt", "--rounds", "5"],
    "pick_and_place": ["--rounds", "1", "--sample", "60"],
    "scales": ["--rounds", "1"],
    "tracking": ["--rounds", "1", "--sample", "20"],
    "palletising": ["--rounds", "1", "--sample", "10"],
}
HEADINGS = ("example", "engine", "mutants × rounds", "wall s", "CPU s", "CPU s each", "peak MB")
MARK = "<!-- Written by `make bench` (benchmarks/engines.py) from here on. -->"
#: runs of what forks
TIMES = 3


@dataclass(frozen=True)
class Used:
    """What one command took: seconds of wall clock and of processors, MB of its largest process."""

    wall: float
    cpu: float
    memory: float


@dataclass(frozen=True)
class Row:
    """One line of the table; ``verdicts`` by mutant and round."""

    example: str
    engine: str
    used: Used
    verdicts: dict[tuple[str, int], str]


def main() -> int:
    """Measure and print; the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--examples", nargs="+", default=list(EXAMPLES), choices=list(EXAMPLES))
    parser.add_argument("--engines", nargs="+", default=list(ENGINES), choices=ENGINES)
    parser.add_argument("--sample", type=int, help="mutants of each example, instead of its own number")
    parser.add_argument("--page", type=Path, help="page whose last part is written anew")
    given = parser.parse_args()
    rows, suites = [], {}
    for example in given.examples:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name, example)
            shutil.copytree(ROOT / "examples" / example, folder, ignore=shutil.ignore_patterns(".mutabot"))
            suites[example] = run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"], folder)
            rows += [typical(example, engine, folder, given.sample) for engine in given.engines]
    lines = [*table(rows), "", *worth(rows, suites)]
    print("\n".join(lines))
    if given.page is not None:
        kept = given.page.read_text(encoding="utf-8").partition(MARK)[0]
        said = f"{kept}{MARK}\n\nOn {cores()} cores, in one go.\n\n"
        given.page.write_text(said + "\n".join(lines) + "\n", encoding="utf-8")
    found = list(disagreements(rows))
    print(*found, sep="\n")
    return 1 if found else 0


def cores() -> int:
    """How many processes can run at a time."""
    return len(os.sched_getaffinity(0))


def typical(example: str, engine: str, folder: Path, sample: int | None) -> Row:
    """One row; of what forks the median of three, since a busy moment would spoil it."""
    options = EXAMPLES[example] if sample is None else ["--rounds", "1", "--sample", str(sample)]
    command = [MUTABOT, "run", "--fresh", "--engine", engine, "-j", str(cores()), *options]
    used = sorted((run(command, folder) for _ in range(TIMES if engine == "auto" else 1)), key=_cpu)
    told = subprocess.run([MUTABOT, "results", "--json"], cwd=folder, check=True, capture_output=True)
    mutants = json.loads(told.stdout)["mutants"]
    verdicts = {
        (mutant["id"], end["round"]): end["verdict"] for mutant in mutants for end in mutant["rounds"]
    }
    return Row(example, engine, used[len(used) // 2], verdicts)


def _cpu(used: Used) -> float:
    return used.cpu


def run(command: list[str], folder: Path) -> Used:
    """Run a command that must succeed, and measure it with all processes below it."""
    began = time.monotonic()
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(command, cwd=folder, stdout=output, stderr=output)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            output.seek(0)
            said = output.read().decode()[-2000:]
            sys.exit(f"{' '.join(command)} ended with {process.returncode}:\n{said}")
    return Used(time.monotonic() - began, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)


def table(rows: list[Row]) -> list[str]:
    """The table in Markdown."""
    return [
        f"| {' | '.join(HEADINGS)} |",
        f"|---|---|{'---:|' * (len(HEADINGS) - 2)}",
        *(
            f"| {row.example} | {row.engine} | {len(row.verdicts)} | {row.used.wall:.1f} "
            f"| {row.used.cpu:.1f} | {row.used.cpu / len(row.verdicts):.2f} | {row.used.memory:.0f} |"
            for row in rows
        ),
    ]


def worth(rows: list[Row], suites: dict[str, Used]) -> Iterator[str]:
    """What forking saves, and what one run of the plain suite takes."""
    times = {(row.example, row.engine): row.used for row in rows}
    for example, suite in suites.items():
        said = f"- {example}: plain pytest with the whole suite takes {suite.cpu:.1f} s of processor time"
        both = [times.get((example, engine)) for engine in ENGINES]
        if both[0] is not None and both[1] is not None:
            said += f"; forking takes {both[0].cpu / both[1].cpu:.2f} of replay's"
        yield f"{said}."


def disagreements(rows: list[Row]) -> Iterator[str]:
    """Verdicts in which the engines differ."""
    by_example: dict[str, list[Row]] = {}
    for row in rows:
        by_example.setdefault(row.example, []).append(row)
    for example, (first, *others) in by_example.items():
        for other in others:
            for key, verdict in first.verdicts.items():
                again = other.verdicts.get(key, verdict)
                if again != verdict:
                    yield f"{example}: {key[0]}, round {key[1]}: {verdict}, by {other.engine} {again}"


if __name__ == "__main__":
    sys.exit(main())
