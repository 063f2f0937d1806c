"""What befalls messages on their way: operators at work on a client library of a middleware."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mutabot.operators.middleware._examples import CALL, GOAL, PUBLISH, RECEIVE
from tests.inside.client import ClientStage, LostAnswerError

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
    from types import SimpleNamespace  # noqa: PLC0415

    coming = [SimpleNamespace(gap=gap) for gap in (0.1, 0.2, 0.3, 0.4)]
    return stage.mutated(WAIT, operator, variant, coming=coming)[0]


def test_what_is_dropped_reaches_nobody(stage: ClientStage) -> None:
    assert sent(stage, "drop") == []
    assert heard(stage, "drop") == []


def test_every_third_is_dropped(stage: ClientStage) -> None:
    assert sent(stage, "drop", "every-3rd") == [(0.0, 1.0), (0.0, 2.0), (0.0, 4.0)]
    assert heard(stage, "drop", "every-3rd") == [(0.0, 0.1), (1.0, 0.2)]


def test_who_waits_for_a_message_that_is_lost_waits_for_the_next(stage: ClientStage) -> None:
    assert isinstance(waited(stage, "drop"), TimeoutError)


def test_a_request_that_is_lost_is_never_answered(stage: ClientStage) -> None:
    result, client, activation = stage.mutated(ASK, "drop")
    assert isinstance(result, LostAnswerError)
    assert client.log == []
    assert (activation.evidence.acted, activation.evidence.failure) == (1, None)


def test_a_duplicate_comes_twice(stage: ClientStage) -> None:
    assert sent(stage, "duplicate")[:3] == [(0.0, 1.0), (0.0, 1.0), (0.0, 2.0)]
    assert heard(stage, "duplicate")[:3] == [(0.0, 0.1), (0.0, 0.1), (1.0, 0.2)]
    assert waited(stage, "duplicate") == [0.1, 0.1]


@pytest.mark.parametrize("fresh", [True, False])
def test_a_stale_message_is_as_it_was_when_it_was_sent(stage: ClientStage, fresh: bool) -> None:
    assert [x for _, x in sent(stage, "stale", "first", fresh=fresh)] == [1.0, 1.0, 1.0, 1.0]
    assert [x for _, x in sent(stage, "stale", "previous", fresh=fresh)] == [1.0, 1.0, 2.0, 3.0]


def test_a_stale_message_is_heard_as_it_came(stage: ClientStage) -> None:
    assert [gap for _, gap in heard(stage, "stale", "first")] == [0.1, 0.1, 0.1]
    assert [gap for _, gap in heard(stage, "stale", "previous")] == [0.1, 0.1, 0.2]


def test_what_cannot_be_known_before_is_said(stage: ClientStage) -> None:
    _, _, activation = stage.mutated(SEND.replace("{fresh}", "True"), "stale", "first")
    assert activation.evidence.hits == 4
    assert activation.evidence.acted == 3
    assert activation.evidence.away == {"there is none before it": 1}
