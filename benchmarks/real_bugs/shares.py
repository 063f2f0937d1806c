"""Which operators plant the real bugs of ``reading.toml``, with 95 % intervals (Wilson): tables in Markdown.

Use: ``python benchmarks/real_bugs/shares.py``.
"""

from __future__ import annotations

import sys
import tomllib
from collections import Counter
from collections.abc import Iterable, Sequence
from math import sqrt
from pathlib import Path
from typing import Any

READING = Path(__file__).with_name("reading.toml")
#: a bug that any test finds that reaches it
_CRASH = "crash"
_Z = 1.96
Bug = dict[str, Any]


def silent(file: Path = READING) -> list[Bug]:
    """Return the bugs that are no plain crash."""
    return [bug for bug in tomllib.loads(file.read_text(encoding="utf-8"))["bug"] if bug["class"] != _CRASH]


def now(bug: Bug) -> str:
    """Return how well the robot operators and those of family bugs plant it: E, M, T or N."""
    return str(bug.get("now", bug["robot"]))


def share(hold: Sequence[bool]) -> str:
    """Return of how many bugs something holds, as text: number, share and interval."""
    count, size = sum(hold), len(hold)
    part = count / size
    middle = (part + _Z**2 / (2 * size)) / (1 + _Z**2 / size)
    half = _Z * sqrt(part * (1 - part) / size + _Z**2 / (4 * size**2)) / (1 + _Z**2 / size)
    return f"{count} of {size} = {100 * part:.0f} % ({100 * (middle - half):.0f}–{100 * (middle + half):.0f})"


def by_operator(bugs: Sequence[Bug]) -> dict[str, Counter[str]]:
    """Return how many bugs each operator of family bugs plants, by how well: E or M."""
    found: dict[str, Counter[str]] = {}
    for bug in bugs:
        if "now" in bug:
            found.setdefault(bug["now_by"], Counter())[bug["now"]] += 1
    return found


def agreement(first: Sequence[bool], second: Sequence[bool]) -> str:
    """Return how often two readers agree, as text: share, and Cohen's kappa.

    Source: J. Cohen, A coefficient of agreement for nominal scales, Educational and Psychological Measurement
    20 (1960): kappa = (observed - expected) / (1 - expected); expected is what readers would share who class
    at random as often.
    """
    size = len(first)
    same = sum(a == b for a, b in zip(first, second, strict=True)) / size
    expected = sum(first.count(name) * second.count(name) for name in set(first)) / size**2
    return f"{100 * same:.0f} %, κ = {(same - expected) / (1 - expected):.2f}"


def second_reading(bugs: Sequence[Bug]) -> Iterable[str]:
    """Yield the table of both readers' classes."""
    yield "| | first reader | second reader | they agree |"
    yield "|---|---|---|---|"
    readers = {
        "robot operators and family `bugs`": ([now(bug) for bug in bugs], [bug["second"][0] for bug in bugs]),
        "conventional operators": ([bug["conventional"] for bug in bugs], [bug["second"][1] for bug in bugs]),
    }
    for name, (first, second) in readers.items():
        for title, classes in (("exact", "E"), ("exact or near", "EM")):
            ours, theirs = ([end in classes for end in ends] for ends in (first, second))
            yield f"| {name}: {title} | {share(ours)} | {share(theirs)} | {agreement(ours, theirs)} |"


def main() -> int:
    """The command."""
    bugs = silent()
    print(f"| {len(bugs)} silent bugs | exact | exact or near |\n|---|---|---|")
    letters = {
        "robot operators": [str(bug["robot"]) for bug in bugs],
        "robot operators and family `bugs`": [now(bug) for bug in bugs],
        "conventional operators": [str(bug["conventional"]) for bug in bugs],
        "all three": [min(now(bug), str(bug["conventional"])) for bug in bugs],  # E is before M
    }
    for name, found in letters.items():
        print(
            f"| {name} | {share([end == 'E' for end in found])} | {share([end in 'EM' for end in found])} |"
        )
    print("\n".join(["", *second_reading(bugs)]))
    print("\n| operator | exact | near | exact, and by no conventional operator |\n|---|---|---|---|")
    for name, counts in sorted(
        by_operator(bugs).items(), key=lambda operator_and_counts: -operator_and_counts[1]["E"]
    ):
        alone = [bug for bug in bugs if bug.get("now_by") == name and bug["now"] == "E"]
        own = sum(bug["conventional"] != "E" for bug in alone)
        print(f"| {name} | {counts['E']} | {counts['M']} | {own} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
