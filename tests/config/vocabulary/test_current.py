"""Where the robot is now, by name: what ``current`` becomes, and what it must fit."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.vocabulary.test_named import GOAL, X, loaded, refused

POSE = (
    '[[operation]]\ntopic = "/arm/pose"\ndirection = "receive"\n'
    'fields.position.x = { kind = "position", axis = "x", unit = "mm" }\n'
)
HIDDEN = '{ kind = "translation", axis = "x", unit = "m", mode = "to", relative = true }'


@pytest.mark.parametrize(
    ("current", "reading"),
    [
        ("receive /arm/pose", POSE),
        ("publish /arm/goal", ""),
        (
            "call /where",
            '[[operation]]\nservice = "/where"\nresponse.x = { kind = "position", axis = "x", unit = "m" }\n',
        ),
        (
            "parameter x",
            '[[operation]]\nparameter = "x"\nvalue = { kind = "position", axis = "x", unit = "m" }\n',
        ),
        (
            "transform base → tool",
            '[[operation]]\ntf = "base -> tool"\n'
            'fields.transform.translation.x = { kind = "position", axis = "x", unit = "m" }\n',
        ),
        (
            "feedback /follow",
            '[[operation]]\naction = "/follow"\nfeedback.x = { kind = "position", axis = "x", unit = "m" }\n',
        ),
    ],
)
def test_the_current_value_is_what_came_last_under_a_name(current: str, reading: str, tmp_path: Path) -> None:
    text = f"[[operation]]\n{GOAL}fields.x = {HIDDEN}\ncurrent = '{current}'\n{reading}"
    operation = loaded(tmp_path, text).operation("publish /arm/goal")
    assert operation is not None
    assert operation.current == current
    assert operation.arguments[0].relative


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (f'{GOAL}fields.x = {X}\ncurrent = "receive /arm/pos"\n{POSE}', [":5", "'receive /arm/pose'"]),
        (f'{GOAL}fields.x = {X}\ncurrent = {{ topic = "/arm/pose" }}', [":5", "expected text", "a table"]),
        (f"{GOAL}fields.x = {X}\ncurrent = 3", [":5", "number 3"]),
        (f"{GOAL}fields.x = {HIDDEN}", [":1", "relative = true needs current"]),
        (
            f'{GOAL}fields.x = {{ kind = "translation", unit = "m", mode = "by", relative = true }}',
            [":4", "relative", 'mode = "to"'],
        ),
        (
            f'{GOAL}fields.x = {{ kind = "translation", axis = "y", unit = "m", mode = "to" }}\n'
            f'current = "receive /arm/pose"\n{POSE}',
            [":5", "reads position x", "position y"],
        ),
    ],
)
def test_a_wrong_current_is_refused_with_place_and_remedy(
    text: str, words: list[str], tmp_path: Path
) -> None:
    message = refused(tmp_path, text)
    assert [word for word in words if word not in message] == [], message
