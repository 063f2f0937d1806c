"""Thresholds of two campaigns: improved is a fact about equal rounds, the mean has an interval."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.model import Role
from mutabot.results.thresholds import Change, compare
from results import samples
from results.thresholds import journals
from results.thresholds.journals import SIZES, Rungs

LATE, SOON = "SSSSCCC", "SSCCCCC"


@pytest.mark.parametrize(
    ("before", "after", "change"),
    [
        ([LATE, LATE], [LATE, SOON], Change.IMPROVED),
        ([SOON, LATE], [LATE, LATE], Change.WORSE),
        ([SOON, LATE], [LATE, SOON], Change.MIXED),
        ([LATE, LATE], [LATE, LATE], Change.SAME),
        (["SSSSSSS"], [LATE], Change.IMPROVED),
        (["SSSSRRR"], [LATE], Change.UNKNOWN),
        ([LATE], ["UUUUUUU"], Change.UNKNOWN),
    ],
)
def test_a_ladder_is_improved_if_it_is_worse_in_no_round(
    tmp_path: Path, before: list[str], after: list[str], change: Change
) -> None:
    old, new = (
        journals.results(tmp_path / name, Rungs(rounds)) for name, rounds in (("old", before), ("new", after))
    )
    (found,) = compare(old, new).ladders
    assert found.change is change


def test_other_seeds_take_the_words_away(tmp_path: Path) -> None:
    old = journals.results(tmp_path / "old", Rungs([LATE]), seed=1)
    new = journals.results(tmp_path / "new", Rungs([SOON]), seed=2)
    assert "seeds differ (1 and 2)" in compare(old, new).why_no_words
    assert compare(old, old).why_no_words == ""


def test_the_mean_over_the_suite_has_an_interval(tmp_path: Path) -> None:
    sites = [
        samples.site("mission.py", line, "arm.move_by", Role.PROGRAM, occurrence=line) for line in (1, 2, 3)
    ]
    old = journals.results(tmp_path / "old", *(Rungs([LATE] * 3, site=site) for site in sites))
    better = [[SOON, SOON, LATE], [SOON] * 3, [SOON] * 3]
    pairs = zip(better, sites, strict=True)
    new = journals.results(tmp_path / "new", *(Rungs(rounds, site=site) for rounds, site in pairs))
    found = compare(old, new)
    assert found.mean is not None
    assert found.mean.mean == pytest.approx(16 / 9)
    assert found.mean.low < 16 / 9 < found.mean.high
    assert compare(old, old).has_improved is None


def test_a_ladder_that_got_a_demanded_magnitude_is_still_the_same(tmp_path: Path) -> None:
    old = journals.results(tmp_path / "old", Rungs([LATE]))
    new = journals.results(tmp_path / "new", Rungs(["SSSSSCCC"], sizes=(*SIZES[:4], 15.0, *SIZES[4:])))
    (found,) = compare(old, new).ladders
    assert found.steps == (0.0,)


def test_ladders_that_only_one_campaign_has_are_named(tmp_path: Path) -> None:
    old = journals.results(tmp_path / "old", Rungs([LATE]), Rungs([LATE], direction="-"))
    new = journals.results(tmp_path / "new", Rungs([LATE]))
    assert [name[-1] for name in compare(old, new).gone] == ["-"]
    assert [name[-1] for name in compare(new, old).added] == ["-"]
