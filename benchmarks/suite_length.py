"""Is the cost of a suite linear? 100, 1,000 and 10,000 trivial tests: plain pytest beside a baseline.

Every test calls one function of the program and checks what it returns. Measured is the processor time of
plain pytest, and of ``mutabot list``, which takes the baseline. What a test costs is the difference between
one length and the next, so that what does not grow with the suite is left out.

Promise: a test of the longest suites costs at most 1.5 times what one of the shortest does.

Use: ``python benchmarks/suite_length.py [--lengths 100 1000 10000] [--json]``. The exit code is 1 if the
promise is broken.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
from itertools import pairwise
from pathlib import Path

#: tests in a file
_EACH = 100
_MOST = 1.5


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--lengths", nargs="+", type=int, default=[100, 1000, 10000])
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    found = [_measure(length) for length in given.lengths]
    rows = [
        {
            "tests": longer["tests"],
            "pytest_ms": _each(shorter, longer, "pytest"),
            "mutabot_ms": _each(shorter, longer, "mutabot"),
        }
        for shorter, longer in pairwise([dict.fromkeys(("tests", "pytest", "mutabot"), 0.0), *found])
    ]
    rows = rows[1:]  # the first one holds all that does not grow
    if given.json:
        print(json.dumps({"seconds": found, "per_test": rows}, indent=2))
    else:
        for one in found:
            print(f"{one['tests']:6.0f} tests: pytest {one['pytest']:.1f} s, baseline {one['mutabot']:.1f} s")
        for row in rows:
            print(
                f"to {row['tests']:6.0f} tests: pytest {row['pytest_ms']:.2f} ms a test, "
                f"baseline {row['mutabot_ms']:.2f} ms"
            )
    return int(len(rows) > 1 and rows[-1]["mutabot_ms"] > _MOST * rows[0]["mutabot_ms"])


def _each(shorter: dict[str, float], longer: dict[str, float], what: str) -> float:
    return (longer[what] - shorter[what]) / (longer["tests"] - shorter["tests"]) * 1000


def _measure(length: int) -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder:
        project = Path(folder)
        _write(project, length)
        plain = _cpu([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"], project)
        ours = _cpu([sys.executable, "-m", "mutabot.cli.app", "list", "--json"], project)
        return {"tests": float(length), "pytest": plain, "mutabot": ours}


def _write(project: Path, length: int) -> None:
    (project / "program.py").write_text("def twice(value):\n    return 2 * value\n")
    (project / "pytest.ini").write_text("[pytest]\npythonpath = .\n")
    (project / "mutabot.toml").write_text('program = ["program.py"]\nfamilies = ["conventional"]\n')
    (project / "tests").mkdir()
    for first in range(0, length, _EACH):
        tests = "".join(
            f"\ndef test_{number}():\n    assert program.twice({number}) == {2 * number}\n"
            for number in range(first, min(first + _EACH, length))
        )
        (project / "tests" / f"test_from_{first}.py").write_text("import program\n\n" + tests)


def _cpu(command: list[str], folder: Path) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


if __name__ == "__main__":
    sys.exit(main())
