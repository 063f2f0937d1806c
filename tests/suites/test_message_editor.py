"""The third judge edits what nodes say and hear as people would: in the program, and in its client."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from textwrap import dedent
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from .editor import CannotWriteError, Facts
from .judge import PLANTED
from .message_editor import edits_of, noting_refusals

FILES = {
    "mission.py": "def run(arm):\n    arm.move(0.5)\n    return see()\n",
    "client.py": """
        class Arm:
            def move(self, x):
                subscribe("/arm/ended", self.ends.append)
                message = Twist(x)
                self.publisher.publish(message)
    """,
    "mutabot.toml": 'program = ["mission.py"]\nvocabulary = ["robot.toml"]',
    "robot.toml": """
        [[operation]]
        topic = "/arm/*"
        direction = "publish"
        fields."linear.x" = { kind = "translation", axis = "x", unit = "m", mode = "by" }

        [[operation]]
        topic = "/colour"
        direction = "receive"
        fields.data = { kind = "label", values = [1, 2, 3] }
    """,
    "judge.toml": """
        refused = [["client.py", "self.ends.append", "message.status == 5"]]
        [raw]
        "publish /arm/move" = ["client.py", "self.publisher.publish(message)"]
    """,
}
M = '__import__("_planted_messages")'
P = '__import__("_planted")'


@pytest.fixture
def facts(tmp_path: Path) -> Facts:
    for name, text in FILES.items():
        (tmp_path / name).write_text(dedent(text))
    return Facts.of(tmp_path)


@pytest.fixture
def planted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """What edited copies call, as it stands beside them."""
    for file in PLANTED:
        (tmp_path / f"_{file.name}").write_text(file.read_text())
    monkeypatch.syspath_prepend(tmp_path)
    yield import_module("_planted_messages")
    for file in PLANTED:
        sys.modules.pop(f"_{file.stem}", None)


def mutant(operator: str, operation: str, quantity: str | None = None, variant: str = "") -> dict[str, Any]:
    line, call = (2, "arm.move(0.5)") if "move" in operation else (3, "see()")
    column = FILES["mission.py"].splitlines()[line - 1].index(call) + 1
    span = {"line": line, "column": column, "end_line": line, "end_column": column + len(call)}
    return {"id": "x", "family": "robot", "file": "mission.py", "span": span, "operator": operator,
            "operation": operation, "quantity": quantity, "variant": variant, "description": ""}  # fmt: skip


def edited(facts: Facts, mutant: dict[str, Any]) -> str:
    return "\n".join(edit.text for edit in edits_of(facts, mutant))


def test_the_clients_call_is_edited_and_acts_below_the_programs_call_only(facts: Facts) -> None:
    text = edited(facts, mutant("reverse", "publish /arm/move of /mission", "linear.x"))
    assert text.splitlines() == [
        f'{M}.armed("site", arm.move)',
        f'{M}.only_below("site", self.publisher.publish, '
        f"{M}.with_message({M}.field('linear.x', {P}.negative)))",
    ]


def test_a_call_of_the_client_library_in_the_program_is_edited_there(facts: Facts) -> None:
    text = edited(facts, mutant("misread", "receive /colour", "data", "+2"))
    pairs = "{1: 3, 2: 1, 3: 2}"
    change = f"{M}.field('data', {P}.partial({P}.other, {pairs}))"
    assert text == f'{M}.armed("site", {M}.with_reply({change})(see))'


def test_a_refusal_is_noted_where_the_client_hears_of_it(facts: Facts) -> None:
    (edit,) = noting_refusals(facts)
    told = edit.applied((facts.folder / "client.py").read_bytes()).decode()
    assert f'("/arm/ended", {M}.hearing(self.ends.append, lambda message: message.status == 5))' in told


@pytest.mark.parametrize("operator", ["cancel-goal", "reverse"])
def test_what_the_editor_does_not_know_is_said(facts: Facts, operator: str) -> None:
    with pytest.raises(CannotWriteError):
        edits_of(facts, mutant(operator, "publish /arm/move", "no.such.field"))


WAYS: dict[str, tuple[Callable[[Any], Any], list[int]]] = {
    "each is lost": (lambda m: m.lost("", m.nothing(lambda: None)), []),
    "every third is lost": (lambda m: m.lost("every-3rd", m.nothing(lambda: None)), [1, 2, 4]),
    "always the first": (lambda m: m.with_message(m.stale("first")), [1, 1, 1, 1]),
    "always the previous": (lambda m: m.with_message(m.stale("previous")), [1, 1, 2, 3]),
    "two by two": (lambda m: m.held_back(), [2, 1, 4, 3]),
}


@pytest.mark.parametrize("name", WAYS)
def test_messages_on_their_way(planted: ModuleType, name: str) -> None:
    way, expected = WAYS[name]
    sent: list[int] = []
    publish = way(planted)(sent.append)
    for number in (1, 2, 3, 4):
        publish(number)
    assert sent == expected


def test_a_field_is_changed_in_a_copy(planted: ModuleType) -> None:
    message = SimpleNamespace(linear=SimpleNamespace(x=0.5))
    assert planted.field("linear.x", lambda x: -x)(message).linear.x == -0.5
    assert message.linear.x == 0.5


def test_only_calls_below_the_site_are_mutated(planted: ModuleType) -> None:
    def publish(value: int) -> int:
        return planted.only_below("site", int, planted.with_message(lambda x: -x))(value)  # type: ignore[no-any-return]

    assert (publish(3), planted.armed("site", publish)(3), publish(3)) == (3, -3, 3)


def test_a_refusal_is_the_mutated_commands_until_the_next_one(
    planted: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("JUDGE_NOTES", str(tmp_path / "notes"))
    hear = planted.hearing(lambda message: None, lambda message: message == "refused")

    def publish() -> None:
        planted.only_below("site", int, lambda function: function)()

    noted = []
    for command in (publish, planted.armed("site", publish), publish):
        command()
        hear("done")
        hear("refused")
        noted.append((tmp_path / "notes").exists())
        (tmp_path / "notes").unlink(missing_ok=True)
    assert noted == [False, True, False]


@pytest.mark.parametrize("answered", [1, 2])
def test_of_a_command_that_is_sent_twice_the_second_answer_may_come_after_the_next_command(
    planted: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, answered: int
) -> None:
    monkeypatch.setenv("JUDGE_NOTES", str(tmp_path / "notes"))
    hear = planted.hearing(lambda message: None, lambda message: message == "refused")

    def publish() -> None:
        planted.only_below("site", int, import_module("_planted").twice)()

    planted.armed("site", publish)()
    for _ in range(answered):
        hear("done")
    publish()
    hear("refused")
    hear("refused")
    noted = (tmp_path / "notes").read_text().split() if (tmp_path / "notes").exists() else []
    assert len(noted) == 2 - answered


@pytest.mark.parametrize(
    ("given", "named", "latched"),
    [((), {}, True), ((), {"latch": True}, False), ((None, False, True), {}, False)],
)
def test_a_publisher_latches_or_not_as_it_did_not(
    planted: ModuleType, given: tuple[Any, ...], named: dict[str, Any], latched: bool
) -> None:
    def publisher(
        name: str, data_class: type, listener: Any = None, tcp: bool = False, latch: bool = False
    ) -> bool:
        return latch

    assert planted.other_latch(publisher)("/arm/move", int, *given, **named) is latched


@pytest.mark.parametrize(("variant", "deadline"), [("tight", "0.001"), ("none", "None")])
def test_a_deadline_is_the_variants_whatever_it_was(facts: Facts, variant: str, deadline: str) -> None:
    text = edited(facts, mutant("wrong-deadline", "advertise /colour", "deadline", variant))
    assert text == f'{M}.armed("site", {M}.with_deadline({deadline})(see))'


def test_what_the_middleware_does_not_have_cannot_be_edited(facts: Facts) -> None:
    latch = mutant("flip-latch", "advertise /colour", "latch")
    assert "other_latch" in edited(facts, latch)
    facts.hints["ros2"] = True
    with pytest.raises(CannotWriteError, match="latch"):
        edits_of(facts, latch)
