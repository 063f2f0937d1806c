"""What no check kills is told with what differs, and with what is no difference."""

from __future__ import annotations

import ast
from typing import Any

import pytest

from mutabot.model import Mutant, Role, Site, Span
from mutabot.suggest.checks import candidates
from mutabot.suggest.project import PlaceInTest
from mutabot.suggest.readings import PROBE, Measured, ReadExpression
from mutabot.suggest.suggest import why_unsolved

SITE = Site(Span("mission.py", 1, 0, 1, 5, "run"), "arm.go", 1, Role.PROGRAM)
MUTANT = Mutant(1, "robot", "skip", SITE, "robot:go", None, None, "", "arm.go: do nothing")
PLACE = PlaceInTest("pytest", "tests/test_it.py", "tests/test_it.py::test_it")


def measured(originals: list[float], mutant: float, tolerance: float) -> Measured:
    """One reading of one test, in as many rounds as there are values; the mutant is run in the first."""
    return Measured(
        originals={PLACE: {(round, PLACE.node): {"box.x": value} for round, value in enumerate(originals)}},
        mutants={PLACE: {MUTANT.id: {(0, PLACE.node): {"box.x": mutant}}}},
        readings={PLACE: [ReadExpression("box.x", PROBE, tolerance)]},
    )


@pytest.mark.parametrize(
    ("mutant", "tolerance", "said"),
    [
        (0.1, 0.001, "nothing differs"),
        (0.103, 0.001, "box.x differs by 0.003, the original itself spreads 0.005"),
        (0.103, 0.01, "box.x differs by 0.003, its tolerance is 0.01"),
    ],
)
def test_a_difference_within_the_spread_kills_nothing_and_is_told(
    mutant: float, tolerance: float, said: str
) -> None:
    found = measured([0.1, 0.105, 0.102, 0.104, 0.101, 0.103], mutant, tolerance)
    assert candidates(PROJECT, found) == ([], {})
    assert why_unsolved(MUTANT, found, [], _Unproven(), {}).reason.startswith(said)  # type: ignore[arg-type]


def test_a_difference_beyond_the_band_is_a_check() -> None:
    found = measured([0.1, 0.105, 0.102, 0.104, 0.101, 0.103], 0.5, 0.001)
    ((check,), _) = candidates(PROJECT, found)
    assert check.trials == {(MUTANT.id, 0)}
    assert check.statement == "assert box.x == pytest.approx(0.1, abs=0.1)"


def of(reads: list[dict[str, Any]], mutant: dict[str, Any], *texts: str) -> Measured:
    return Measured(
        originals={PLACE: {(round, PLACE.node): read for round, read in enumerate(reads)}},
        mutants={PLACE: {MUTANT.id: {(0, PLACE.node): mutant}}},
        readings={PLACE: [ReadExpression(text, PROBE, 0.001) for text in texts]},
    )


def test_what_a_test_was_given_is_what_it_is_held_against() -> None:
    places = [0.1234567 * number % 1 for number in range(12)]
    found = of(
        [{"target.x": place, "box.x": place} for place in places],
        {"target.x": places[0], "box.x": places[0] + 0.2},
        "box.x",
        "target.x",
    )
    statements = {check.statement for check in candidates(PROJECT, found)[0]}
    assert statements == {"assert box.x == pytest.approx(target.x, abs=0.1)"}


def test_a_clock_is_no_check_unless_the_tests_set_a_deadline() -> None:
    found = of([{"robot.time": 10.0}] * 3, {"robot.time": 20.0}, "robot.time")
    checks, refused = candidates(PROJECT, found)
    assert checks == []
    assert refused == {MUTANT.id: "only its time differs (robot.time), and the tests set no deadline"}
    deadline = _Project("assert robot.time < 30")
    assert len(candidates(deadline, found)[0]) == 1  # type: ignore[arg-type]


def test_an_exact_value_is_no_check() -> None:
    found = of([{"box.x": 10.7134}] * 3, {"box.x": 10.7154}, "box.x")
    checks, refused = candidates(PROJECT, found)
    assert checks == []
    assert refused[MUTANT.id].startswith("only an exact value would notice it: assert box.x == ")


def test_the_tolerance_is_that_of_the_suite_where_it_notices_as_much() -> None:
    found = of([{"box.x": 0.3}] * 3, {"box.x": 0.9}, "box.x")
    stated = _Project("assert cup.x == pytest.approx(0.5, abs=0.03)")
    ((check,), _) = candidates(stated, found)  # type: ignore[arg-type]
    assert check.statement == "assert box.x == pytest.approx(0.3, abs=0.03)"


class _Project:
    """A project of which only the text of the test counts."""

    def __init__(self, text: str = "") -> None:
        self._text = text

    def module(self, file: str) -> ast.Module:
        return ast.parse(self._text)


PROJECT: Any = _Project()


class _Unproven:
    """A proof in which nothing failed."""

    failed: dict[object, str] = {}  # noqa: RUF012
