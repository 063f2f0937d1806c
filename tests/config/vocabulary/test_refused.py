"""Refusals as data: what ``refused`` becomes."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.model.operation import Refused
from tests.config.vocabulary.test_named import loaded, refused

CALL = 'call = "robot:Arm.move"\n'
STATUS = 'refused = { path = "status", values = [5, 6] }'


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (f"{CALL}{STATUS}", [Refused(".status", (5, 6))]),
        (f'{CALL}refused = {{ path = ".status", values = [5] }}', [Refused(".status", (5,))]),
        (f'{CALL}refused = {{ path = "[0]", values = ["no"] }}', [Refused("[0]", ("no",))]),
        (f"{CALL}refused = {{ values = [false] }}", [Refused("", (False,))]),
        (
            f'{CALL}refused = [{{ values = [3] }}, {{ topic = "/note", path = "code", values = [7] }}]',
            [Refused("", (3,)), Refused(".code", (7,), "/note")],
        ),
        (f'service = "/move"\n{STATUS}', [Refused(".status", (5, 6))]),
        (
            'topic = "/goal"\ndirection = "publish"\n'
            'refused = { topic = "/note", path = "data", values = [7] }',
            [Refused(".data", (7,), "/note")],
        ),
        (
            'action = "/follow"\nrefused = ["ABORTED", "REJECTED"]',
            [Refused("", ("ABORTED", "REJECTED"), "/follow")],
        ),
        (
            'action = "/follow"\nrefused = { path = "error_code", values = [-1] }',
            [Refused(".error_code", (-1,), "/follow")],
        ),
    ],
)
def test_a_refusal_is_a_value_in_an_answer_or_a_message(
    text: str, wanted: list[Refused], tmp_path: Path
) -> None:
    operation = loaded(tmp_path, f"[[operation]]\n{text}").operations[0]
    assert list(operation.refused) == wanted


def test_each_case_of_a_call_has_refusals_of_its_own(tmp_path: Path) -> None:
    text = f'[[operation]]\n{CALL}{STATUS}\nwhen = {{ argument = "kind", value = 1 }}'
    (operation,) = loaded(tmp_path, text).operations
    assert operation.patterns[0].refused == (Refused(".status", (5, 6)),)
    assert operation.all_refused == operation.patterns[0].refused


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (f"{CALL}refused = 5", [":3", "expected a table", "the number 5"]),
        (f"{CALL}refused = []", [":3", "must not be empty"]),
        (f"{CALL}refused = {{ values = [] }}", [":3", "must not be empty"]),
        (f'{CALL}refused = {{ path = "status" }}', [":3", "'values' is missing"]),
        (f'{CALL}refused = {{ path = "sta tus", values = [5] }}', [":3", "makes no sense"]),
        (f"{CALL}refused = {{ values = [[1]] }}", [":3", "a list"]),
        (f'{CALL}refused = {{ vlues = [1], path = "a" }}', [":3", "'vlues'", "'values'"]),
        (f'{CALL}refused = ["ABORTED"]', [":3", "expected a table", "'ABORTED'"]),
        (f'{CALL}refused = {{ topic = "note", values = [1] }}', [":3", "'/note'"]),
        ('action = "/a"\nrefused = ["ABORTD"]', [":3", "'ABORTD'", "'ABORTED'"]),
        ('topic = "/a"\ndirection = "publish"\nrefused = { values = [5] }', [":4", "no answer", "topic ="]),
        ('topic = "/a"\ndirection = "receive"\nrefused = { values = [5] }', [":4", "has no refused"]),
    ],
)
def test_a_wrong_refusal_is_reported_with_place_and_remedy(
    text: str, words: list[str], tmp_path: Path
) -> None:
    message = refused(tmp_path, text)
    assert [word for word in words if word not in message] == [], message
