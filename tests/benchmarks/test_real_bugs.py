"""What operators and pages say of the real bugs is what the reading of their fixes has."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

from mutabot_patches.changes import read_patch
from mutabot_patches.suite import looks_like_tests
from mutabot_source.registry import names, operator
from real_bugs.coupling import PROGRAMS, spearman
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
        share([one["robot"] == "E" for one in bugs]),
        share([now(one) == "E" for one in bugs]),
        share([now(one) in "EM" for one in bugs]),
        share(["E" in (now(one), one["conventional"]) for one in bugs]),
    ):
        assert re.search(rf"\| {re.escape(told)} \|", PAGE)


def test_each_bug_of_the_programs_applies_and_says_its_class() -> None:
    classes = {one["class"] for one in silent()}
    found = sorted(PROGRAMS.glob("*/patches/*.patch"))
    assert len(found) == 25
    for file in found:
        patch = read_patch(file.read_bytes(), file.parents[1], looks_like_tests)
        assert not patch.notes
        assert patch.title.partition(": ")[0] in classes


def test_rank_correlation() -> None:
    assert spearman([1, 2, 3, 4], [10, 20, 25, 90]) == pytest.approx(1.0)
    assert spearman([1, 2, 3], [3, 2, 1]) == pytest.approx(-1.0)
    assert spearman([1, 2, 2, 3], [1, 3, 2, 4]) == pytest.approx(0.9486833)
    assert spearman([1, 1, 1], [1, 2, 3]) == 0.0
