"""What befalls messages on their way: operators at work on a client library of a middleware."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from mutabot.model.operation import Form, Operation, Refused
from mutabot_catalogue._examples import (
    ADVERTISE,
    CALL,
    FRAME,
    GOAL,
    PUBLISH,
    RECEIVE,
    SPEED,
    STAMP,
    TICK,
)
from tests.runtime.client import ClientStage, LostAnswerError

POINT = "from types import SimpleNamespace as Point\n"
SEND = f"""{POINT}
def run(client):
    message = Point(x=0.0)
    for x in (1.0, 2.0, 3.0, 4.0):
        message.x = x  # one object for all messages
        client.publish("/arm/target", Point(x=x) if {{fresh}} else message)
    return "done"
"""
ASK = """
def run(client):
    return client.call("/gripper/close", "now").asked
"""
HEAR = f"""{POINT}
def run(client):
    heard = []

    def hear(message):
        heard.append((client.now, message.gap))
        message.gap = None  # the program may use what it got

    for gap in (0.1, 0.2, 0.3):
        client.receive("/gap", Point(gap=gap), hear)
        client.now += 1.0
    client.spin()
    return heard
"""
WAIT = """
def run(client):
    return [client.wait("/gap").gap for _ in range(2)]
"""


@pytest.fixture
def stage(tmp_path: Path) -> ClientStage:
    return ClientStage(tmp_path, (PUBLISH, RECEIVE, CALL, GOAL))


def sent(stage: ClientStage, operator: str, variant: str = "", *, fresh: bool = True) -> list[Any]:
    """What reaches the robot of messages 1, 2, 3, 4, all sent at 0 s."""
    result, client, _ = stage.mutated(SEND.replace("{fresh}", str(fresh)), operator, variant)
    assert result == "done"
    client.spin()
    return [(now, message.x) for now, _, message in client.log]


def heard(stage: ClientStage, operator: str, variant: str = "") -> list[Any]:
    """What the program hears of 0.1, 0.2, 0.3, which come at 0, 1, 2 s."""
    found, _, _ = stage.mutated(HEAR, operator, variant)
    assert isinstance(found, list), found
    return found


def waited(stage: ClientStage, operator: str, variant: str = "") -> Any:
    """What a program gets that waits for two messages of four."""
    return stage.mutated(WAIT, operator, variant, coming=coming())[0]


def coming() -> list[Any]:
    return [SimpleNamespace(gap=gap) for gap in (0.1, 0.2, 0.3, 0.4)]


def test_what_is_dropped_reaches_nobody(stage: ClientStage) -> None:
    assert sent(stage, "drop") == []
    assert heard(stage, "drop") == []


def test_every_third_is_dropped(stage: ClientStage) -> None:
    assert sent(stage, "drop", "every-3rd") == [(0.0, 1.0), (0.0, 2.0), (0.0, 4.0)]
    assert heard(stage, "drop", "every-3rd") == [(0.0, 0.1), (1.0, 0.2)]


def test_who_waits_for_a_message_that_is_lost_waits_for_the_next(stage: ClientStage) -> None:
    assert isinstance(waited(stage, "drop"), TimeoutError)


def test_waiting_on_is_one_call_however_many_messages_are_lost(tmp_path: Path) -> None:
    coming = [SimpleNamespace(gap=0.1)] * 4
    stage = ClientStage(tmp_path, (RECEIVE,))
    result, _, activation = stage.mutated(WAIT, "drop", coming=coming)
    assert isinstance(result, TimeoutError)
    assert activation.activity.hits == 5
    assert stage.counted == 1


def test_a_request_that_is_lost_is_never_answered(stage: ClientStage) -> None:
    result, client, activation = stage.mutated(ASK, "drop")
    assert isinstance(result, LostAnswerError)
    assert client.log == []
    assert (activation.activity.acted, activation.activity.failure) == (1, None)


def test_a_duplicate_comes_twice(stage: ClientStage) -> None:
    assert sent(stage, "duplicate")[:3] == [(0.0, 1.0), (0.0, 1.0), (0.0, 2.0)]
    assert heard(stage, "duplicate")[:3] == [(0.0, 0.1), (0.0, 0.1), (1.0, 0.2)]


def test_who_waits_for_one_message_hears_no_second(stage: ClientStage) -> None:
    result, _, activation = stage.mutated(WAIT, "duplicate", coming=coming())
    assert result == [0.1, 0.2]
    assert (activation.activity.hits, activation.activity.acted) == (2, 0)
    assert activation.activity.away == {"who waits for one message hears no second": 2}


@pytest.mark.parametrize("fresh", [True, False])
def test_a_stale_message_is_as_it_was_when_it_was_sent(stage: ClientStage, fresh: bool) -> None:
    assert [x for _, x in sent(stage, "stale", "first", fresh=fresh)] == [1.0, 1.0, 1.0, 1.0]
    assert [x for _, x in sent(stage, "stale", "previous", fresh=fresh)] == [1.0, 1.0, 2.0, 3.0]


def test_a_stale_message_is_heard_as_it_came(stage: ClientStage) -> None:
    assert [gap for _, gap in heard(stage, "stale", "first")] == [0.1, 0.1, 0.1]
    assert [gap for _, gap in heard(stage, "stale", "previous")] == [0.1, 0.1, 0.2]


def test_what_cannot_be_known_before_is_said(stage: ClientStage) -> None:
    _, _, activation = stage.mutated(SEND.replace("{fresh}", "True"), "stale", "first")
    assert activation.activity.hits == 4
    assert activation.activity.acted == 3
    assert activation.activity.away == {"no call came before it": 1}


def test_what_is_published_late_goes_out_by_itself(stage: ClientStage) -> None:
    assert sent(stage, "delay", "1") == [(1.0, 1.0), (1.0, 2.0), (1.0, 3.0), (1.0, 4.0)]


def test_what_comes_late_is_heard_late(stage: ClientStage) -> None:
    assert [gap for _, gap in heard(stage, "delay", "1")] == [0.1, 0.2, 0.3]
    assert min(now for now, _ in heard(stage, "delay", "1")) == 1.0


def test_who_waits_for_a_late_answer_waits_longer(stage: ClientStage) -> None:
    answer, client, _ = stage.mutated(ASK, "delay", "1")
    assert (answer, client.log[0][0], client.now) == ("now", 1.0, 1.0)


def test_messages_change_places(stage: ClientStage) -> None:
    assert [x for _, x in sent(stage, "reorder", fresh=False)] == [2.0, 1.0, 4.0, 3.0]
    assert [gap for _, gap in heard(stage, "reorder")] == [0.2, 0.1]


def test_a_message_that_comes_after_the_one_waited_for_is_lost(stage: ClientStage) -> None:
    result, _, activation = stage.mutated(WAIT, "reorder", coming=coming())
    assert result == [0.2, 0.4]
    assert activation.activity.acted == 2


def test_a_goal_is_cancelled_once_it_is_sent(stage: ClientStage) -> None:
    text = "def run(client):\n    return client.send('/arm/follow', 7)\n"
    result, client, _ = stage.mutated(text, "cancel-goal")
    assert (result, client.cancelled, len(client.log)) == (7, [7], 1)


def test_an_answer_is_lost_after_the_service_has_done_its_work(stage: ClientStage) -> None:
    result, client, _ = stage.mutated(ASK, "lose-answer")
    assert isinstance(result, LostAnswerError)
    assert len(client.log) == 1


def test_the_process_of_the_tests_is_never_killed(stage: ClientStage) -> None:
    for operator in ("kill-node", "restart-node"):
        result, _, activation = stage.mutated(ASK, operator)
        assert result == "now"
        assert activation.activity.acted == 0
        assert activation.activity.away == {"the program runs in the tests' own process": 1}


@pytest.mark.parametrize(("variant", "expected"), [("10", 10.0), ("-10", -10.0)])
def test_a_clock_jumps_once(tmp_path: Path, variant: str, expected: float) -> None:
    text = """
def run(client):
    for _ in range(3):
        client.tick(check)

def check(event):
    pass
"""
    _, client, activation = ClientStage(tmp_path, (TICK,)).mutated(text, "jump-clock", variant)
    assert client.jumped == expected
    assert activation.activity.acted == 1


SET_UP = """
from mutabot.model.operation import Form, Operation, Refused

def run(client):
    client.set_up(Form.ADVERTISE, name="target", depth=10, reliability="reliable", deadline=0.0, latch=False)
"""


@pytest.mark.parametrize(
    ("operator", "variant", "setting", "expected"),
    [
        ("wrong-name", "misspelt", "name", "target_misspelt"),
        ("wrong-name", "global", "name", "/target"),
        ("short-queue", "", "depth", 1),
        ("flip-latch", "", "latch", True),
        ("wrong-reliability", "", "reliability", "best_effort"),
        ("wrong-deadline", "tight", "deadline", 0.001),
    ],
)
def test_one_setting_is_another(
    tmp_path: Path, operator: str, variant: str, setting: str, expected: Any
) -> None:
    stage = ClientStage(tmp_path, (ADVERTISE,))
    _, client, activation = stage.mutated(SET_UP, operator, variant, setting)
    usual = {"name": "target", "depth": 10, "reliability": "reliable", "deadline": 0.0, "latch": False}
    assert client.log == [{**usual, setting: expected}]
    assert activation.activity.example == (usual[setting], expected)


def test_a_setting_that_the_middleware_does_not_have_stays_away(tmp_path: Path) -> None:
    stage = ClientStage(tmp_path, (ADVERTISE,))
    _, _, activation = stage.mutated(SET_UP, "wrong-durability", "", "durability")
    assert activation.activity.away == {"its middleware has no such setting, or chooses it itself": 1}


@pytest.mark.parametrize(("default", "expected"), [(1, 1), (5, 5)])
def test_a_parameter_has_its_default(tmp_path: Path, default: int, expected: int) -> None:
    text = f"def run(client):\n    return client.parameter('speed', default={default})\n"
    result, _, activation = ClientStage(tmp_path, (SPEED,)).mutated(text, "use-default", "", "value")
    assert result == expected
    assert activation.activity.acted == int(default != 5)


HEADER = f"""{POINT}
def run(client):
    message = Point(header=Point(frame_id="base", stamp=Point(sec=20, nanosec=5)))
    client.publish("/arm/target", message)
    return message.header.frame_id, message.header.stamp.sec
"""


@pytest.mark.parametrize(
    ("operator", "variant", "quantity", "expected"),
    [
        ("wrong-frame", "", "header.frame_id", ("tool", 20, 5)),
        ("wrong-frame", "empty", "header.frame_id", ("", 20, 5)),
        ("shift-stamp", "-5", "header.stamp", ("base", 15, 5)),
        ("empty-stamp", "", "header.stamp", ("base", 0, 0)),
    ],
)
def test_the_header_of_a_copy_is_wrong(
    tmp_path: Path, operator: str, variant: str, quantity: str, expected: Any
) -> None:
    send = Operation.under_name(Form.PUBLISH, "/arm/target", (FRAME, STAMP))
    own, client, _ = ClientStage(tmp_path, (send,)).mutated(HEADER, operator, variant, quantity)
    assert own == ("base", 20)
    (_, _, message) = client.log[0]
    stamp = message.header.stamp
    assert (message.header.frame_id, stamp.sec, pytest.approx(stamp.nanosec, abs=2)) == expected


TOLD = f"""{POINT}
runs = []

def first(client):
    client.publish("/arm/target", Point(x=1.0))
    client.tell("/arm/status", Point(status=4))

def second(client):
    client.publish("/arm/target", Point(x=2.0))
    client.tell("/arm/status", Point(status=6))

def run(client):
    runs.append(client)
    # the site that is found last is mutated
    for step in (first, second) if len(runs) > 1 else (second, first):
        step(client)
"""


@pytest.mark.parametrize(
    ("operator", "quantity", "said"),
    [("repeat", None, "/arm/status: status 6"), ("reverse", "x", None), ("skip", None, None)],
)
def test_a_refusal_belongs_to_the_command_that_is_due(
    tmp_path: Path, operator: str, quantity: str | None, said: str | None
) -> None:
    refusing = replace(PUBLISH, refused=(Refused(".status", (6,), "/arm/status"),))
    stage = ClientStage(tmp_path, (refusing,))
    _, _, activation = stage.mutated(TOLD, operator, quantity=quantity)
    assert activation.activity.acted == 1
    assert activation.activity.refusing_answer == said
