"""What is printed of a check can be read and copied."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

from mutabot_suggest.output import check_lines, print_suggestions
from mutabot_suggest.reasons import NOTHING_DIFFERS
from mutabot_suggest.results import Dropped, ProvenCheck, Suggestions, Unsolved

CHECK = ProvenCheck(
    test="tests/test_it.py::test_it",
    style="other",
    looks_at="box.x",
    statement="assert is_near(box.x, 0.3)",
    tolerance=None,
    spread=None,
    runs=6,
    fresh=5,
    unseen=0.45,
    kills={"m": (0,)},
    by_hand="from expected import is_near\nassert is_near(box.x, 0.3)",
)
FOUND = Suggestions(checks=(CHECK,), numbers={"m": 3}, rounds=1, seeds=5)


def test_a_check_to_add_by_hand_stands_once_with_its_imports_below() -> None:
    lines = [*check_lines(CHECK, FOUND)]
    assert lines.count(CHECK.statement) == 1
    assert lines[-2:] == [
        "this test is generated, as by pytest-bdd: add the check by hand where it ends, with",
        "  from expected import is_near",
    ]


def test_a_check_to_add_by_hand_without_imports_says_where_it_stands() -> None:
    lines = [*check_lines(replace(CHECK, by_hand=CHECK.statement, after="cell"), FOUND)]
    assert lines[-1] == "this test is generated, as by pytest-bdd: add the check by hand where `cell` is made"


def printed(found: Suggestions) -> list[str]:
    """Print suggestions, and return the lines."""
    lines: list[str] = []

    class Context:
        def print(self, text: str) -> None:
            lines.append(text.strip())

        def print_section(self, title: str, section_lines: Sequence[str] = (), at_most: int = 0) -> None:
            lines.extend([title, *section_lines])

    context: Any = Context()
    print_suggestions(context, found)
    return lines


def test_checks_with_the_same_proof_state_it_once() -> None:
    other = replace(CHECK, statement="assert box.y == 1", by_hand="", kills={"n": (0,)})
    lines = printed(replace(FOUND, checks=(CHECK, other)))
    assert sum(line.startswith("false alarms") for line in lines) == 1
    assert lines.index("Each of the 2 checks") > lines.index("assert box.y == 1")
    lines = printed(replace(FOUND, checks=(CHECK, replace(other, fresh=20))))
    assert sum(line.startswith("false alarms") for line in lines) == 2


@pytest.mark.parametrize(
    ("statement", "shown"),
    [
        ("assert near(HOME.x, x)\nassert near(HOME.y, y)", "assert near(HOME.x, x); assert near(HOME.y, y)"),
        ('cell.always(\n    lambda: (\n        z() < 1.0\n        or open()\n    ),\n    "low",\n)',
         'cell.always(lambda: z() < 1.0 or open(), "low")'),
    ],
)  # fmt: skip
def test_a_dropped_check_is_a_line_of_python(statement: str, shown: str) -> None:
    lines = printed(Suggestions(dropped=(Dropped("tests/test_it.py::test_it", statement, "fails"),)))
    assert f"{shown}: fails" in lines


def test_a_survivor_in_which_nothing_differs_is_not_said_to_be_impossible_to_kill() -> None:
    lines = printed(Suggestions(unsolved=(Unsolved("m", NOTHING_DIFFERS, never=True),), numbers={"m": 3}))
    assert "No check was searched for 1 survivor" in lines
    assert any("another [[probe]] may show a difference" in line for line in lines)
