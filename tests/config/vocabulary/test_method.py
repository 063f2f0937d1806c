"""``method = "move_by"``: an operation of whatever object has the method."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.config.vocabulary import load_vocabulary
from mutabot.errors import VocabularyError

GOOD = """
[[operation]]
method = "move_by"
current = "position"
signature = "(dx, speed=0.1)"
arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }

[[operation]]
method = "open"
opposite = "close"

[[operation]]
method = "close"
opposite = "open"

[[operation]]
method = "position"
command = false
result = { kind = "position", axis = "x", unit = "m" }
"""


def test_a_method_is_an_operation_of_a_kind_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "robot.toml").write_text(GOOD, encoding="utf-8")
    operations = load_vocabulary(["robot.toml"], tmp_path).operations
    assert {operation.kind for operation in operations} == {"methods"}
    by_name = {operation.name: operation for operation in operations}
    assert by_name["*.move_by"].current == "*:*.position"
    assert by_name["*.open"].opposite == by_name["*.close"].target == "*:*.close"
    assert by_name["*.open"].source.startswith("robot.toml:8")


@pytest.mark.parametrize(
    ("lines", "text"),
    [
        ('method = "move_by"\ncall = "robot:move_by"', "known by one thing: either call or method"),
        ('method = "robot:move_by"', "is not the name of a method"),
        ("method = 3", "expected text, got the number 3"),
        ('method = "stop"\noverrides = true', "a method has no overrides; it has"),
        ('method = "stop"\nopposite = "start"', "unknown operation"),
        (
            'method = "go"\narguments.x = { kind = "translation", axis = "x", unit = "m", mode = "to" }',
            'write signature = "(x, …)"',
        ),
    ],
)
def test_what_is_wrong_is_reported(tmp_path: Path, lines: str, text: str) -> None:
    (tmp_path / "robot.toml").write_text(f"[[operation]]\n{lines}\n", encoding="utf-8")
    with pytest.raises(VocabularyError, match=text.replace("(", r"\(").replace(")", r"\)")):
        load_vocabulary(["robot.toml"], tmp_path)
