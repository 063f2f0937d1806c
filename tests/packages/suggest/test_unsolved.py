"""What no check kills is told with what differs, and with what is no difference."""

from __future__ import annotations

import ast
from typing import Any

import pytest

from mutabot.model import Mutant, Role, Site, Span
from mutabot.results.results import MutantResult
from mutabot_suggest.candidates import ONLY_TIME, candidates
from mutabot_suggest.checks import CheckAtEnd
from mutabot_suggest.project import PlaceInTest
from mutabot_suggest.readings import ORACLE, PROBE, Measured, ReadExpression
from mutabot_suggest.reasons import why_unsolved
from mutabot_suggest.suite import SuiteChecks

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
        (0.1, 0.001, "nothing that was read at the ends of its tests differs"),
        (0.103, 0.001, "box.x differs by 0.003, the original itself spreads 0.005"),
        (0.103, 0.01, "box.x differs by 0.003, its tolerance is 0.01"),
        (0.106, 0.001, "box.x differs by 0.006, the original itself spreads 0.005"),  # in the room of a check
        (0.106, 0.006, "box.x differs by 0.006, the original itself spreads 0.005"),
    ],
)
def test_a_difference_within_the_spread_kills_nothing_and_is_reported(
    mutant: float, tolerance: float, said: str
) -> None:
    found = measured([0.1, 0.105, 0.102, 0.104, 0.101, 0.103], mutant, tolerance)
    assert candidates(PROJECT, SuiteChecks(PROJECT), found) == ([], {})
    assert why(found).startswith(said)


@pytest.mark.parametrize(
    ("place", "said"),
    [
        (0.1, ONLY_TIME),
        (0.103, "box.x differs by 0.003, its tolerance is 0.01"),
    ],
)
def test_a_clock_is_named_as_one_and_only_where_nothing_else_differs(place: float, said: str) -> None:
    usual = {"box.x": 0.1, "picture_time()": 5.0}
    found = Measured(
        originals={PLACE: {(round, PLACE.node): usual for round in range(6)}},
        mutants={PLACE: {MUTANT.id: {(0, PLACE.node): {"box.x": place, "picture_time()": 5.04}}}},
        readings={
            PLACE: [ReadExpression("box.x", PROBE, 0.01), ReadExpression("picture_time()", PROBE, 0.001)]
        },
    )
    assert why(found).startswith(said)


def test_a_difference_beyond_the_band_is_a_check() -> None:
    found = measured([0.1, 0.105, 0.102, 0.104, 0.101, 0.103], 0.5, 0.001)
    ((check,), _) = checks_of(PROJECT, found)
    assert check.trials == {(MUTANT.id, 0)}
    assert check.statement == "assert box.x == pytest.approx(0.1, abs=0.05)"


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
    statements = {check.statement for check in checks_of(PROJECT, found)[0]}
    assert statements == {"assert box.x == pytest.approx(target.x, abs=0.1)"}


def test_a_fact_is_held_against_its_value_and_not_against_another_fact() -> None:
    found = of(
        [{"stop.latched": True, "alarm.latched": True}] * 3,
        {"stop.latched": True, "alarm.latched": False},
        "stop.latched",
        "alarm.latched",
    )
    statements = {check.statement for check in checks_of(PROJECT, found)[0]}
    assert statements == {"assert alarm.latched"}


@pytest.mark.parametrize("test", ["", "assert robot.time < 30"])
def test_a_time_of_a_run_is_no_check_not_even_beside_a_deadline(test: str) -> None:
    found = of([{"robot.time": 10.0}] * 3, {"robot.time": 20.0}, "robot.time")
    project: Any = _Project(test)
    checks, refused = checks_of(project, found)
    assert checks == []
    assert refused == {MUTANT.id: ONLY_TIME}


def test_an_exact_value_is_no_check() -> None:
    found = of([{"box.x": 10.7134}] * 3, {"box.x": 10.7154}, "box.x")
    checks, refused = checks_of(PROJECT, found)
    assert checks == []
    assert refused[MUTANT.id].startswith("only an exact value would notice it: assert box.x == ")


@pytest.mark.parametrize(
    ("value", "apart", "statement"),
    [
        (0.025, 2e-5, None),
        (0.0, 2e-5, None),
        (0.025, 0.01, "assert box.x == pytest.approx(0.025, abs=0.002)"),
        (0.0, 0.01, "assert box.x == pytest.approx(0.0, abs=0.005)"),
    ],
)
def test_few_digits_with_a_tiny_tolerance_are_an_exact_value(
    value: float, apart: float, statement: str | None
) -> None:
    found = of([{"box.x": value}] * 3, {"box.x": value + apart}, "box.x")
    found.readings[PLACE] = [ReadExpression("box.x", PROBE, 1e-6)]
    checks, refused = checks_of(PROJECT, found)
    assert [check.statement for check in checks] == ([statement] if statement else [])
    assert bool(refused) == (statement is None)


def test_a_relation_is_no_more_exact_than_a_value() -> None:
    read = {"target.x": 0.4, "box.x": 0.4}
    found = of([read] * 3, {"target.x": 0.4, "box.x": 0.40002}, "box.x", "target.x")
    found.readings[PLACE] = [ReadExpression(text, PROBE, 1e-6) for text in read]
    assert checks_of(PROJECT, found)[0] == []


def test_a_relation_of_items_asks_for_lists_that_are_equal_throughout() -> None:
    lists = {
        "places[0]": [9.0, 8.0, 0.4],
        "places[2]": [0.1, 0.2, 0.4],
        "goal": [0.1, 0.2, 0.4],
        "arm.quaternion": [0.8, 0.48, 0.4],
        'said["gaps"]': [0.5, 0.45, 0.4],
    }
    read = {f"{name}[{item}]": value for name, items in lists.items() for item, value in enumerate(items)}
    found = of([read] * 3, read | {"places[2][2]": 0.9}, *read)
    said = of([read] * 3, read | {'said["gaps"][2]': 0.9}, *read)
    near, value = "assert {} == pytest.approx({}, abs=0.2)", "assert {} == pytest.approx(0.4, abs=0.02)"
    assert {check.statement for check in checks_of(PROJECT, found)[0]} == {
        near.format("places[2][2]", "goal[2]"),
        value.format("places[2][2]"),
    }
    assert {check.statement for check in checks_of(PROJECT, said)[0]} == {value.format('said["gaps"][2]')}


def test_two_lists_of_zeros_and_two_arguments_are_no_relation() -> None:
    read = dict.fromkeys(
        ("force[0]", "force[1]", "bend[0]", "bend[1]", 'arm.get("a/1")', 'cell.get("b/1")'), 0.0
    )
    for text in ("force[1]", 'arm.get("a/1")'):
        found = of([read] * 3, read | {text: 9.0}, *read)
        assert [check.value for check in checks_of(PROJECT, found)[0]] == [0.0]


def test_the_suites_tolerance_for_a_list_holds_for_all_items() -> None:
    found = of([{"places[2][0]": 300}] * 3, {"places[2][0]": 450}, "places[2][0]")
    stated = _Project("assert places[0] == pytest.approx([1, 2, 3], abs=2)")
    ((check,), _) = checks_of(stated, found)
    assert check.statement == "assert places[2][0] == pytest.approx(300.0, abs=2.0)"


def test_the_one_tolerance_of_a_test_holds_for_its_other_places() -> None:
    found = of([{"arm.z": 0.4, "arm.turn": 0.4}] * 3, {"arm.z": 0.7, "arm.turn": 0.7}, "arm.z", "arm.turn")
    stated = _Project("def test_it(arm):\n    assert arm.x == pytest.approx(0.3, abs=0.05)\n")
    checks, _ = checks_of(stated, found)
    assert {check.reading.text: check.tolerance for check in checks} == {"arm.z": 0.05, "arm.turn": 0.02}


def test_a_count_is_equal_and_not_near() -> None:
    ((check,), _) = checks_of(PROJECT, of([{"parts": 3}] * 3, {"parts": 4}, "parts"))
    assert check.statement == "assert parts == 3"


def test_a_length_is_equal_even_where_the_items_may_be_near() -> None:
    found = of([{"len(places)": 4}] * 3, {"len(places)": 5}, "len(places)")
    stated = _Project("assert places[0] == pytest.approx([1, 2, 3], abs=2)")
    ((check,), _) = checks_of(stated, found)
    assert check.statement == "assert len(places) == 4"


def test_the_expression_that_the_suite_reads_comes_first() -> None:
    texts = ("arm.x", "arm.z()")
    found = of([dict.fromkeys(texts, 1.0)] * 3, dict.fromkeys(texts, 9.0), *texts)
    checks, _ = checks_of(_Project("assert arm.z() > 0"), found)
    ranked = sorted(checks, key=lambda check: check.worth, reverse=True)
    assert [check.reading.text for check in ranked] == ["arm.z()", "arm.x"]


@pytest.mark.parametrize("quote", "'\"")
def test_what_the_suite_compares_is_known_whatever_its_quotes(quote: str) -> None:
    reading = 'said["here"]'
    found = of([{reading: 0.3}] * 3, {reading: 0.9}, reading)
    stated = _Project(f"assert said[{quote}here{quote}] == pytest.approx(0.5, abs=0.03)")
    ((check,), _) = checks_of(stated, found)
    assert (check.reading.way, check.tolerance) == (ORACLE, 0.03)


def test_a_check_stands_in_the_test_that_looks_at_the_same_thing() -> None:
    text = "def test_ends(end):\n    assert end\n\ndef test_x(end):\n    assert end[0] == 1.0\n"
    found = of([{"end[1]": 2.0}] * 3, {"end[1]": 9.0}, "end[1]")
    places = [PlaceInTest("pytest", PLACE.file, f"{PLACE.file}::{name}") for name in ("test_ends", "test_x")]
    both = Measured(
        originals=dict.fromkeys(places, found.originals[PLACE]),
        mutants=dict.fromkeys(places, found.mutants[PLACE]),
        readings=dict.fromkeys(places, found.readings[PLACE]),
    )
    checks, _ = checks_of(_Project(text), both)
    assert max(checks, key=lambda check: check.worth).place == places[1]


def test_what_the_tests_allow_holds_under_any_name() -> None:
    found = of([{"arm.x": 0.4, "arm.place()": 0.4}] * 3, {"arm.x": 0.45, "arm.place()": 0.45}, "arm.place()")
    stated = _Project("assert arm.x == pytest.approx(0.4, abs=0.1)")
    checks, refused = checks_of(stated, found)
    assert checks == []
    assert refused[MUTANT.id] == "arm.place() differs by 0.05, within your tolerance of 0.1"


@pytest.mark.parametrize(
    "text",
    [
        "assert 0.1 < arm.x <= 0.5",
        "MOST = 0.5\nself.assertTrue(MOST > arm.x > 0.1)",
        "assert -0.1 < arm.x < 0.5 and -0.05 < arm.x",
        "assert arm.x > 0.1\nassert 0.5 >= arm.x",
        "self.assertLess(arm.x, 0.5)\nself.assertGreaterEqual(arm.x, 0.1)",
    ],
)
@pytest.mark.parametrize(("far", "is_allowed"), [(0.15, True), (0.9, False)])
def test_half_of_a_range_is_a_tolerance(text: str, far: float, is_allowed: bool) -> None:
    found = of([{"arm.x": 0.4}] * 3, {"arm.x": 0.4 + far}, "arm.x")
    checks, refused = checks_of(_Project(text), found)
    assert ([check.tolerance or 0.0 for check in checks] == []) is is_allowed
    assert all((check.tolerance or 0.0) >= 0.2 for check in checks)
    assert ("within your tolerance of" in refused.get(MUTANT.id, "")) is is_allowed


def test_the_tolerance_is_that_of_the_suite_where_it_notices_as_much() -> None:
    found = of([{"box.x": 0.3}] * 3, {"box.x": 0.9}, "box.x")
    stated = _Project("assert cup.x == pytest.approx(0.5, abs=0.03)")
    ((check,), _) = checks_of(stated, found)
    assert check.statement == "assert box.x == pytest.approx(0.3, abs=0.03)"


class _Project:
    """A project of which only the text of the test counts."""

    suite_files = (PLACE.file,)

    def __init__(self, text: str = "") -> None:
        self._text = text

    def module(self, file: str) -> ast.Module:
        return ast.parse(self._text)


PROJECT: Any = _Project()


def checks_of(project: Any, found: Measured) -> tuple[list[CheckAtEnd], dict[str, str]]:
    """The checks of readings, and what is refused."""
    checks, refused = candidates(project, SuiteChecks(project), found)
    return [check for check in checks if isinstance(check, CheckAtEnd)], refused


def why(found: Measured) -> str:
    """The reason for the mutant of which nothing was recorded."""
    survivor = MutantResult(MUTANT, (), None, "")
    return why_unsolved(survivor, found, SuiteChecks(PROJECT), [], {}, {}).reason
