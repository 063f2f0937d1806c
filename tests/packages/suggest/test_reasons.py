"""Where no check is suggested, the true reason is told once for all survivors that share it."""

from __future__ import annotations

import ast
from dataclasses import replace
from textwrap import dedent
from typing import Any

import pytest

from mutabot.model import Mutant, Outcome, Role, Site, Span, Verdict
from mutabot.model.outcome import Check, Looked
from mutabot.model.world_difference import Apart, Diverged, Measurement
from mutabot.results.results import MutantResult
from mutabot_suggest.candidates import ONLY_TIME
from mutabot_suggest.checks import CheckAtEnd, Monitor
from mutabot_suggest.output import print_suggestions
from mutabot_suggest.places import chosen_places, other_places
from mutabot_suggest.project import PlaceInTest
from mutabot_suggest.readings import PROBE, Measured, ReadExpression
from mutabot_suggest.reasons import why_unsolved
from mutabot_suggest.results import Suggestions, Unsolved
from mutabot_suggest.suite import SuiteChecks

SITE = Site(Span("mission.py", 1, 0, 1, 5, "run"), "arm.go", 1, Role.PROGRAM)
PLACE = PlaceInTest("pytest", "tests/test_it.py", "tests/test_it.py::test_it")
TESTS = """
    def test_it(arm):
        assert arm.x == approx(0.3, abs=0.02)

    def test_other(arm):
        assert arm

    def test_lost(arm):
        assert arm
"""


def mutant(number: int = 1) -> Mutant:
    return Mutant(number, "robot", "skip", SITE, "robot:go", None, None, "", f"arm.go: skip {number}")


def survivor(*diverged: Diverged, number: int = 1) -> MutantResult:
    target = mutant(number)
    looked = tuple(Looked(test.test, acted=True) for test in diverged)
    outcome = Outcome(target.id, 0, Verdict.SURVIVED, diverged=diverged, looked=looked)
    return MutantResult(target, (outcome,), None, "")


def apart(final: float, aside: float = 0.0, *, spread: float = 0.0001) -> Apart:
    return Apart("box", "m", 1.0, max(final, aside), 2.0, final, aside, 0.001, spread, spread)


def in_test(name: str, story: str, *parts: Apart, scatters: str = "") -> Diverged:
    return Diverged(f"tests/test_it.py::{name}", 1.0, "", story, parts, scatters=scatters)


class Project:
    """A project with one file of tests."""

    suite_files = ("tests/test_it.py",)

    def module(self, file: str) -> ast.Module | None:
        return ast.parse(dedent(TESTS)) if file == "tests/test_it.py" else None


@pytest.fixture
def suite() -> SuiteChecks:
    project: Any = Project()
    return SuiteChecks.of(project)


def reason(suite: SuiteChecks, *diverged: Diverged) -> str:
    (check,) = suite.checks
    read = {f"{check.key}.actual": 0.3, f"{check.key}.expected": 0.3, f"{check.key}.tolerance": 0.02}
    measured = Measured(originals={PLACE: {(0, PLACE.node): read}})
    return why_unsolved(survivor(*diverged), measured, suite, [], {}, {}).reason


def test_a_survivor_that_could_not_be_compared_is_not_explained_by_readings_that_scatter(
    suite: SuiteChecks,
) -> None:
    gap = "equal runs of the original differ in tests/test_it.py::test_it"
    uncompared = survivor()
    outcomes = [replace(outcome, gaps=(gap,)) for outcome in uncompared.survived]
    uncompared = replace(uncompared, rounds=tuple(outcomes))
    readings = {PLACE: [ReadExpression("start", PROBE, 0.01)]}
    drawn = {(round, PLACE.node): {"start": 4.0 * round} for round in range(3)}
    measured = Measured({PLACE: drawn}, {PLACE: {mutant().id: {(0, PLACE.node): {"start": 2.0}}}}, readings)
    found = why_unsolved(uncompared, measured, suite, [], {}, {})
    assert found.reason == f"it could not be compared with the original: {gap}"


def test_without_a_probe_the_reason_asks_for_one_and_with_one_for_a_check_on_the_way(
    suite: SuiteChecks,
) -> None:
    plain = survivor()
    probed = replace(plain, rounds=tuple(replace(outcome, distance=0.4) for outcome in plain.survived))
    reasons = [why_unsolved(each, Measured(), suite, [], {}, {}).reason for each in (plain, probed)]
    assert [reason.partition("differs")[2] for reason in reasons] == [
        "; a [[probe]] in the vocabulary may show more",
        ": a check on the way may notice it",
    ]


@pytest.mark.parametrize("refused", [{}, {mutant().id: ONLY_TIME}])
@pytest.mark.parametrize("read", [{}, {"volume": 2.1}])
def test_what_a_probe_shows_on_the_way_is_the_reason_before_noise_and_times(
    suite: SuiteChecks, refused: dict[str, str], read: dict[str, float]
) -> None:
    line = "on the way, after call 4, mission.py:2 arm.take: arm.held: 0 instead of 100 (off by 100)"
    (outcome,) = survivor().survived
    seen = replace(survivor(), rounds=(replace(outcome, divergence=("the clock is late", line)),))
    drawn = {(round, PLACE.node): {"volume": 2.0 + 0.08 * round} for round in range(2)}
    readings = {PLACE: [ReadExpression("volume", PROBE, 0.01)]}
    measured = Measured({PLACE: drawn}, {PLACE: {mutant().id: {(0, PLACE.node): read}}}, readings)
    assert why_unsolved(seen, measured, suite, [], {}, refused).reason.startswith(f"{line}; ")


@pytest.mark.parametrize(
    ("text", "is_allowed"),
    [
        ("abs(mission.run(arm) - 0.3) < 0.01", True),
        ("mission.rerun(arm) < 0.4", False),  # of another function
        ("arm.x < 0.4", False),
    ],
)
def test_a_returned_value_that_a_check_lets_through_is_the_reason(
    suite: SuiteChecks, text: str, is_allowed: bool
) -> None:
    line = "run returned 0.294 instead of 0.3 (off by 0.006)"
    looked = Looked("tests/test_it.py::test_it", acted=True, checks=(Check("t.py:4", text, "", 0.004),))
    (outcome,) = survivor().survived
    seen = replace(survivor(), rounds=(replace(outcome, divergence=(line,), looked=(looked,)),))
    found = why_unsolved(seen, Measured(), suite, [], {}, {}).reason
    assert (found == f"{line}, which your check allows: {text}") is is_allowed


def test_what_ends_within_the_suites_tolerance_is_reported_as_such(suite: SuiteChecks) -> None:
    told = in_test("test_it", "box ended 1.4 mm from its position", apart(0.0014, 0.0049))
    assert reason(suite, told) == "at most 4.9 mm, within your smallest tolerance of 20 mm"


@pytest.mark.parametrize("is_of_the_way", [True, False])
def test_a_failed_check_of_the_end_is_no_reason_where_only_the_way_differs(
    suite: SuiteChecks, is_of_the_way: bool
) -> None:
    trials = frozenset({(mutant().id, 0)})
    monitor = Monitor(place=PLACE, trials=trials, owner="arm", condition="arm.x < 1", name="", distance=2.0)
    end = CheckAtEnd(place=PLACE, trials=trials, reading=ReadExpression("belt(arm)", PROBE, 0.01), value=1.09)
    (check,) = suite.checks
    read = {f"{check.key}.actual": 0.3, f"{check.key}.expected": 0.3, f"{check.key}.tolerance": 0.02}
    detour = survivor(in_test("test_it", "box left its path by up to 0.2 m", apart(0.0014, 0.2)))
    measured = Measured(originals={PLACE: {(0, PLACE.node): read}})
    tried = [end, *([monitor] if is_of_the_way else [])]
    failed = dict.fromkeys(tried, "fails in the original with a new seed")
    told = why_unsolved(detour, measured, suite, tried, failed, {}).reason
    assert told == (
        f"what would notice it, the original itself breaks with another seed: {monitor.statement}"
        if is_of_the_way
        else "box left its path by up to 0.2 m: at the end within your smallest tolerance of 20 mm; "
        "no bound on the way distinguishes it from the original"
    )


def test_a_small_detour_is_reported_with_the_tolerance_at_the_end(suite: SuiteChecks) -> None:
    told = in_test("test_it", "box left its path by up to 25 mm", apart(0.001, 0.025))
    assert reason(suite, told) == (
        "box left its path by up to 25 mm: at the end within your smallest tolerance of 20 mm; "
        "on the way it is too near to the original for a bound"
    )


def test_what_turns_as_the_original_turns_is_reported_as_such(suite: SuiteChecks) -> None:
    turned = Apart("box turned", "deg", 1.0, 78.0, 2.0, 0.1, 78.0, 0.5)
    told = in_test("test_it", "box was turned by up to 78 deg on its way", apart(0.001, 0.015), turned)
    assert reason(suite, told).endswith(
        "no bound on the way distinguishes it from the original, which turns as well"
    )


def test_a_large_detour_without_a_bound_is_not_said_to_be_small(suite: SuiteChecks) -> None:
    told = in_test("test_it", "box left its path by up to 0.2 m", apart(0.001, 0.2))
    assert reason(suite, told).endswith("no bound on the way distinguishes it from the original")


def test_where_only_times_differ_the_reason_is_a_deadline(suite: SuiteChecks) -> None:
    told = in_test("test_it", "the same movements happened up to 1.5 s later", apart(0.0))
    assert reason(suite, told) == "only times differ: add a deadline if the task has one"


def test_what_slips_on_its_way_is_reported_though_no_position_differs(suite: SuiteChecks) -> None:
    late = Apart("box", "m", 1.0, 0.04, 2.0, 0.0, 0.0, 0.04, 0.0001, 0.05)
    told = in_test("test_it", "box slipped 9.3 mm (original: 0.23 mm) in the grip", late)
    assert reason(suite, told).startswith("box slipped 9.3 mm (original: 0.23 mm) in the grip: nothing that")


@pytest.mark.parametrize(
    ("slip", "said"),
    [
        (0.0093, "within your smallest tolerance of 20 mm"),
        (0.031, "nothing that its tests can read distinguishes it"),
    ],
)
def test_a_slip_that_the_suite_allows_at_the_end_is_reported_with_its_tolerance(
    suite: SuiteChecks, slip: float, said: str
) -> None:
    slipped = Measurement("slip", "box", "m", slip, 0.0002, 5.0, 0.001)
    story = in_test("test_it", "box slipped in the grip")
    assert reason(suite, replace(story, measurements=(slipped,), apart=(late(),))).startswith(
        f"box slipped in the grip: {said}"
    )


def late() -> Apart:
    return Apart("box", "m", 1.0, 0.04, 2.0, 0.0, 0.0, 0.04, 0.0001, 0.05)


def test_the_same_reason_is_reported_once(capsys: pytest.CaptureFixture[str]) -> None:
    texts: list[str] = []

    class Context:
        def print(self, text: str) -> None:
            texts.append(text)

        def print_section(self, title: str, lines: list[str], at_most: int = 0) -> None:
            texts.extend([title, *lines])

    unsolved = (
        Unsolved("a", "nothing differs", never=True),
        Unsolved("b", "only times differ"),
        Unsolved("c", "nothing differs", never=True),
    )
    context: Any = Context()
    print_suggestions(context, Suggestions(unsolved=unsolved, numbers={"a": 31, "b": 2, "c": 5}))
    assert "#5, #31: nothing differs" in texts
    assert "#2 : only times differ" in texts


def test_one_test_is_looked_at_if_it_shows_all_survivors() -> None:
    both = [in_test("test_it", "box", apart(0.2)), in_test("test_other", "box", apart(0.2))]
    other = [in_test("test_other", "box", apart(0.3))]
    project: Any = Project()
    places = chosen_places(project, [survivor(*both), survivor(*other, number=2)])
    assert [place.path for place in places] == [("test_other",)]


def test_where_no_check_is_found_a_test_in_which_few_mutants_act_is_looked_at_too() -> None:
    tests = [in_test(name, "tool", apart(0.0, 0.1)) for name in ("test_lost", "test_it", "test_other")]
    here, everywhere = survivor(*tests), survivor(*tests[:2], number=2)
    project: Any = Project()
    places = chosen_places(project, [here, everywhere])
    assert [place.path for place in places] == [("test_it",)]
    others = other_places(project, [here, everywhere], [here], places)
    assert [other.path for other in others] == [("test_other",)]
    assert other_places(project, [here, everywhere], [], places) == []
    near = survivor(*(in_test(name, "tool", apart(0.0, 0.00005)) for name in ("test_it", "test_other")))
    assert other_places(project, [here], [near], places) == []


def test_a_test_whose_end_scatters_is_not_looked_at_where_another_shows_the_survivor() -> None:
    tests = [
        in_test("test_lost", "box", apart(9.0), scatters="box by 0.5 m"),
        in_test("test_it", "box", apart(0.05)),
    ]
    project: Any = Project()
    assert [place.path for place in chosen_places(project, [survivor(*tests)])] == [("test_it",)]


def test_a_survivor_is_looked_at_where_it_differs_most_and_where_its_end_differs() -> None:
    tests = [
        in_test("test_it", "box", apart(0.0, 0.9)),
        in_test("test_other", "box", apart(0.05, 0.0)),
    ]
    project: Any = Project()
    places = chosen_places(project, [survivor(*tests)])
    assert {place.path for place in places} == {("test_it",), ("test_other",)}
