"""Write docs/operators.md and docs/middleware.md from the operators' docstrings, and docs/configuration.md
from the settings.

Use: ``python tools/make_docs.py``; with ``--check`` nothing is written, and the exit code is 1 if a page is
out of date.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

import configuration_page
from mutabot.families import CATALOGUE, GRADED, MIDDLEWARE
from mutabot.operators import Need, Operator, names, operator

DOCS = Path(__file__).parents[1] / "docs"

HEAD = """\
# Operators: the faults

<!-- Written by tools/make_docs.py from the operators' docstrings. Do not edit. -->

An *operator* makes one kind of small fault, on the operations and quantities that the
[vocabulary](vocabulary.md) describes. A call is left alone if the fault would change nothing or would leave
the allowed range or values. `mutabot operators` prints where each operator acts, and which bugs it stands
for. *Idle* ones [answer the program](vocabulary.md#answers-to-doing-nothing) in the place of the robot.
`mutabot run --operators common` keeps those that are [common](real-bugs.md#which-operators-are-common).
Faults of messages on their way: [middleware](middleware.md).

## Published operators

Family `robot`, the default, has all 13 published operators for robot programs.
"""

CATALOGUE_HEAD = """\
## The catalogue

`--family catalogue` adds common faults of robot programs. Bug counts per class, of bugs in commands and
readings, in published studies of ROS and PX4/ArduPilot software: {studies}. Not covered: a lost blend radius.
"""
GRADED_HEAD = """\
## Graded faults

`--family graded` makes the same fault at rising magnitudes: [thresholds](thresholds.md).
"""
#: what the groups of the catalogue are called, by the first operator of each
GROUPS = {
    "cm-for-m": "Units",
    "axis-swap": "Frames, axes, joints and tools",
    "euler-order": "Orientations as a whole",
    "swap-next": "Order and time",
    "dropout": "Readings",
    "speed-override": "Actuation",
}

TAIL = """\
## Your own operators

Write a class in a file of `src/mutabot/operators/kinds` or in a [package](packages.md), whose page has a
short one; the contract is `src/mutabot/operators/operator.py`. Most are a `ValueOperator`
(`operators/value.py`) or a `CommandOperator` (`operators/command.py`: acts on the whole call). Where one of
its `needs` is not met, mutants are skipped with the reason. `family = "…"` makes a family of its own.
"""


def page() -> str:
    """The text of the page."""
    operators = _operators(of_middleware=False)
    graded = [each for each in operators if each.family == GRADED]
    first = [each for each in operators if each.family not in (CATALOGUE, GRADED)]
    groups: dict[str, list[Operator]] = {}
    title = ""
    for each in (each for each in operators if each.family == CATALOGUE):
        title = GROUPS.get(each.name, title)
        groups.setdefault(title, []).append(each)
    lines = [HEAD]
    for each in first:
        lines += _section(each)
    lines.append(GRADED_HEAD)
    for each in graded:
        lines += _section(each)
    lines.append(CATALOGUE_HEAD.replace("{studies}", _studies(operators)))
    for title, members in groups.items():
        lines.append(f"## {title}\n")
        for each in members:
            lines += _section(each)
    return "\n".join([*lines, TAIL])


def page_of_middleware() -> str:
    """The text of the page on the family ``middleware``."""
    operators = _operators(of_middleware=True)
    text = (Path(__file__).parent / "middleware_page.md").read_text(encoding="utf-8")
    lines = [text]
    for each in operators:
        lines += _section(each)
    return "\n".join(lines).rstrip() + "\n"


def _operators(*, of_middleware: bool) -> list[Operator]:
    found = (operator(name) for name in names())
    return [rule for rule in found if (rule.family == MIDDLEWARE) is of_middleware]


#: what the sentence on a class of bugs ends with: how many of them studies found
_STUDIED = re.compile(r": ([^:]+?) are (\d+) of the bugs .*$")


def _studies(operators: list[Operator]) -> str:
    found = (_STUDIED.search(each.rationale) for each in operators)
    numbers = {match[1]: int(match[2]) for match in found if match}
    return ", ".join(
        f"{name} {number}"
        for name, number in sorted(numbers.items(), key=lambda name_and_number: -name_and_number[1])
    )


def _section(each: Operator) -> Iterator[str]:
    yield f"### {each.name}\n"
    yield f"{each.summary}{' *(idle)*' if Need.IDLE in each.needs else ''}\n"


def main(arguments: list[str]) -> int:
    """Write the pages, or check them; returns the exit code."""
    pages = {
        "operators.md": page(),
        "middleware.md": page_of_middleware(),
        "configuration.md": configuration_page.page(),
    }
    if arguments == ["--check"]:
        paths = {DOCS / name: text for name, text in pages.items()}
        return int(any(not path.is_file() or path.read_text("utf-8") != text for path, text in paths.items()))
    for name, text in pages.items():
        (DOCS / name).write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
