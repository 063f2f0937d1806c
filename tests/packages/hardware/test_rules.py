"""Rules of a guard: what is within a limit, a workspace, an order."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from mutabot.errors import UsageError
from mutabot.model import Call, Kind, Operation, Path, Quantity
from mutabot.model.quantity import Mode
from mutabot_hardware.choice import HardwareChoice
from mutabot_hardware.guard import TableGuard, idle_part
from mutabot_hardware.tables import GuardTable, HardwareTable


def quantity(
    name: str, axis: str | None, kind: Kind = Kind.TRANSLATION, unit: str = "m", **more: Any
) -> Quantity:
    mode = {"mode": Mode.TO} if kind is Kind.TRANSLATION else {}
    return Quantity(name, Path.parse(name, rooted=True), kind, axis, unit, **{**mode, **more})


MOVE = Operation(
    "robot:Arm.move_to",
    arguments=(quantity("x", "x"), quantity("z", "z"), quantity("speed", None, Kind.SPEED, "m/s")),
)
CLAMP, DRILL, RELEASE, TOOL = (Operation(f"robot:{name}") for name in ("clamp", "drill", "release", "tool"))
CHANGE = Operation("robot:tool", arguments=(quantity("name", None, Kind.LABEL, None),))  # type: ignore[arg-type]
NUMBERS = st.floats(allow_nan=True, allow_infinity=True)


def why(
    guard: TableGuard, values: Mapping[str, Any] = {}, operation: Operation = MOVE, **more: Any
) -> str | None:
    return guard.why_not(Call(operation, values=values, **more), {})


@given(x=NUMBERS, z=NUMBERS, margin=st.floats(0.0, 0.1))
def test_exactly_what_lies_in_the_workspace_passes(x: float, z: float, margin: float) -> None:
    guard = TableGuard({"box": [{"x": [0.2, 0.8], "z": [0.1, 0.9], "margin": margin}]})
    is_in = (
        x - 0.2 - margin >= 0 and 0.8 - margin - x >= 0 and z - 0.1 - margin >= 0 and 0.9 - margin - z >= 0
    )
    assert (why(guard, {"x": x, "z": z}) is None) is is_in


@given(x=NUMBERS, z=NUMBERS)
def test_what_lies_in_a_box_to_avoid_does_not_pass_nor_what_is_no_number(x: float, z: float) -> None:
    guard = TableGuard({"box": [{"x": [0.4, 0.5], "z": [0.1, 0.3], "keep": "out"}]})
    is_in = 0.4 < x < 0.5 and 0.1 < z < 0.3
    is_number = math.isfinite(x) and math.isfinite(z)
    assert (why(guard, {"x": x, "z": z}) is not None) >= (is_in or not is_number)
    if is_number and not (0.4 <= x <= 0.5 and 0.1 <= z <= 0.3):
        assert why(guard, {"x": x, "z": z}) is None


def test_a_move_by_an_amount_counts_by_where_it_leads() -> None:
    by = Operation("robot:Arm.move_by", arguments=(quantity("dx", "x", mode=Mode.BY),))

    async def current(quantity: Quantity) -> float:
        return 0.6

    guard = TableGuard({"box": [{"x": [0.2, 0.8]}]})
    assert why(guard, {"dx": 0.1}, by, current=current) is None
    assert why(guard, {"dx": 0.3}, by, current=current) == "dx leads to 0.9 m, the workspace is 0.2 to 0.8 m"


def test_a_move_whose_end_nothing_shows_does_not_pass() -> None:
    by = Operation("robot:Arm.move_by", arguments=(quantity("dx", "x", mode=Mode.BY),))
    found = why(TableGuard({"box": [{"x": [0.2, 0.8]}]}), {"dx": 0.1}, by)
    assert found == "where dx leads to is not known: no reading gives the robot's present position"


def test_limits_are_in_their_own_unit() -> None:
    guard = TableGuard({"limit": [{"kind": "speed", "max": 250.0, "unit": "mm/s"}]})
    assert why(guard, {"speed": 0.25}) is None
    assert why(guard, {"speed": 0.3}) == "speed 300 mm/s, allowed is at most 250 mm/s"


@pytest.mark.parametrize("speed", [float("nan"), float("inf"), float("-inf")])
def test_a_limit_lets_no_number_pass_that_is_none(speed: float) -> None:
    guard = TableGuard({"limit": [{"kind": "speed", "min": 0.0, "max": 0.25}]})
    assert "allowed is at least 0 m/s and at most 0.25 m/s" in str(why(guard, {"speed": speed}))


@pytest.mark.parametrize("end", ["min", "max"])
def test_a_limit_with_one_end_names_that_one_of_what_is_no_number(end: str) -> None:
    guard = TableGuard({"limit": [{"kind": "speed", end: 0.1}]})
    words = {"min": "at least", "max": "at most"}[end]
    assert why(guard, {"speed": float("nan")}) == f"speed nan m/s, allowed is {words} 0.1 m/s"


def test_what_the_guard_cannot_read_does_not_pass_where_a_rule_needs_it() -> None:
    guard = TableGuard({"limit": [{"kind": "speed", "max": 0.25}]})
    assert guard.why_not(Call(MOVE), {"arguments.speed": "it is a box"}) == "it is a box"


def test_forbidden_operations_do_not_pass() -> None:
    guard = TableGuard({"forbid": ["robot:dr*"]})
    assert why(guard, operation=DRILL) == "is forbidden"
    assert why(guard, operation=CLAMP) is None


def test_a_command_passes_only_after_the_one_that_has_to_come_before() -> None:
    table = {"operations": ["robot:drill"], "after": ["robot:clamp"], "until": ["robot:release"]}
    guard = TableGuard({"order": [table]})
    found = [
        why(guard, operation=operation) is None
        for operation in (DRILL, CLAMP, DRILL, RELEASE, DRILL, CLAMP, DRILL)
    ]
    assert found == [False, True, True, True, False, True, True]
    guard.start_test()
    assert why(guard, operation=DRILL) == "is allowed only after robot:clamp"


def test_a_limit_of_a_tool_holds_while_that_is_mounted() -> None:
    guard = TableGuard({"tool": "robot:tool name", "box": [{"z": [0.5, 0.9], "tool": "drill"}]})
    assert why(guard, {"name": "gripper"}, CHANGE) is None
    assert why(guard, {"z": 0.2}) is None
    assert why(guard, {"name": "drill"}, CHANGE) is None
    assert why(guard, {"z": 0.2}) == "z leads to 0.2 m, the workspace is 0.5 to 0.9 m"
    assert why(guard, {"name": "gripper"}, CHANGE) is None
    assert why(guard, {"z": 0.2}) is None


def test_the_rules_of_all_tools_hold_until_a_tool_is_known() -> None:
    guard = TableGuard(
        {
            "tool": "robot:tool name",
            "box": [{"z": [0.5, 0.9], "tool": "drill"}],
            "limit": [{"kind": "translation", "max": 0.8, "tool": "gripper"}],
        }
    )
    for _ in range(2):
        assert why(guard, {"z": 0.2}) is not None
        assert why(guard, {"z": 0.85}) is not None
        assert why(guard, {"z": 0.6}) is None
        assert why(guard, {"name": "drill"}, CHANGE) is None
        assert why(guard, {"z": 0.85}) is None
        guard.start_test()


def test_who_says_which_tool_is_mounted_is_an_operation_of_the_vocabulary() -> None:
    table = {"tool": "robot:tool name", "box": [{"z": [0.5, 0.9]}]}
    assert idle_part(GuardTable.model_validate(table), [MOVE, CHANGE]) is None
    for lost in ("robot:tool title", "robot:tools name", "robot:tool"):
        said = idle_part(GuardTable.model_validate({**table, "tool": lost}), [MOVE, CHANGE])
        assert said is not None
        assert repr(lost) in said


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (
            {"box": [{"z": [0.0, 1.0], "tool": "drill"}]},
            "the tool 'drill', but tool does not say what mounts",
        ),
        ({"limit": [{"kind": "speed"}]}, "needs min, max or both"),
        ({"limit": [{"min": 1.0, "max": 0.0}]}, "leaves no value: min 1 and max 0, margin 0"),
        ({"box": [{}]}, "needs x, y or z"),
        ({"box": [{"x": [1.0, 0.0]}]}, "x begins at 1, beyond its end 0"),
    ],
)
def test_a_rule_that_means_nothing_is_refused(table: dict[str, Any], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        TableGuard(table)


@pytest.mark.parametrize("lacking", ["safe_state", "heartbeat"])
def test_hardware_needs_a_safe_state_and_a_heartbeat(lacking: str) -> None:
    table = HardwareTable.model_validate({"safe_state": "io:a", "heartbeat": "io:b", lacking: None})
    with pytest.raises(UsageError, match=f"nothing runs without {lacking}, such as"):
        HardwareChoice(table).fitted(None)  # type: ignore[arg-type]  # it is not asked before
