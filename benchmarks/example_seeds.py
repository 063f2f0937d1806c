"""Does the unmutated program of an example pass its own tests, whatever the seed?

    python benchmarks/example_seeds.py EXAMPLE SEEDS [FIRST SEED]

Runs the example's suite in this process, every test once per seed, and prints how many passed per test.
"""

from __future__ import annotations

import os
import sys
import time
from collections import Counter
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"


class EverySeed:
    """A pytest plugin: every test that uses the round's seed runs once per seed, and is counted."""

    def __init__(self, seeds: range) -> None:
        self.seeds = seeds
        self.passed: Counter[str] = Counter()
        self.total: Counter[str] = Counter()

    def pytest_generate_tests(self, metafunc: pytest.Metafunc) -> None:
        if "mutabot_seed" in metafunc.fixturenames:
            metafunc.parametrize("mutabot_seed", self.seeds, ids=[f"seed={seed}" for seed in self.seeds])

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when != "call" and report.passed:
            return
        if "seed=" not in report.nodeid:  # a test that draws nothing runs once
            return
        name, seed = _split(report.nodeid)
        self.total[name] += 1
        self.passed[name] += report.passed
        if not report.passed:
            print(f"{name}, {seed}: {_message(report)}", flush=True)


def _split(nodeid: str) -> tuple[str, str]:
    """The test without its seed, and the seed."""
    name, _, parameters = nodeid.rpartition("::")[2].rstrip("]").partition("[")
    seed = parameters[parameters.index("seed=") :].split("-")[0]
    others = parameters.replace(f"{seed}-", "").replace(seed, "")
    return (f"{name}[{others}]" if others else name), seed


def _message(report: pytest.TestReport) -> str:
    crash = getattr(report.longrepr, "reprcrash", None)
    return " ".join(crash.message.split()) if crash is not None else str(report.longrepr)


def main(example: Path, count: int, first: int = 0) -> int:
    """Run `count` seeds; the exit code is 0 if every test passes with every seed."""
    os.chdir(example)
    sys.dont_write_bytecode = True
    plugin = EverySeed(range(first, first + count))
    start = time.perf_counter()
    options = ["-p", "no:terminal", "-p", "no:cacheprovider", "--capture=no"]
    code = pytest.main(options, plugins=[plugin])
    wall = time.perf_counter() - start
    passed, total = plugin.passed.total(), plugin.total.total()
    print(f"passed {passed} of {total} runs: {len(plugin.total)} tests, {count} seeds each; {wall:.0f} s")
    for name, runs in plugin.total.items():
        print(f"  {plugin.passed[name]:4} of {runs:4}  {name}")
    return int(code)


if __name__ == "__main__":
    sys.exit(main(EXAMPLES / sys.argv[1], *map(int, sys.argv[2:4])))
