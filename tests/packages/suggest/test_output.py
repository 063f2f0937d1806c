"""What is printed of a check can be read and copied."""

from __future__ import annotations

from dataclasses import replace

from mutabot_suggest.output import check_lines
from mutabot_suggest.results import ProvenCheck, Suggestions

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
        "another tool makes this test: add the check by hand where it ends, with",
        "  from expected import is_near",
    ]


def test_a_check_to_add_by_hand_without_imports_says_where_it_stands() -> None:
    lines = [*check_lines(replace(CHECK, by_hand=CHECK.statement, after="cell"), FOUND)]
    assert lines[-1] == "another tool makes this test: add the check by hand where `cell` is made"
