"""How answers and messages say that a command is refused."""

from __future__ import annotations

from enum import Enum
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mutabot.model import Call, Operation, Pattern, Role, Site, Span
from mutabot.model.job import RefusedAt
from mutabot.model.operation import Form, Named, Refused
from mutabot.runtime.interception.active_mutant import RefusedCalls, answered, heard, possible_refusals
from mutabot.runtime.interception.adapter import SiteCall

STATUS = Refused(".status", (5, 6))


class State(Enum):
    FINE = 0
    STUCK = 5


def call(*refused: Refused, named: Named | None = None) -> Call:
    return Call(Operation("robot:Arm.move", refused=refused, named=named))


@pytest.mark.parametrize(
    ("refused", "result", "words"),
    [
        (STATUS, SimpleNamespace(status=5), "answered status 5"),
        (STATUS, SimpleNamespace(status=np.uint8(6)), "answered status 6"),
        (STATUS, SimpleNamespace(status=State.STUCK), "answered status 5"),
        (Refused(".status", ("STUCK",)), SimpleNamespace(status=State.STUCK), "answered status 5"),
        (Refused(".status", ("FINE",)), SimpleNamespace(status=State.STUCK), None),
        (STATUS, SimpleNamespace(status=4), None),
        (STATUS, SimpleNamespace(), None),
        (STATUS, None, None),
        (Refused("", (False,)), False, "answered False"),
        (Refused("", (False,)), np.False_, "answered False"),
        (Refused("", (False,)), 0, None),
        (Refused("", (0,)), False, None),
        (Refused("['error']", ("no way",)), {"error": "no way"}, "answered ['error'] no way"),
        (Refused("", (5,)), np.zeros(3), None),
    ],
)
def test_an_answer_is_a_refusal_by_its_value(refused: Refused, result: Any, words: str | None) -> None:
    assert answered(call(refused), result) == words


def test_a_message_that_follows_is_one_under_its_name_alone() -> None:
    told = (Refused(".code", (7,), "/arm/*"), STATUS)
    assert heard(told, "/arm/note", SimpleNamespace(code=7)) == "/arm/note: code 7"
    assert heard(told, "/arm/note", SimpleNamespace(code=8)) is None
    assert heard(told, "/note", SimpleNamespace(code=7)) is None
    assert heard(told, "/arm/note", SimpleNamespace(status=5)) is None


def test_the_goal_of_an_action_is_refused_by_its_end() -> None:
    told = Refused("", ("ABORTED", "REJECTED"), "/follow")
    goal = call(told, named=Named(Form.GOAL, "/follow"))
    assert answered(goal, SimpleNamespace(accepted=False)) == "/follow: REJECTED"
    assert answered(goal, SimpleNamespace(accepted=True)) is None
    assert heard(possible_refusals(goal), "/follow", "ABORTED") == "/follow: ABORTED"
    assert heard(possible_refusals(goal), "/follow", "SUCCEEDED") is None


def test_what_an_entry_says_of_some_calls_goes_before_the_operation() -> None:
    own = Pattern("kind=1", refused=(STATUS,))
    operation = Operation("a:b", patterns=(own,), refused=(Refused("", (1,)),))
    assert possible_refusals(Call(operation, own)) == (STATUS,)
    assert possible_refusals(Call(operation)) == operation.refused


SITE = (Span("mission.py", 3, 4, 3, 20, "run"), Role.PROGRAM)
TOPIC = Refused(".code", (7,), "/arm/note")
SILENT, TOLD = SimpleNamespace(code=0), SimpleNamespace(code=7)


def test_calls_of_the_original_that_are_refused_by_a_message_are_noted_by_their_number() -> None:
    noted: list[int] = []
    refused = RefusedCalls(lambda made: noted.append(made.number))
    first, second, third = (SiteCall(SITE, call(TOPIC), number) for number in (1, 2, 3))
    refused.begins(first)
    refused.heard("/arm/note", SILENT)
    refused.begins(second)
    refused.heard("/arm/note", TOLD)  # of the second: the first one is over
    refused.heard("/arm/note", TOLD)
    refused.begins(third)
    refused.returned(third, None)
    refused.start(())
    refused.heard("/arm/note", TOLD)  # in another test
    assert noted == [2]


def test_a_call_of_the_original_that_answers_so_is_noted() -> None:
    noted: list[int] = []
    refused = RefusedCalls(lambda made: noted.append(made.number))
    for number, status in ((1, 0), (2, 5)):
        made = SiteCall(SITE, call(STATUS), number)
        refused.begins(made)
        refused.returned(made, SimpleNamespace(status=status))
    assert noted == [2]


def test_what_is_known_of_a_test_holds_for_its_calls_alone() -> None:
    refused = RefusedCalls()
    refused.start([RefusedAt(Site(SITE[0], "arm.move", 1, Role.PROGRAM), "robot:Arm.move", None, (2, 4))])
    assert [number for number in range(1, 6) if refused.has(SiteCall(SITE, call(), number))] == [2, 4]
    elsewhere = (Span("mission.py", 4, 4, 4, 20, "run"), Role.PROGRAM)
    assert not refused.has(SiteCall(elsewhere, call(), 2))
    refused.start(())
    assert not refused.has(SiteCall(SITE, call(), 2))
