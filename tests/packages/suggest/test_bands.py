"""Bands hold all runs of the original, and checks read as a person writes them."""

from __future__ import annotations

import ast
import random
from dataclasses import dataclass
from typing import Any

import pytest

from mutabot_suggest.bands import band_of, digits_of, readable, unseen
from mutabot_suggest.candidates import _EndReadings
from mutabot_suggest.project import PlaceInTest
from mutabot_suggest.readings import ReadExpression
from mutabot_suggest.suggest import chosen_of
from mutabot_suggest.suite import SuiteChecks
from mutabot_suggest.tolerances import StatedTolerances, stated_in


def test_hardly_any_further_run_of_the_original_lies_outside() -> None:
    """Of a normal distribution, a uniform one and a skewed one, after 20 runs."""
    draw = random.Random(1)
    for next_value in (lambda: draw.gauss(0.0, 1.0), draw.random, lambda: draw.expovariate(1.0)):
        outside = 0
        for _ in range(200):
            band = band_of([next_value() for _ in range(20)], 0.0)
            outside += sum(abs(next_value() - band.middle) > band.tolerance for _ in range(50))
        assert outside / 10_000 < 0.005


@pytest.mark.parametrize("values", [[1.0] * 9, [1.0, 1.1, 1.2], [0.1, 0.1, 0.1, 9.0]])
def test_no_band_is_narrower_than_the_tolerance_or_leaves_out_a_run(values: list[float]) -> None:
    band = band_of(values, 0.25)
    assert band.tolerance >= 0.25
    assert all(abs(value - band.middle) <= band.tolerance for value in values)


@pytest.mark.parametrize(
    ("values", "nearest", "expected"),
    [
        ([89.94758, 89.94759], 30.0, (90.0, 5.0)),
        ([0.301, 0.3, 0.299], 0.1, (0.3, 0.02)),
        ([0.0, 0.0], 0.5, (0.0, 0.2)),
        ([0.48, 0.48], 0.5, (0.48, 0.02)),
        ([3.14, 3.14], 6.28, (3.1, 0.2)),
        ([10.71, 10.71], 0.02, (10.71, 0.01)),
    ],
)
def test_a_check_has_no_more_digits_than_it_needs(
    values: list[float], nearest: float, expected: tuple[float, float]
) -> None:
    assert readable(band_of(values, 0.001), nearest) == pytest.approx(expected)


def test_the_value_is_as_exact_as_a_stated_tolerance_needs() -> None:
    assert readable(band_of([0.347, 0.347], 0.001), 0.6, 0.03) == pytest.approx((0.35, 0.03))
    assert readable(band_of([0.347, 0.347], 0.001), 0.02, 0.03)[1] < 0.02


@pytest.mark.parametrize("floor", [0.00123, 0.5, 1.0, 37.0])
@pytest.mark.parametrize("middle", [-0.000012345, 0.0, 1.23456789, 12345.6789])
def test_what_is_written_holds_all_that_the_band_holds(middle: float, floor: float) -> None:
    value, tolerance = readable(band_of([middle], floor), 0.0)
    assert abs(value - middle) + floor <= tolerance * 1.02


def test_digits_are_those_that_a_person_reads() -> None:
    assert [digits_of(value) for value in (0.0, 0.3, -0.05, 10.71, 90.0, 1200.0)] == [1, 1, 1, 4, 1, 2]


def test_more_runs_show_more() -> None:
    assert unseen(200) < unseen(20) < unseen(1) < 1.0


def test_all_that_any_check_kills_is_killed_and_no_check_is_needless() -> None:
    draw = random.Random(3)
    for _ in range(30):
        trials = [frozenset(draw.sample(range(8), draw.randint(1, 4))) for _ in range(9)]
        checks: list[Any] = [_Check(kills, (draw.random(),)) for kills in trials]
        whole = frozenset().union(*(candidate.trials for candidate in checks))
        chosen: list[Any] = list(chosen_of(checks, {}))
        assert frozenset().union(*(chosen_check.trials for chosen_check in chosen)) == whole
        for check in chosen:
            assert frozenset().union(*(other.trials for other in chosen if other is not check)) != whole


def test_of_checks_that_others_replace_the_one_that_a_person_would_rather_write_stays() -> None:
    trials = [{1, 2}, {2, 3}, {1, 3, 4}, {4, 5}]
    checks: list[Any] = [_Check(frozenset(kills), (-rank,)) for rank, kills in enumerate(trials)]
    assert chosen_of(checks, {}) == [checks[0], checks[1], checks[3]]


@dataclass(frozen=True, eq=False)
class _Check:
    """What a choice asks of a check."""

    trials: frozenset[int]
    worth: tuple[float, ...]


def test_what_the_tests_allow_is_no_golden_value() -> None:
    text = (
        "def test_it():\n    assert abs(x - 0.4) < 0.03\n    assert tool.y == pytest.approx(1.0, abs=0.5)\n"
    )
    _, stated = stated_in(ast.parse(text))
    assert stated == {"=x": 0.03, "x": 0.03, "=tool.y": 0.5, "y": 0.5}
    place = PlaceInTest("pytest", "tests/test_it.py", "tests/test_it.py::test_it")
    reads = {"a": {(0, ""): {"x": 0.42, "z": 0.1}}, "b": {(0, ""): {"x": 0.5, "z": 0.024997}}}
    runs = [{"x": 0.40767, "z": 0.0249894}]
    suite: Any = SuiteChecks(None)  # type: ignore[arg-type]  # it has no files
    seen = _EndReadings(place, runs, reads, [], StatedTolerances(suite, stated, runs, reads, runs))
    found = {}
    for name in ("x", "z"):
        (check,) = seen.checks(ReadExpression(name, 0, 1e-6))
        found[name] = check.value, check.tolerance, {mutant for mutant, _ in check.trials}
    assert found == {"x": (0.41, 0.03, {"b"}), "z": (0.02, 0.03, {"a"})}
