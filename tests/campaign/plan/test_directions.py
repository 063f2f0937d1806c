"""Which speeds and ratios are reversed: those of which a negative value makes sense."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.plan import Plan, make_plan
from mutabot.families import CATALOGUE, GRADED, MIDDLEWARE, ROBOT
from mutabot.faults import Project
from mutabot.model import Kind, Mode, Operation, Path, Quantity, Role, Site, Span, Vocabulary
from mutabot.model.mutant import Place
from mutabot.model.operation import Form, Named
from mutabot.original import Hit, RecordedAnswers

SPEED = Quantity("speed", Path("speed"), Kind.SPEED, unit="m/s")
RATIO = Quantity("power", Path("power"), Kind.RATIO, unit="percent")
COMPONENT = Path.parse("message.twist.linear.x", rooted=True)
VECTOR = Path.parse("xd[0:6]", rooted=True)
TWIST = {"linear.x": 0.5, "linear.y": -0.1, "linear.z": 0.0, "angular.z": 0.25}


def plan_of(
    quantities: Sequence[Quantity], *calls: dict[str, Any], families: Sequence[str] = (ROBOT,)
) -> Plan:
    """The plan for calls of one operation, each at a place of its own."""
    named = Named(Form.PUBLISH, "/cmd_vel", None)
    operation = Operation(named.target, tuple(quantities), kind="messages", named=named)
    places = [
        Place(
            Site(Span("drive.py", line, 4, line, 30, "run"), "publish", line, Role.PROGRAM), operation.target
        )
        for line in range(1, len(calls) + 1)
    ]
    hits = {place: [Hit(call, {})] for place, call in zip(places, calls, strict=True)}
    answers = {place: RecordedAnswers() for place in hits}
    project = Project(vocabulary=Vocabulary((operation,)), families=tuple(families))
    return make_plan(Baseline(hits=hits, answers=answers), project)


def reversals(plan: Plan) -> list[str]:
    return [mutant.description.partition(": ")[2] for mutant in plan.mutants if mutant.operator == "reverse"]


def reason(plan: Plan) -> str:
    (text,) = [omission.reason for omission in plan.left_out if omission.id.endswith(":reverse")]
    return text


@pytest.mark.parametrize(
    ("quantity", "value", "changed"),
    [
        (replace(SPEED, axis="x"), 0.5, "speed (x) 0.5 m/s → -0.5 m/s"),
        (replace(SPEED, axis="j2", unit="rad/s"), -1.5, "speed (j2) -1.5 rad/s → 1.5 rad/s"),
        (replace(SPEED, range=(-1.0, 1.0)), 0.5, "speed 0.5 m/s → -0.5 m/s"),
        (replace(SPEED, clip=(-1.0, 1.0)), 0.5, "speed 0.5 m/s → -0.5 m/s"),
        (replace(SPEED, values=(-1.0, 0.0, 1.0)), 1.0, "speed 1 m/s → -1 m/s"),
        (
            replace(SPEED, path=Path.parse("message.twist.linear.x", rooted=True)),
            0.5,
            "speed 0.5 m/s → -0.5 m/s",
        ),
        (replace(SPEED, path=Path.parse("xd[0:6]", rooted=True)), [0.5, -0.1, 0], "[-0.5, 0.1, 0]"),
        (replace(RATIO, range=(-100, 100)), 30, "power 30 percent → -30 percent"),
    ],
)
def test_what_has_a_direction_is_reversed(quantity: Quantity, value: Any, changed: str) -> None:
    (description,) = reversals(plan_of([quantity], {quantity.name: value}))
    assert description.endswith(changed)


@pytest.mark.parametrize(
    ("quantity", "value"),
    [
        (replace(SPEED, range=(0.0, 1.0)), 0.5),
        (replace(SPEED, axis="x", range=(0.0, 1.0)), 0.5),
        (replace(SPEED, values=(0.25, 0.5)), 0.5),
        (replace(RATIO, clip=(0, 100)), 30),
    ],
)
def test_what_the_vocabulary_says_is_a_magnitude_is_no_place_for_reverse(
    quantity: Quantity, value: Any
) -> None:
    plan = plan_of([quantity], {quantity.name: value})
    assert not [mutant for mutant in (*plan.mutants, *plan.left_out) if mutant.id.endswith(":reverse")]


def test_a_speed_of_which_nothing_is_said_is_left_out_with_what_to_say() -> None:
    plan = plan_of([SPEED], {"speed": 0.5})
    assert not reversals(plan)
    assert reason(plan) == (
        "no negative value of this speed or ratio was recorded, so it may have no direction; if it has one, "
        "give it an axis, or a range or clip that goes below 0"
    )


def test_a_negative_value_at_one_place_shows_that_the_quantity_has_a_direction_everywhere() -> None:
    plan = plan_of([SPEED], {"speed": 0.5}, {"speed": -0.25})
    assert reversals(plan) == ["speed 0.5 m/s → -0.5 m/s", "speed -0.25 m/s → 0.25 m/s"]


def test_a_reversed_speed_beyond_the_range_is_left_out() -> None:
    plan = plan_of([replace(SPEED, range=(-0.2, 1.0))], {"speed": 0.5})
    assert "within the values that the vocabulary allows" in reason(plan)


def test_a_speed_of_zero_has_no_other_way() -> None:
    assert reason(plan_of([replace(SPEED, axis="x")], {"speed": 0.0})).startswith("would change nothing")


def described(name: str, *, is_right: bool) -> Quantity:
    """A component of a Twist, as a speed, or wrongly as an amount of motion."""
    turns = name.startswith("angular")
    path = Path.parse(f"message.{name}", rooted=True)
    if is_right:
        return Quantity(name, path, Kind.SPEED, name[-1], "rad/s" if turns else "m/s")
    kind = Kind.ROTATION if turns else Kind.TRANSLATION
    return Quantity(name, path, kind, name[-1], "rad" if turns else "m", mode=Mode.BY)


@pytest.mark.parametrize("families", [(ROBOT,), (ROBOT, MIDDLEWARE), (ROBOT, MIDDLEWARE, CATALOGUE, GRADED)])
def test_a_twist_of_speeds_has_no_fewer_mutants_than_one_of_translations(families: Sequence[str]) -> None:
    right, wrong = (
        plan_of([described(name, is_right=is_right) for name in TWIST], TWIST, families=families).mutants
        for is_right in (True, False)
    )
    assert len(right) >= len(wrong)
    assert {mutant.quantity for mutant in right if mutant.operator == "reverse"} == {
        "linear.x",
        "linear.y",
        "angular.z",
    }
