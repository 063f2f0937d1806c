"""What the plan has of the family ``middleware``, from calls that a baseline has recorded."""

from __future__ import annotations

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.plan import Plan, make_plan
from mutabot.families import MIDDLEWARE, ROBOT
from mutabot.faults import Project
from mutabot.model import Operation, Role, Site, Span, Vocabulary
from mutabot.model.mutant import Place
from mutabot.model.operation import Form
from mutabot.original import Hit
from mutabot_catalogue._examples import (
    ADVERTISE,
    HEARD_FRAME,
    HEARD_STAMP,
    PUBLISH,
    RECEIVE,
    SPEED,
    TICK,
)


def planned(operation: Operation, *hits: Hit, role: Role = Role.PROGRAM, family: str = MIDDLEWARE) -> Plan:
    """The plan for calls at one site."""
    site = Site(Span("mission.py", 3, 0, 3, 9, "run"), "client.do", 1, role)
    baseline = Baseline(hits={Place(site, operation.target): list(hits)})
    return make_plan(baseline, Project(vocabulary=Vocabulary((operation,)), families=(family,)))


def kinds(plan: Plan) -> list[str]:
    """Operators and variants of the mutants."""
    return [mutant.id.partition(":call:")[2] or mutant.id.rpartition(":")[2] for mutant in plan.mutants]


def reasons(plan: Plan, operator: str) -> list[str]:
    return [omission.reason for omission in plan.left_out if operator in omission.id]


def test_a_message_that_is_published_once_has_no_other_before_it() -> None:
    plan = planned(PUBLISH, Hit({"x": 0.4}, {}))
    wanted = ["drop", "duplicate", "delay=0.1", "delay=1", "kill-node", "restart-node"]
    assert kinds(plan) == wanted
    assert reasons(plan, "stale") == ["takes 2 calls in a test, and no test makes more than 1"] * 2
    assert reasons(plan, "every-3rd") == ["takes 3 calls in a test, and no test makes more than 1"]


def test_messages_of_other_tests_do_not_come_before_one() -> None:
    plan = planned(PUBLISH, *(Hit({"x": 0.1 * number}, {}, (0, f"test_{number}")) for number in range(4)))
    assert reasons(plan, "stale") == ["takes 2 calls in a test, and no test makes more than 1"] * 2
    one_test = planned(PUBLISH, *(Hit({"x": 0.1 * number}, {}, (0, "test")) for number in range(4)))
    assert not reasons(one_test, "stale")


def test_of_many_messages_each_fault_is_planned_however_equal_they_look() -> None:
    plan = planned(RECEIVE, *[Hit({}, {"gap": 0.4})] * 4)
    assert {"stale=first", "stale=previous", "reorder", "drop=every-3rd", "drop=30%"} <= set(kinds(plan))


def test_a_node_is_not_killed_for_what_the_tests_read() -> None:
    found = kinds(planned(RECEIVE, Hit({}, {"gap": 0.4}), role=Role.ORACLE))
    assert found == ["drop", "duplicate", "delay=0.1", "delay=1"]


def test_settings_that_would_stay_the_same_are_left_out_with_the_reason() -> None:
    given = {"name": "/arm/target", "depth": 1, "reliability": "reliable", "deadline": 0.0}
    plan = planned(ADVERTISE, Hit(given, {}))
    assert kinds(plan) == ["wrong-name=misspelt", "wrong-reliability", "wrong-deadline=tight"]
    assert reasons(plan, "wrong-name") == ["would change nothing in the call: its name is global already"]
    assert reasons(plan, "short-queue") == ["would change nothing in the call: the value would stay the same"]
    assert reasons(plan, "flip-latch") == [
        "would change nothing in the call: its middleware has no such setting, or chooses it itself"
    ]
    assert reasons(plan, "wrong-deadline") == ["would change nothing in the call: it has no deadline"]


def test_a_parameter_whose_default_is_what_was_set_is_left_out() -> None:
    assert kinds(planned(SPEED, Hit({"default": 1.0}, {"value": 0.25}))) == ["use-default"]
    plan = planned(SPEED, Hit({"default": 0.25}, {"value": 0.25}))
    assert reasons(plan, "use-default") == ["would change nothing in the call: it has its default"]


def test_ticks_may_be_lost_and_the_clock_may_jump() -> None:
    found = kinds(planned(TICK, *[Hit({}, {})] * 3))
    assert {"drop", "drop=every-3rd", "duplicate", "delay=1", "jump-clock=10", "jump-clock=-10"} <= set(found)
    assert "stale=first" not in found


def test_operators_of_robots_leave_settings_alone() -> None:
    given = {"name": "/x", "reliability": "reliable", "latch": True, "period": 0.1, "depth": 10}
    plan = planned(ADVERTISE, Hit(given, {}), family=ROBOT)
    assert not plan.mutants
    assert not plan.left_out


def test_operators_of_robots_leave_headers_alone() -> None:
    hear = Operation.under_name(Form.RECEIVE, "/scan", result=(HEARD_STAMP, HEARD_FRAME))
    header = Hit({}, {"header.stamp": 20.0, "header.frame_id": "base"})
    assert not planned(hear, header, family=ROBOT).mutants
    found = kinds(planned(hear, header))
    assert {"wrong-frame=unknown", "wrong-frame=empty", "shift-stamp=-5", "empty-stamp"} <= set(found)
