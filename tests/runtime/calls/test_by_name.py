"""What comes by under other names: where the robot is, and that it refuses a command."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.config.vocabulary import load_vocabulary
from tests.runtime.client import ClientStage
from tests.runtime.stage import take_away

VOCABULARY = """
[[operation]]
topic = "/arm/goal"
direction = "publish"
fields.x = { kind = "translation", axis = "x", unit = "m", mode = "to", relative = true }
current = "receive /arm/pose"
refused = [{ topic = "/arm/note", path = "code", values = [7] }]

[[operation]]
topic = "/arm/pose"
direction = "receive"
fields.x = { kind = "position", axis = "x", unit = "mm" }

[[operation]]
action = "/arm/follow"
goal.x = { kind = "translation", axis = "x", unit = "m", mode = "to", relative = true }
current = "parameter home"
refused = ["ABORTED"]

[[operation]]
parameter = "home"
value = { kind = "position", axis = "x", unit = "m" }
"""
PUBLISH = """
from types import SimpleNamespace as Message

def hear(message):
    global pose
    pose = message.x / 1000

def run(client):
    {before}
    goal = Message(x=pose + 0.25)
    client.publish("/arm/goal", goal)
    {after}
    return goal.x
"""
RECEIVED = 'client.receive("/arm/pose", Message(x=500), hear)'
GOAL = """
from types import SimpleNamespace as Message

def run(client):
    {before}
    client.send("/arm/follow", Message(x=6.0))
    {after}
"""


@pytest.fixture
def stage(tmp_path: Path) -> ClientStage:
    (tmp_path / "robot.toml").write_text(VOCABULARY)
    return ClientStage(tmp_path, load_vocabulary(["robot.toml"], tmp_path).operations)


def program(text: str, before: str = "pass", after: str = "pass") -> str:
    return text.replace("{before}", before).replace("{after}", after)


@pytest.mark.parametrize(("operator", "sent"), [("reverse", 0.25), ("by-to", 0.25)])
def test_a_hidden_relative_move_starts_at_what_was_received_last(
    stage: ClientStage, operator: str, sent: float
) -> None:
    result, client, activation = stage.mutated(program(PUBLISH, RECEIVED), operator, quantity="x")
    assert result == 0.75  # the program's own message
    assert [message.x for _, _, message in client.log] == [sent]  # 2 · 0.5 − 0.75, and 0.75 − 0.5
    assert activation.activity.acted == 1


def test_a_pose_that_another_file_receives_is_known_as_well(stage: ClientStage) -> None:
    heard = 'client.tell("/arm/pose", Message(x=500)); hear(Message(x=500))'
    _, client, _ = stage.mutated(program(PUBLISH, heard), "reverse", quantity="x")
    assert [message.x for _, _, message in client.log] == [0.25]


def test_nothing_is_mirrored_as_long_as_nothing_has_shown_where_it_is(stage: ClientStage) -> None:
    _, client, activation = stage.mutated(program(PUBLISH, "hear(Message(x=500))"), "reverse", quantity="x")
    assert [message.x for _, _, message in client.log] == [0.75]
    assert activation.activity.away == {"the position of the robot is not known yet": 1}
    assert activation.activity.failure is None


def test_a_parameter_may_be_where_the_robot_is(stage: ClientStage) -> None:
    _, client, _ = stage.mutated(program(GOAL, 'client.parameter("home")'), "reverse", quantity="x")
    assert [goal.x for _, _, goal in client.log] == [4.0]


@pytest.mark.parametrize(
    ("before", "after", "refusal"),
    [
        ("", 'client.tell("/arm/note", Message(code=7))', "/arm/note: code 7"),
        ("", 'client.tell("/arm/note", Message(code=6))', None),
        ("", 'client.tell("/arm/other", Message(code=7))', None),
        ('client.tell("/arm/note", Message(code=7))', "pass", None),
    ],
)
def test_a_message_after_a_mutated_command_says_that_it_is_refused(
    stage: ClientStage, before: str, after: str, refusal: str | None
) -> None:
    text = program(PUBLISH, "; ".join(filter(None, (RECEIVED, before))), after)
    _, _, activation = stage.mutated(text, "reverse", quantity="x")
    assert activation.activity.refusal == refusal


def test_the_end_of_a_goal_says_that_it_is_refused(stage: ClientStage) -> None:
    text = program(GOAL, 'client.parameter("home")', 'client.tell("/arm/follow", "ABORTED")')
    _, _, activation = stage.mutated(text, "reverse", quantity="x")
    assert activation.activity.refusal == "/arm/follow: ABORTED"


def test_a_command_that_the_mutant_leaves_alone_is_refused_for_its_own_reasons(stage: ClientStage) -> None:
    text = program(PUBLISH, "hear(Message(x=500))", 'client.tell("/arm/note", Message(code=7))')
    _, _, activation = stage.mutated(text, "reverse", quantity="x")
    assert activation.activity.refusal is None


def test_what_is_done_in_a_node_of_the_tests_is_the_oracles(stage: ClientStage) -> None:
    for nodes, wanted in (((), False), (("/miss*",), True), (("/checker",), False)):
        module = stage.program(program(PUBLISH, RECEIVED))
        session, client = stage.session(module, oracle_nodes=nodes)
        module.run(client)
        take_away(session)
        assert [(site.operation, site.oracle) for site in session.recorder.sites] == [
            ("receive /arm/pose", wanted),
            ("publish /arm/goal", wanted),
        ]


def test_a_site_of_both_roles_is_mutated_in_its_own_alone(stage: ClientStage) -> None:
    text = program(PUBLISH, RECEIVED)
    _, client, activation = stage.mutated(text, "reverse", quantity="x", oracle_nodes=("/mission",))
    assert [message.x for _, _, message in client.log] == [0.75]
    assert activation.activity.hits == 0
