"""Record the behaviours, or compare two recordings.

python -m tests.packages.ros.differential run [--only NAME]… [--over simulation] > FILE
python -m tests.packages.ros.differential compare FILE FILE
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from tests.packages.ros.differential.runner import KEPT, WAYS, Outcome, read, run
from tests.packages.ros.differential.worker import behaviours, record


def main(arguments: list[str]) -> int:
    """Run a command; gives the process's return code."""
    parser = argparse.ArgumentParser(prog="differential")
    commands = parser.add_subparsers(dest="command", required=True)
    running = commands.add_parser("run", help="record behaviours, one line of JSON each")
    running.add_argument("--only", action="append", default=[], metavar="NAME")
    running.add_argument("--over", choices=WAYS, default="dds")
    running.add_argument("--jobs", type=int, default=2)
    running.add_argument("--seconds", type=float, default=30.0, help="limit of each behaviour")
    single = commands.add_parser("one", help="record one behaviour in this process")
    single.add_argument("name")
    single.add_argument("--over", choices=WAYS, default="dds")
    single.add_argument("--to", type=Path, required=True)
    comparing = commands.add_parser("compare", help="say where two recordings differ")
    comparing.add_argument("first", type=Path)
    comparing.add_argument("second", type=Path, nargs="?", default=KEPT)
    keeping = commands.add_parser("keep", help="keep the records in which all recordings agree")
    keeping.add_argument("files", type=Path, nargs="+")
    commands.add_parser("list", help="name the behaviours")
    asked = parser.parse_args(arguments)
    if asked.command == "run":
        return _run(asked)
    if asked.command == "one":
        return record(asked.name, asked.over, asked.to)
    if asked.command == "compare":
        return _compare(read(asked.first), read(asked.second))
    if asked.command == "keep":
        return _keep([read(file) for file in asked.files])
    print("\n".join(behaviours()))
    return 0


def _run(asked: argparse.Namespace) -> int:
    failed = 0
    for outcome in run(asked.only, asked.over, jobs=asked.jobs, seconds=asked.seconds):
        print(outcome.line(), flush=True)
        failed += bool(outcome.error)
    return int(failed > 0)


def _compare(first: dict[str, Outcome], second: dict[str, Outcome]) -> int:
    names = [name for name in first if name in second]
    different = [name for name in names if not first[name].equals(second[name])]
    for name in different:
        print(f"{name}\n  {first[name].told()}\n  {second[name].told()}")
    print(f"{len(names) - len(different)} of {len(names)} are equal")
    return int(bool(different))


def _keep(recordings: list[dict[str, Outcome]]) -> int:
    first = recordings[0]
    agreed = [name for name in first if all(first[name].equals(other[name]) for other in recordings)]
    lines = [json.dumps({"name": name, "record": first[name].record}) for name in agreed]
    KEPT.write_text("\n".join(lines) + "\n", encoding="utf-8")
    for name in first:
        if name not in agreed:
            print(f"{name}: not the same in all recordings")
    return int(len(agreed) < len(first))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
