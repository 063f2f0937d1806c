"""What operators and pages say of the real bugs is what the reading of their fixes has."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

from mutabot_source.registry import names, operator
from real_bugs.shares import by_operator, now, share, silent

PAGE = (Path(__file__).parents[2] / "docs" / "real-bugs.md").read_text(encoding="utf-8")


def test_each_operator_of_the_family_says_how_many_bugs_it_stands_for() -> None:
    found = by_operator(silent())
    assert sorted(found) == sorted(names("bugs"))
    for name, counts in found.items():
        told = f": {counts['E']} of 253 silent bugs of public robot programs exactly, {counts['M']} nearly."
        assert told in operator(name).rationale
        assert f"| {name} | {counts['E']} | {counts['M']} |" in PAGE


def test_a_later_class_is_a_better_one_and_crashes_have_none() -> None:
    bugs = silent()
    assert len(bugs) == 253
    assert Counter(one["class"] for one in bugs)["sign"] == 26
    assert all("EMTN".index(one["now"]) < "EMTN".index(one["robot"]) for one in bugs if "now" in one)


def test_the_page_has_the_shares() -> None:
    bugs = silent()
    for told in (
        share(bugs, lambda one: one["robot"] == "E"),
        share(bugs, lambda one: now(one) == "E"),
        share(bugs, lambda one: now(one) in "EM"),
        share(bugs, lambda one: "E" in (now(one), one["conventional"])),
    ):
        assert re.search(rf"\| {re.escape(told)} \|", PAGE)
