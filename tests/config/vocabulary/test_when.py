"""Entries that are meant of some calls of a callable alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.config.vocabulary import load_vocabulary
from mutabot.model import Operation, Vocabulary
from mutabot.model.codec import from_data, to_data
from tests.config.vocabulary.test_named import loaded, refused

CALL = 'call = "robot:Arm.send"\n'
GRIP = 'when = { argument = "kind", value = "gripper" }\n'
MOVE = 'when = { argument = "kind", value = "move" }\n'
OPENING = 'arguments.value = { kind = "opening", values = [0, 1] }\n'
SHIFT = 'arguments.value = { kind = "translation", axis = "x", unit = "m", mode = "by" }\n'


def only(folder: Path, text: str) -> Operation:
    (operation,) = loaded(folder, text).operations
    return operation


def test_entries_for_one_callable_are_one_operation_with_a_pattern_each(tmp_path: Path) -> None:
    grips = f"[[operation]]\n{CALL}{GRIP}{OPENING}command = false\nidle = 3\n"
    text = f"{grips}[[operation]]\n{CALL}{MOVE}{SHIFT}"
    operation = only(tmp_path, text)
    grip, move = operation.patterns
    assert (grip.name, move.name) == ("kind=gripper", "kind=move")
    assert [argument.kind.value for each in (grip, move) for argument in each.arguments] == [
        "opening",
        "translation",
    ]
    assert (grip.command, move.command, operation.command) == (False, True, True)
    assert (grip.idle, move.idle, operation.idle) == (3, None, None)
    assert operation.is_partial
    assert not operation.arguments
    assert [each.source.partition(" ")[0] for each in (grip, move)] == ["robot.toml:1", "robot.toml:7"]
    vocabulary = Vocabulary((operation,))
    assert from_data(Vocabulary, to_data(vocabulary)) == vocabulary


def test_several_cases_all_have_to_fit(tmp_path: Path) -> None:
    when = 'when = [{ argument = "self.name", value = "left" }, { argument = "cmd[\'on\']", value = true }]\n'
    (pattern,) = only(tmp_path, f"[[operation]]\n{CALL}{when}").patterns
    assert pattern.name == "self.name=left, cmd['on']=true"
    assert [(condition.argument, condition.value) for condition in pattern.when] == [
        ("self.name", "left"),
        ("cmd['on']", "true"),
    ]


def test_each_entry_has_its_own_reading_and_opposite(tmp_path: Path) -> None:
    text = (
        f'[[operation]]\n{CALL}{MOVE}{SHIFT}current = "robot:Arm.where"\n'
        f'[[operation]]\n{CALL}{GRIP}opposite = "robot:Arm.undo"\n'
        '[[operation]]\ncall = "robot:Arm.undo"\n[[operation]]\ncall = "robot:Arm.where"\n'
        'result = { kind = "position", axis = "x", unit = "m" }\n'
    )
    operation = loaded(tmp_path, text).operation("robot:Arm.send")
    assert operation is not None
    assert [each.current for each in operation.patterns] == ["robot:Arm.where", None]
    assert [each.opposite for each in operation.patterns] == [None, "robot:Arm.undo"]
    assert operation.currents == ("robot:Arm.where",)
    assert operation.opposites == ("robot:Arm.undo",)


def test_a_case_goes_together_with_modes_and_with_text(tmp_path: Path) -> None:
    shift = (
        'arguments.value = { kind = "translation", axis = "x", unit = "m", '
        'mode = { argument = "relative", true = "by", false = "to" } }\n'
    )
    by, to = only(tmp_path, f"[[operation]]\n{CALL}{MOVE}{shift}").patterns
    assert [by.name, to.name] == ["kind=move, relative=true", "kind=move, relative=false"]
    text = 'message = "text"\npatterns = [{ text = "up/{h:g}", kind = "duration", unit = "s" }]\n'
    (up,) = only(tmp_path, f"[[operation]]\n{CALL}{MOVE}{text}").patterns
    assert (up.notation, up.name) == ("up/{h:g}", "up/{h} [kind=move]")


def test_what_is_reported_twice_alike_counts_once(tmp_path: Path) -> None:
    entry = f"[[operation]]\n{CALL}{GRIP}{OPENING}"
    (tmp_path / "more.toml").write_text(entry)
    (tmp_path / "robot.toml").write_text(entry)
    (operation,) = load_vocabulary(["robot.toml", "more.toml"], tmp_path).operations
    assert len(operation.patterns) == 1


def test_a_field_of_a_request_may_decide(tmp_path: Path) -> None:
    text = 'service = "/do"\nwhen = { argument = "what", value = "grip" }\n'
    operation = loaded(tmp_path, f"[[operation]]\n{text}").operation("call /do")
    assert operation is not None
    assert [condition.argument for condition in operation.patterns[0].when] == ["request.what"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (f'{CALL}when = "gripper"', [":3", "expected a table", "'gripper'"]),
        (f'{CALL}when = {{ argumnt = "a", value = 1 }}', [":3", "'argumnt'", "'argument'"]),
        (f"{CALL}when = []", [":3", "must not be empty"]),
        (f'{CALL}when = {{ argument = "a[", value = 1 }}', [":3", "makes no sense"]),
        (f'{CALL}when = {{ argument = "self", value = 1 }}', [":3", "self.name"]),
        (f'{CALL}when = {{ argument = "a[0:2]", value = 1 }}', [":3", "not one value"]),
        (f'{CALL}when = {{ argument = "a", value = [1] }}', [":3", "must be a text", "a list"]),
        ('call = "robot:f"\nwhen = { argument = "self.x", value = 1 }', [":3", "no self"]),
        (
            f'{CALL}when = [{{ argument = "a", value = 1 }}, {{ argument = "a", value = 2 }}]',
            [":3", "a has one value"],
        ),
        (f"{CALL}{GRIP}{OPENING}[[operation]]\n{CALL}{SHIFT}", [":5", "with and without when"]),
        (f"{CALL}{GRIP}{OPENING}[[operation]]\n{CALL}{GRIP}{SHIFT}", [":5", "kind = gripper", "twice"]),
        (f'{CALL}{GRIP}current = "robot:Arm.were"', [":4", "'robot:Arm.were'"]),
        (
            f'{CALL}{GRIP}signature = "(kind)"\n[[operation]]\n{CALL}{MOVE}signature = "(kind, x)"',
            [":5", "signature", "another entry"],
        ),
        (f'{CALL}{GRIP}signature = "(what)"', [":3", "'kind'"]),
    ],
)
def test_a_wrong_case_is_refused_with_place_and_remedy(text: str, words: list[str], tmp_path: Path) -> None:
    message = refused(tmp_path, text)
    assert [word for word in words if word not in message] == [], message
