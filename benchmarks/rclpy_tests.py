"""rclpy's own tests over real DDS and over the simulation: which pass there, and which of these pass here.

The tests are not part of this repository: they are run from a checkout of github.com/ros2/rclpy, of a release
that fits the rclpy that is installed.

Use: ``python benchmarks/rclpy_tests.py CHECKOUT [FILE …] [--json FILE]``, where CHECKOUT holds
``rclpy/test`` and each FILE is the name of one of its files. Each file runs in a process of its own, over
both. The exit code is 1 if a test passes over DDS and not over the simulation.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree

#: seconds for one file
_PATIENCE = 300
#: what takes rclpy's C extension away
_PLUGIN = ("-p", "ros_in_process.plugin")


def main() -> int:
    """Run the files over both and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkout", type=Path)
    parser.add_argument("files", nargs="*", help="names of files; default all")
    parser.add_argument("--json", type=Path, help="write the outcomes to this file")
    given = parser.parse_args()
    folder = given.checkout.resolve() / "rclpy"
    files = sorted(
        file for file in (folder / "test").glob("test_*.py") if not given.files or file.name in given.files
    )
    if not files:
        raise SystemExit(f"{folder / 'test'} has no such test files")
    outcomes: dict[str, dict[str, str]] = {"dds": {}, "simulation": {}}
    seconds = dict.fromkeys(outcomes, 0.0)
    for file in files:
        took = {}
        for over, plugin in (("dds", ()), ("simulation", _PLUGIN)):
            found, took[over] = _run(file, plugin)
            outcomes[over] |= found
            seconds[over] += took[over]
        print(f"{file.name}: {took['dds']:.1f} s over DDS, {took['simulation']:.1f} s simulated", flush=True)
    passed = [test for test, outcome in outcomes["dds"].items() if outcome == "passed"]
    lost = [test for test in passed if outcomes["simulation"].get(test) != "passed"]
    others = len(outcomes["dds"]) - len(passed)
    told = f"{len(passed)} tests of {len(files)} files pass over DDS, {others} do not"
    print(f"{told}, in {seconds['dds']:.0f} s")
    print(f"{len(passed) - len(lost)} of these pass over the simulation, in {seconds['simulation']:.0f} s")
    for test in lost:
        print(f"  {test}: {outcomes['simulation'].get(test, 'not run')}")
    if not passed:
        raise SystemExit("no test passes over DDS: see what pytest says of one of the files")
    if given.json:
        given.json.write_text(json.dumps(outcomes, indent=1) + "\n", encoding="utf-8")
    return int(bool(lost))


def _run(file: Path, plugin: tuple[str, ...]) -> tuple[dict[str, str], float]:
    """The outcome of each test of a file, and the seconds of wall clock."""
    with TemporaryDirectory() as place:
        report = Path(place, "report.xml")
        # beside rclpy's sources, and with what its build makes, they would be the tests of another rclpy
        tests = shutil.copytree(
            file.parent, Path(place, "test"), ignore=shutil.ignore_patterns("__init__.py")
        )
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--import-mode=importlib"]
        began = time.monotonic()
        try:
            subprocess.run(
                [*command, *plugin, f"--junitxml={report}", str(tests / file.name)],
                cwd=place,
                env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
                capture_output=True,
                timeout=_PATIENCE,
                check=False,
            )
        except subprocess.TimeoutExpired:
            print(f"{file.name}: no end after {_PATIENCE} s")
        took = time.monotonic() - began
        cases = ElementTree.parse(report).iter("testcase") if report.exists() else ()
        return {f"{case.get('classname')}::{case.get('name')}": _outcome(case) for case in cases}, took


def _outcome(case: ElementTree.Element) -> str:
    kinds = [kind for kind in ("failure", "error", "skipped") if case.find(kind) is not None]
    return kinds[0] if kinds else "passed"


if __name__ == "__main__":
    sys.exit(main())
