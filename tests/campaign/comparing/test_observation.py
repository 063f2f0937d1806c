"""Comparing worlds: what counts as equal, and what is said about a difference."""

from __future__ import annotations

import math
from typing import Any

import pytest

from mutabot.campaign.comparison import OTHER_WORLD, Difference, Observation, TraceCall, compare, farthest
from mutabot.model import Probe

BOX = Probe("scene:box", tolerance=0.001)


def seen(*events: TraceCall, truncated: bool = False, **probes: Any) -> Observation:
    values = {f"scene:box.{name}" if name != "box" else "scene:box": value for name, value in probes.items()}
    return Observation(events, values, truncated)


def test_equal_worlds_are_indistinguishable() -> None:
    world = seen(TraceCall("a", {"x": 1.0}, {"y": 2.0}), x=1.0, colour="red")
    assert compare(world, world, [BOX]) == Difference(True, 0.0, ())


def test_a_difference_within_the_tolerance_is_none() -> None:
    found = compare(seen(x=1.0), seen(x=1.0009), [BOX])
    assert found.indistinguishable
    assert found.distance == pytest.approx(0.9)
    assert found.divergence == ()


def test_distance_is_the_worst_probe_in_multiples_of_its_tolerance() -> None:
    found = compare(seen(x=-0.3253, y=0.0), seen(x=-0.3187, y=0.002), [BOX])
    assert not found.indistinguishable
    assert found.distance == pytest.approx(6.6)
    assert found.divergence[0] == "box.x: -0.3187 instead of -0.3253 (off by 0.0066)"
    assert found.divergence[1].startswith("box.y")


def test_each_probe_has_its_own_tolerance_and_the_longest_name_fits_best() -> None:
    probes = [
        Probe("scene:box", tolerance=1.0),
        Probe("scene:box.x", tolerance=0.1),
        Probe("scene:bo", tolerance=9),
    ]
    assert compare(seen(x=0.0), seen(x=0.5), probes).distance == pytest.approx(5.0)
    assert compare(seen(y=0.0), seen(y=0.5), probes).distance == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("before", "after"),
    [("red", "blue"), (True, False), (1.0, math.nan), (1.0, "1.0"), (1.0, None), ([1.0], [1.0, 2.0])],
)
def test_what_is_no_difference_of_numbers_counts_as_another_world(before: object, after: object) -> None:
    found = compare(seen(box=before), seen(box=after), [BOX])
    assert found.distance == OTHER_WORLD
    assert not found.indistinguishable


@pytest.mark.parametrize("value", [math.nan, math.inf, "red", None, [1.0, {"a": 2}]])
def test_equal_values_of_any_kind_are_equal(value: object) -> None:
    assert compare(seen(box=value), seen(box=value), [BOX]).indistinguishable


def test_a_probe_that_only_one_side_has_is_a_difference() -> None:
    found = compare(seen(x=1.0), seen(), [BOX])
    assert found.divergence == ("box.x: nothing instead of 1",)


def test_without_probes_there_is_no_distance() -> None:
    assert compare(seen(), seen()) == Difference(True, None, ())


@pytest.mark.parametrize(
    ("mutant", "line"),
    [
        ([TraceCall("a", {"x": 1.0}, {"y": 2.5})], "call 1, a: read y 2.5 instead of 2 (off by 0.5)"),
        ([TraceCall("a", {"x": -1.0}, {"y": 2.0})], "call 1, a: wrote x -1 instead of 1 (off by 2)"),
        ([TraceCall("b")], "call 1: b instead of a"),
        ([], "1 call fewer"),
        ([TraceCall("a", {"x": 1.0}, {"y": 2.0}), TraceCall("c")], "1 call more"),
    ],
)
def test_the_first_call_that_differs_is_reported(mutant: list[TraceCall], line: str) -> None:
    found = compare(seen(TraceCall("a", {"x": 1.0}, {"y": 2.0})), seen(*mutant))
    assert not found.indistinguishable
    assert found.divergence == (line,)


def test_of_a_call_only_the_values_that_differ_are_reported() -> None:
    before = TraceCall("a", {"x": 0.5, "grip": "open", "speed": 0.25})
    after = TraceCall("a", {"x": -0.5, "grip": "closed", "speed": 0.25})
    (line,) = compare(seen(before), seen(after)).divergence
    assert line == "call 1, a: wrote x -0.5 instead of 0.5 (off by 1), grip closed instead of open"


def test_a_call_is_named_without_columns_module_and_formats_and_rounding_is_no_digit() -> None:
    key = "sorter.py:16:4-16:23 link:send drop/{height:g}"
    (line,) = compare(seen(TraceCall(key, {"x": 2.4e-15})), seen(TraceCall(key, {"x": -0.25}))).divergence
    assert line == "call 1, sorter.py:16 send drop/{height}: wrote x -0.25 instead of 0 (off by 0.25)"


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [(5.0, math.inf, "inf instead of 5 (off by inf)"), (1.5e308, -1.5e308, "-1.5e+308 instead of 1.5e+308")],
)
def test_beside_an_infinite_difference_no_number_is_rounding(before: float, after: float, told: str) -> None:
    (line,) = compare(seen(TraceCall("a", {"x": before})), seen(TraceCall("a", {"x": after}))).divergence
    assert f"wrote x {told}" in line


def test_traces_that_were_cut_off_are_compared_as_far_as_they_go() -> None:
    assert compare(
        seen(TraceCall("a")), seen(TraceCall("a"), TraceCall("b"), truncated=True)
    ).indistinguishable


def test_several_tests_of_a_mutant_are_as_far_as_the_farthest() -> None:
    near, far = Difference(True, 0.5, ()), Difference(False, 7.0, ("x", "y"))
    bare = Difference(False, None, ("1 call fewer",))
    assert farthest([near, bare, far]) == Difference(False, 7.0, ("x", "y", "1 call fewer"))
    assert farthest([near, near]) == near
    assert farthest([]) == Difference(True, None, ())


def test_values_that_differ_late_are_printed_with_as_many_digits_as_it_takes() -> None:
    line = compare(seen(x=-0.32741), seen(x=-0.32744), [Probe("scene:box", tolerance=1e-6)]).divergence[0]
    assert line == "box.x: -0.32744 instead of -0.32741 (off by 3e-05)"
    before, after = ([1.0, 2.00001], [1.0, 2.00002])
    (call,) = compare(seen(TraceCall("a", {"x": before})), seen(TraceCall("a", {"x": after}))).divergence
    assert call == "call 1, a: wrote x (1, 2.00002) instead of (1, 2.00001)"


@pytest.mark.parametrize(
    ("before", "after", "line"),
    [
        ([[0, 1.0], [0, 0.5]], [[0, 1.0], [0, -0.5]], "go returned [1][1] -0.5 instead of 0.5 (off by 1)"),
        ({"x": 1, "y": [2]}, {"x": 1, "y": [3]}, "go returned ['y'][0] 3 instead of 2 (off by 1)"),
        (0.5, -0.5, "go returned -0.5 instead of 0.5 (off by 1)"),
        ([1, 2], [1], "go returned (1) instead of (1, 2)"),
        ([[1, 2], [3]], [[1, 2], [3, 4]], "go returned [1] (3, 4) instead of (3)"),
    ],
)
def test_of_what_was_returned_the_first_part_that_differs_is_reported(
    before: object, after: object, line: str
) -> None:
    first, second = (Observation((), {}, returned=[("go", (value,))]) for value in (before, after))
    assert compare(first, second).divergence == (line,)
