"""Figures of merit: what a mutant does better or worse than the original, by more than the tolerance."""

from __future__ import annotations

import pytest

from mutabot.campaign.comparison import Observation, compare
from mutabot.model import Probe
from mutabot.model.outcome import Figure, improvement

TIME = "cell:Cell.cycle_time"


def figures(before: object, after: object, better: str | None = "less") -> tuple[Figure, ...]:
    probes = (Probe(TIME, tolerance=0.1, better=better),)
    return compare(Observation(probes={TIME: before}), Observation(probes={TIME: after}), probes).figures


@pytest.mark.parametrize(
    ("after", "better", "is_better"), [(11.0, "less", True), (13.0, "less", False), (13.0, "more", True)]
)
def test_the_vocabulary_says_which_way_is_better(after: float, better: str, is_better: bool) -> None:
    (found,) = figures(12.0, after, better)
    assert found.is_better is is_better
    assert (found.before, found.after) == (12.0, after)


@pytest.mark.parametrize(
    ("before", "after", "better"),
    [
        (12.0, 12.05, "less"),
        (12.0, 11.0, None),
        (12.0, None, "less"),
        ("a", "b", "less"),
        (12.0, float("nan"), "less"),
    ],
)
def test_what_is_no_number_or_no_difference_is_no_figure(
    before: object, after: object, better: str | None
) -> None:
    assert figures(before, after, better) == ()


def test_several_objects_of_a_class_have_a_figure_each() -> None:
    probes = (Probe(TIME, tolerance=0.1, better="less"),)
    before = Observation(probes={TIME: 1.0, f"{TIME}#2": 2.0, f"{TIME}_limit": 3.0})
    after = Observation(probes={TIME: 0.5, f"{TIME}#2": 1.0, f"{TIME}_limit": 1.0})
    assert [one.probe for one in compare(before, after, probes).figures] == [TIME, f"{TIME}#2"]


def test_a_mutant_is_better_only_if_it_is_worse_nowhere() -> None:
    better, worse = (
        Figure(TIME, 12.0, 11.0, "less"),
        Figure(TIME, 12.0, 13.0, "less", "tests/test_b.py::test_b"),
    )
    assert improvement([better]) == "Cell.cycle_time 11 instead of 12"
    assert improvement([better, worse]) == ""
    assert improvement([]) == ""
