"""Is the cost of a suite linear? 100, 1,000 and 10,000 trivial tests: plain pytest beside mutabot.

Every test calls one function of the program and checks what it returns. Measured is the processor time of
plain pytest, and of ``mutabot list``, which takes the baseline, and the memory that the controller and any
other process need at most. What a test costs is the difference between one length and the next, so that what
does not grow with the suite is left out. With ``--run N``, N mutants are run as well; most survivors go
through the whole suite.

Promises: ``list`` takes at most 2.5 times what plain pytest takes on the longest suite; a test of it costs at
most 1.5 times what one of the shortest does; the controller needs at most 250 MB, any other process 600 MB.

Use: ``python benchmarks/suite_length.py [--lengths 100 1000 10000] [--run 20] [--json]``. The exit code is 1
if a promise is broken.
"""

from __future__ import annotations

import argparse
import json
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from itertools import pairwise
from pathlib import Path

#: tests in a file
_EACH = 100
#: what a test of the longest suites may cost in those of the shortest, and a baseline in runs of pytest
_MOST, _RUNS = 1.5, 2.5
#: MB of the controller, and of any other process
_CONTROLLER, _OTHERS = 250.0, 600.0
#: seconds between two looks at the memory
_PAUSE = 0.1
_PROGRAM = """\
def twice(value):
    spare = value + 1  # nobody looks at it
    if spare > 5:
        spare = spare - 1
    return 2 * value
"""

Figures = dict[str, float]


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--lengths", nargs="+", type=int, default=[100, 1000, 10000])
    parser.add_argument("--run", type=int, default=0, help="run so many mutants as well")
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    found = [_measure(length, given.run) for length in given.lengths]
    rows = [
        {
            "tests": longer["tests"],
            "pytest_ms": _each(shorter, longer, "pytest"),
            "list_ms": _each(shorter, longer, "list"),
        }
        for shorter, longer in pairwise(found)
    ]
    broken = list(_broken(found, rows))
    if given.json:
        print(json.dumps({"suites": found, "per_test": rows, "broken": broken}, indent=2))
    else:
        _print(found, rows)
        print("\n".join(f"BROKEN: {text}" for text in broken) or "all promises are kept")
    return int(bool(broken))


def _print(found: list[Figures], rows: list[Figures]) -> None:
    for figures in found:
        print(f"{figures['tests']:6.0f} tests: pytest {figures['pytest']:.1f} s")
        for what in ("list", "run"):
            if what in figures:
                times = f"{what}: {figures[what]:.1f} s, {figures[what] / figures['pytest']:.2f} times that"
                memory = [f"{figures[f'{what}_{who}']:.0f} MB" for who in ("controller", "others")]
                print(f"  {times}; at most {memory[0]} in the controller and {memory[1]} in another process")
    for row in rows:
        each = f"pytest {row['pytest_ms']:.2f} ms a test, list {row['list_ms']:.2f} ms"
        print(f"to {row['tests']:6.0f} tests: {each}")


def _broken(found: list[Figures], rows: list[Figures]) -> Iterator[str]:
    longest = found[-1]
    if longest["list"] > _RUNS * longest["pytest"]:
        yield f"list takes {longest['list'] / longest['pytest']:.2f} times what plain pytest takes"
    if len(rows) > 1 and rows[-1]["list_ms"] > _MOST * rows[0]["list_ms"]:
        yield "a test of the longest suite costs more than one of the shortest"
    for what in ("list", "run"):
        for who, most in (("controller", _CONTROLLER), ("others", _OTHERS)):
            if longest.get(f"{what}_{who}", 0.0) > most:
                yield f"{what} needs {longest[f'{what}_{who}']:.0f} MB ({who})"


def _each(shorter: Figures, longer: Figures, what: str) -> float:
    return (longer[what] - shorter[what]) / (longer["tests"] - shorter["tests"]) * 1000


def _measure(length: int, mutants: int) -> Figures:
    with tempfile.TemporaryDirectory() as folder:
        project = Path(folder)
        _write(project, length)
        found = {"tests": float(length)}
        found["pytest"], *_ = _cost(["pytest", "-q", "-p", "no:cacheprovider"], project)
        commands = {"list": ["list", "--json"]}
        if mutants:
            commands["run"] = ["run", "--fresh", "-j", "1", "--sample", str(mutants)]
        for what, words in commands.items():
            cost = _cost(["mutabot.cli.app", *words], project)
            found |= dict(zip((what, f"{what}_controller", f"{what}_others"), cost, strict=True))
        return found


def _write(project: Path, length: int) -> None:
    (project / "program.py").write_text(_PROGRAM)
    (project / "pytest.ini").write_text("[pytest]\npythonpath = .\n")
    (project / "mutabot.toml").write_text('program = ["program.py"]\nfamilies = ["conventional"]\n')
    (project / "tests").mkdir()
    for first in range(0, length, _EACH):
        tests = "".join(
            f"\ndef test_{number}():\n    assert program.twice({number}) == {2 * number}\n"
            for number in range(first, min(first + _EACH, length))
        )
        (project / "tests" / f"test_from_{first}.py").write_text("import program\n\n" + tests)


def _cost(words: list[str], folder: Path) -> tuple[float, float, float]:
    """Processor seconds of a command, and the MB that it and any process below it need at most."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    most: dict[int, float] = {}
    with subprocess.Popen(
        [sys.executable, "-m", *words], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as process:
        while process.poll() is None:
            for pid in _family(process.pid):
                most[pid] = max(most.get(pid, 0.0), _memory(pid))
            time.sleep(_PAUSE)
    if process.returncode:
        raise SystemExit(f"{' '.join(words)} ended with {process.returncode}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    own = most.pop(process.pid, 0.0)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return used, own, max(most.values(), default=0.0)


def _family(pid: int) -> Iterator[int]:
    yield pid
    children = ""
    with suppress(OSError):
        children = Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii")
    for child in children.split():
        yield from _family(int(child))


def _memory(pid: int) -> float:
    """The most memory that a process has had; none of one that has just ended."""
    with suppress(OSError):
        found = re.search(r"VmHWM:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text(encoding="utf-8"))
        return int(found[1]) / 1000 if found else 0.0
    return 0.0


if __name__ == "__main__":
    sys.exit(main())
