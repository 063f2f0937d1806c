"""What counts as agreement between a verdict and plain pytest."""

from __future__ import annotations

import pytest

from .agreement import Verdict, left_out
from .judge import Judgement


def verdict(ours: str, plain: Judgement, test: str | None = None) -> Verdict:
    return Verdict("project", "replay", "mission.py:run:arm.move#1:call:skip", 1, "", ours, test, "", plain)


@pytest.mark.parametrize(
    ("ours", "state", "agrees"),
    [
        ("killed", "fails", True),
        ("killed", "hangs", True),
        ("killed", "passes", False),
        ("timeout", "hangs", True),
        ("timeout", "passes", False),
        ("invalid", "fails", True),
        ("invalid", "passes", False),
        ("survived", "passes", True),
        ("survived", "fails", False),
        ("no effect", "passes", True),
        ("no effect", "fails", False),
        ("not covered", "fails", False),
        ("left out", "passes", True),
        ("left out", "fails", False),
        ("error", "fails", False),
        ("error", "passes", False),
        ("unstable", "passes", False),
    ],
)
def test_a_verdict_agrees_if_plain_pytest_ends_as_it_says(ours: str, state: str, agrees: bool) -> None:
    assert verdict(ours, Judgement(state)).agrees is agrees


@pytest.mark.parametrize(
    ("ours", "refused", "agrees"),
    [("refused", True, True), ("refused", False, False), ("killed", True, False), ("killed", False, True)],
)
def test_refused_means_that_the_robot_refused_the_mutated_call(
    ours: str, refused: bool, agrees: bool
) -> None:
    assert verdict(ours, Judgement("fails", refused=refused)).agrees is agrees


def test_what_the_judge_cannot_write_is_not_compared() -> None:
    assert not verdict("killed", Judgement("unwritable")).compared


@pytest.mark.parametrize(
    ("failing", "another"),
    [("test_a.py::test_one", False), ("test_a.py", False), ("test_a.py::test_two", True)],
)
def test_a_kill_names_a_test_that_fails_in_plain_pytest(failing: str, another: bool) -> None:
    found = verdict("killed", Judgement("fails", (failing,)), "test_a.py::test_one")
    assert found.names_another_test is another


def test_what_the_plan_leaves_out_stands_where_other_mutants_of_the_call_stand() -> None:
    site = "mission.py:run:arm.move#1"
    mutant = {"id": f"{site}:call:skip", "operation": "robot:Arm.move", "pattern": None, "span": {"line": 7},
              "operator": "skip", "variant": "", "quantity": None, "description": "do nothing"}  # fmt: skip
    nothing = {
        "id": f"{site}:dx:reverse",
        "description": "0 m",
        "reason": "would change nothing in any of 2 calls",
    }
    elsewhere = {**nothing, "id": "mission.py:stop:arm.move#1:dx:reverse"}
    for_another_reason = {**nothing, "id": f"{site}:dx:by-to", "reason": "where it is cannot be read"}
    data = {"mutants": [mutant], "left_out": [nothing, elsewhere, for_another_reason]}
    (found,) = left_out(data)
    assert (found["operator"], found["quantity"], found["span"]) == ("reverse", "dx", {"line": 7})
    assert found["rounds"] == [{"verdict": "left out"}]


def test_what_is_left_out_under_a_name_is_about_the_operation_that_it_names() -> None:
    site = "mission.py:run:wait#1"
    common = {"pattern": None, "variant": "", "quantity": None, "description": ""}
    publish = {
        **common,
        "id": f"{site}:call:drop",
        "operation": "publish /wait of /mission",
        "operator": "drop",
    }
    advertise = {**common, "id": f"{site}:depth:short-queue", "operation": "advertise /wait of /mission",
                 "operator": "short-queue"}  # fmt: skip
    nothing = {
        "id": f"{site}:deadline:wrong-deadline=none",
        "description": "advertise /wait: deadline 0 s → 0 s",
        "reason": "would change nothing in the call: it has no deadline",
    }
    for mutants in ([publish, advertise], [advertise, publish], [publish]):
        (found,) = left_out({"mutants": mutants, "left_out": [nothing]})
        assert found["operation"] == "advertise /wait"
        assert (found["operator"], found["variant"]) == ("wrong-deadline", "none")
