"""Which operators plant the real bugs of ``reading.toml``, with 95 % intervals (Wilson): tables in Markdown.

Use: ``python benchmarks/real_bugs/shares.py``.
"""

from __future__ import annotations

import sys
import tomllib
from collections import Counter
from collections.abc import Sequence
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
    return [one for one in tomllib.loads(file.read_text(encoding="utf-8"))["bug"] if one["class"] != _CRASH]


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
    for one in bugs:
        if "now" in one:
            found.setdefault(one["now_by"], Counter())[one["now"]] += 1
    return found


def main() -> int:
    """The command."""
    bugs = silent()
    print(f"| {len(bugs)} silent bugs | exact | exact or near |\n|---|---|---|")
    letters = {
        "robot operators": [str(one["robot"]) for one in bugs],
        "robot operators and family `bugs`": [now(one) for one in bugs],
        "conventional operators": [str(one["conventional"]) for one in bugs],
        "all three": [min(now(one), str(one["conventional"])) for one in bugs],  # E is before M
    }
    for name, found in letters.items():
        print(
            f"| {name} | {share([one == 'E' for one in found])} | {share([one in 'EM' for one in found])} |"
        )
    print("\n| operator | exact | near | exact, and by no conventional operator |\n|---|---|---|---|")
    for name, counts in sorted(by_operator(bugs).items(), key=lambda one: -one[1]["E"]):
        alone = [one for one in bugs if one.get("now_by") == name and one["now"] == "E"]
        own = sum(one["conventional"] != "E" for one in alone)
        print(f"| {name} | {counts['E']} | {counts['M']} | {own} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
