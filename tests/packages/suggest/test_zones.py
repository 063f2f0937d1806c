"""Monitors tell survivors that go another way from every run of the original, with room on both sides."""

from __future__ import annotations

import ast
import json
import math
from collections.abc import Mapping, Sequence
from textwrap import indent
from typing import Any

import pytest

from mutabot_suggest import recorder, tick_recorder
from mutabot_suggest.checks import Monitor
from mutabot_suggest.editing import edited
from mutabot_suggest.project import PlaceInTest
from mutabot_suggest.readings import Measured
from mutabot_suggest.suite import SuiteChecks
from mutabot_suggest.zones import monitors

PLACE = PlaceInTest("pytest", "tests/test_it.py", "tests/test_it.py::test_it", ("cell",))
X, Z, BOX = "cell.truth.tool_position().x", "cell.truth.tool_position().z", "cell.truth.box_position().z"
THETA, OPENING = "cell.truth.tool_pose().theta_x", "cell.truth.opening()"
Moments = Mapping[str, Sequence[float]]


def noted_as(moments: Moments) -> dict[str, Any]:
    rows = [list(row) for row in zip(*moments.values(), strict=True)]
    return {"~cell": json.dumps([list(moments), rows])}


class Suite:
    """The files of a suite: one module."""

    suite_files = ("tests/monitors.py",)

    def __init__(self, text: str) -> None:
        self._module = ast.parse(text)

    def module(self, file: str) -> ast.Module:
        return self._module


def found(originals: Sequence[Moments], suite: str = "", **mutants: Moments) -> list[Monitor]:
    """The monitors, those that a person would rather write first."""
    measured = Measured(
        originals={
            PLACE: {(round, PLACE.node): noted_as(original) for round, original in enumerate(originals)}
        },
        mutants={PLACE: {name: {(0, PLACE.node): noted_as(mutant)} for name, mutant in mutants.items()}},
        readings={PLACE: []},
    )
    project: Any = Suite(suite)
    return sorted(monitors(SuiteChecks(project), measured), key=lambda monitor: monitor.worth, reverse=True)


def numbers(start: float, end: float, count: int = 11) -> list[float]:
    return [start + (end - start) * number / (count - 1) for number in range(count)]


def test_a_detour_breaks_a_bound_with_room_on_both_sides() -> None:
    originals = [{X: numbers(0.0, 0.4)}, {X: numbers(0.0, 0.402)}]
    best, *_ = found(originals, far=X_to(0.6), near=X_to(0.41))
    assert best.condition == f"{X} < 0.5"
    assert best.name == "tool x stays below 0.5"
    assert best.trials == frozenset({("far", 0)})


def X_to(end: float) -> Moments:  # noqa: N802  # it makes X
    return {X: numbers(0.0, end)}


@pytest.mark.parametrize("end", [0.402, 0.41, 0.425])
def test_what_is_hardly_farther_than_the_original_gets_no_monitor(end: float) -> None:
    assert found([X_to(0.4), X_to(0.402)], mutant=X_to(end)) == []


def test_one_bound_that_several_survivors_break_comes_first() -> None:
    best, *_ = found([X_to(0.4)], one=X_to(0.6), two=X_to(0.9), three={X: numbers(-0.6, 0.4)})
    assert {mutant for mutant, _ in best.trials} == {"one", "two"}


def test_a_short_cut_through_a_corner_gets_no_monitor_which_would_only_describe_this_path() -> None:
    up_and_over = {X: [*[0.0] * 11, *numbers(0.0, 0.5)], Z: [*numbers(0.0, 0.5), *[0.5] * 11]}
    straight = {X: numbers(0.0, 0.5, 22), Z: numbers(0.0, 0.5, 22)}
    assert found([up_and_over], mutant=straight) == []


def test_what_is_let_go_too_high_breaks_a_condition_on_the_opening() -> None:
    heights = [*numbers(1.0, 1.4), *numbers(1.4, 1.0)]
    closed_until_it_stands = {BOX: heights, OPENING: [0.05] * 21 + [0.085]}
    dropped = {BOX: heights, OPENING: [0.05] * 14 + [0.085] * 8}
    best, *_ = found([closed_until_it_stands], mutant=dropped)
    assert best.is_release
    assert best.condition.startswith(f"{BOX} < ")
    assert f" or {OPENING} < " in best.condition
    assert best.name.endswith("when the gripper opens")


SLIP, TOOL = f"{BOX} - {Z}", Z


def carried(slips: Sequence[float]) -> Moments:
    """A box that lies, is gripped, lifted by 0.4 m, set down and left, and slips so far at each moment."""
    carried = [*numbers(0.1, 0.5), *numbers(0.5, 0.1)]
    heights = [1.0 + z - 0.1 - slip for z, slip in zip(carried, slips, strict=True)]
    openings = [0.085, 0.085, *[0.05] * 22, 0.085, 0.085]
    return {BOX: [1.0, 1.0, *heights, 1.0, 1.0], TOOL: [0.3, 0.1, *carried, 0.1, 0.4], OPENING: openings}


@pytest.mark.parametrize("direction", [1, -1])
def test_what_slips_in_the_fingers_breaks_a_condition_on_its_distance_from_the_tool(direction: int) -> None:
    slipped = [*[0.0] * 8, *[direction * 0.009] * 14]
    best, *_ = found([carried([0.0] * 22), carried([0.0004] * 22)], mutant=carried(slipped))
    bound = float(best.condition.partition(f"abs({SLIP} - 0.9) < ")[2].partition(" or ")[0])
    assert 0.001 < bound < 0.009
    opening = float(best.condition.partition(f" or {OPENING} > ")[2])
    assert 0.055 < opening < 0.08
    assert best.name == "box stays in its place between the fingers"
    assert not best.is_release


def test_a_condition_on_a_slip_in_one_direction_is_broken_by_one_in_the_other_too() -> None:
    there, back = ([*[0.0] * 8, *[direction * 0.009] * 14] for direction in (1, -1))
    best, *_ = found([carried([0.0] * 22)], there=carried(there), back=carried(back))
    assert {mutant for mutant, _ in best.trials} == {"there", "back"}


def test_a_thing_held_in_the_middle_of_the_tool_is_compared_with_it_alone() -> None:
    def beside(slip: float) -> Moments:
        moments = carried([0.0] * 22)
        return {**moments, TOOL: moments[TOOL], BOX: [value + slip for value in moments[TOOL]]}

    best, *_ = found([beside(0.0)], mutant=beside(-0.009))
    assert best.condition.startswith(f"abs({SLIP}) < ")


@pytest.mark.parametrize("slip", [0.0, 0.002, 0.004])
def test_what_slips_hardly_farther_than_in_the_original_gets_no_monitor(slip: float) -> None:
    assert found([carried([0.0] * 22), carried([0.0004] * 22)], mutant=carried([slip] * 22)) == []


FORCE, SPEED = "cell.truth.wrench().force", "cell.truth.tool_speed()"


@pytest.mark.parametrize(
    ("reading", "usual", "greatest", "name"),
    [
        (FORCE, [9.0, 20.0, 9.0], 60.0, "force on the tool stays below 40 N"),
        (SPEED, [0.0, 0.5, 0.0], 1.1, "tool speed stays below 0.8 m/s"),
    ],
)
def test_a_hit_and_a_haste_break_an_upper_bound(
    reading: str, usual: list[float], greatest: float, name: str
) -> None:
    (monitor,) = found([{reading: usual}, {reading: usual}], mutant={reading: [0.0, greatest, 0.0]})
    assert monitor.name == name
    assert monitor.condition == f"{reading} < {name.split()[-2]}"


@pytest.mark.parametrize(("force", "speed"), [(25.0, 0.6), (3.0, 0.1)])
def test_a_little_more_force_or_speed_or_less_breaks_nothing(force: float, speed: float) -> None:
    usual = {FORCE: [9.0, 20.0], SPEED: [0.0, 0.5]}
    assert found([usual, usual], mutant={FORCE: [9.0, force], SPEED: [0.0, speed]}) == []


@pytest.mark.parametrize(
    ("suite", "count"),
    [
        ("MOST = 80.0\n\ndef is_gentle():\n    return math.hypot(wrench.fx, wrench.fy) < MOST", 0),
        ("assert 80 > cell.truth.wrench().force", 0),
        ("assert cell.truth.wrench().force < 30", 1),
        ("assert cell.time < 80", 1),
    ],
)
def test_no_monitor_of_a_force_asks_for_less_than_the_suite(suite: str, count: int) -> None:
    usual = {FORCE: [9.0, 20.0, 9.0]}
    assert len(found([usual, usual], suite, mutant={FORCE: [9.0, 60.0, 9.0]})) == count


def test_an_angle_that_is_kept_has_bounds_and_one_that_turns_has_none() -> None:
    kept, turned = {THETA: [180.0 - 91.0, 90.0, 91.0]}, {THETA: [89.0, 150.0, -170.0]}
    best, *_ = found([kept], mutant=turned)
    assert THETA in best.condition
    assert found([{THETA: [0.0, 90.0, 180.0]}], mutant={THETA: [0.0, 90.0, 250.0]}) == []


def test_a_long_monitor_is_written_as_formatters_do() -> None:
    slipped = [*[0.0] * 8, *[0.009] * 14]
    (best, *_) = found([carried([0.0] * 22)], mutant=carried(slipped))
    text = f"if cell:\n{indent(best.statement, '    ')}\n"
    assert max(map(len, text.splitlines())) <= 88
    assert ast.unparse(ast.parse(best.statement)) == (f"cell.always(lambda: {best.condition}, '{best.name}')")


def test_a_monitor_stands_behind_what_it_watches_and_is_a_statement() -> None:
    text = '"""T."""\n\n\ndef test_it(new_cell):\n    """Says so."""\n    cell = new_cell(3)\n    run(cell)\n'
    (monitor,) = found([X_to(0.4)], mutant=X_to(0.9))[:1]

    class Project:
        own_modules: frozenset[str] = frozenset()

        def text(self, file: str) -> str:
            return text

    project: Any = Project()
    (changed,) = edited(project, [monitor.addition()]).values()
    (test,) = [statement for statement in ast.parse(changed).body if isinstance(statement, ast.FunctionDef)]
    assert [ast.unparse(statement).partition("(")[0] for statement in test.body[1:]] == [
        "cell = new_cell",
        "cell.always",
        "run",
    ]


class Truth:
    def __init__(self) -> None:
        self.x = 0.0

    def tool(self) -> float:
        return self.x

    def box(self, name: str) -> float:
        return math.nan


class Cell:
    """What can be watched."""

    def __init__(self) -> None:
        self.truth = Truth()
        self.conditions: list[Any] = []

    def always(self, condition: Any, name: str) -> None:
        self.conditions.append(condition)


def test_the_way_of_an_object_that_can_be_watched_is_noted_at_the_end_of_the_test() -> None:
    cell = Cell()
    tick_recorder.watch("cell", cell)
    tick_recorder.watch("number", 3)
    for number in range(5_000):
        cell.truth.x = float(number)
        assert all(condition() for condition in cell.conditions)
    recorder.note({})
    texts, rows = json.loads(recorder.values()["~cell"])
    assert texts == ["cell.truth.tool()"]
    assert 400 <= len(rows) <= 801
    recorder.note({})
    assert recorder.values() == {}, "the next test has its own way"


class Press:
    """What can be watched, and presses for one tick."""

    def __init__(self) -> None:
        self.truth, self.tick = self, 0
        self.conditions: list[Any] = []

    def always(self, condition: Any, name: str) -> None:
        self.conditions.append(condition)

    def force(self) -> float:
        return 70.0 if self.tick == 3_001 else 1.0


def test_a_force_of_one_tick_is_noted_between_ticks_that_are() -> None:
    press = Press()
    tick_recorder.watch("press", press)
    for press.tick in range(1, 6_000):
        assert all(condition() for condition in press.conditions)
    texts, rows = json.loads(tick_recorder.recordings()["~press"])
    assert texts == ["press.truth.force()"]
    assert sorted(value for (value,) in rows)[-2:] == [1.0, 70.0]
