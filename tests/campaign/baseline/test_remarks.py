"""What is to be said of several operations is said in one line."""

from __future__ import annotations

import pytest

from mutabot.campaign.baseline.remarks import lines_of
from mutabot.model.events import Remark


def _of(name: str, text: str, *, line: int = 3, key: str = "call") -> Remark:
    return Remark(f"robot.toml:{line} · robot:Arm.{name}", key, text)


def test_operations_that_a_mock_replaces_share_a_line() -> None:
    remarks = [
        _of("move", "it is replaced by a mock in 2 tests"),
        _of("turn", "it is replaced by a mock in 1 test", line=9),
    ]
    assert lines_of(remarks) == [
        "robot.toml:3 · robot:Arm.move · call: it is replaced by a mock in 2 tests; likewise robot:Arm.turn"
    ]


@pytest.mark.parametrize(
    "other",
    [
        _of("turn", "it is replaced by robot:Fake in 2 tests"),
        _of("turn", "it is replaced by a mock in 2 tests", key="method"),
        Remark("pyproject.toml:4", "call", "it is replaced by a mock in 2 tests"),
    ],
)
def test_what_is_not_the_same_has_a_line_of_its_own(other: Remark) -> None:
    first = _of("move", "it is replaced by a mock in 2 tests")
    assert lines_of([first, other]) == [str(first), str(other)]
