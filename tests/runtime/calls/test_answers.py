"""Notes of what commands answer, and which answers may be copied."""

from __future__ import annotations

from typing import Any

import pytest

from mutabot.model import Call, Operation, Reply, Vocabulary
from mutabot.runtime.interception.adapter import Invocation, handles_of, snapshot
from mutabot.runtime.interception.trace import Answers


class Gripper:
    """Part of the robot API, since the vocabulary names one of its methods."""

    def close(self) -> None:
        pass


class Firm(Gripper):
    """So is what derives from it."""


class Broken:
    """Does not like to be looked at."""

    @property
    def __dict__(self) -> Any:  # type: ignore[override]
        raise ZeroDivisionError("looked at")


VOCABULARY = Vocabulary((Operation(f"{__name__}:Gripper.close"), Operation(f"{__name__}:move")))


CALL = Call(Operation("robot:move"), payload=Invocation(print, None, (), {}))


def notes(*values: Any) -> list[Any]:
    answers = Answers(handles_of(VOCABULARY))
    return [answers.note(0, CALL, Reply(payload=value)) for value in values]


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ((None, 1, "a"), [None, 1, "a"]),
        (([1], [1], [2], [1]), [{"kept": {"list": [1]}}, {"same": True}, {"other": True}, {"other": True}]),
        ((None, [1]), [None, {"other": True}]),
        (([1], None), [{"kept": {"list": [1]}}, None]),
        ((Gripper(), Gripper()), [{"opaque": f"{__name__}:Gripper"}, {"other": True}]),
        (([Firm()],), [{"opaque": f"{__name__}:Firm"}]),
    ],
)
def test_the_first_answer_is_kept_and_later_ones_are_compared_with_it(
    values: tuple[Any, ...], expected: list[Any]
) -> None:
    assert notes(*values) == expected


def test_each_site_and_each_test_has_a_first_answer() -> None:
    answers = Answers()
    assert [answers.note(site, CALL, Reply(payload=[site])) for site in (0, 1)] == [
        {"kept": {"list": [0]}},
        {"kept": {"list": [1]}},
    ]
    answers.start()
    assert answers.note(0, CALL, Reply(payload=[5])) == {"kept": {"list": [5]}}
    assert answers.note(0, CALL, None) == {"raised": True}


def test_an_object_that_fails_when_it_is_looked_at_is_named() -> None:
    assert notes(Broken()) == [{"opaque": "Broken, which raises ZeroDivisionError('looked at')"}]


def test_a_snapshot_does_not_change_with_what_the_program_does() -> None:
    pose, path = [1.0], [2.0]
    kept = snapshot((pose, path, "done"))
    pose.append(9.0)
    path.clear()
    assert kept == ([1.0], [2.0], "done")
