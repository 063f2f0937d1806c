"""The operators' own examples, run as tests."""

from __future__ import annotations

import re
from collections.abc import Mapping
from random import Random
from typing import Any

import pytest

from mutabot.families import CATALOGUE
from mutabot.model import Call, Reply
from mutabot.model.quantity import changes
from mutabot.operators import Example, Subject, names, operator
from mutabot.operators.command import CONTROLS
from mutabot.operators.examples import CLOSE
from mutabot.operators.kinds.commands import Opposite
from mutabot.operators.middleware import CallRecord, rehearse

CASES = [(name, index) for name in [*names(), *CONTROLS] for index in range(len(operator(name).examples))]
SEED = 1


class Refused(Exception):  # noqa: N818  # what the robot says
    """The robot refuses a command."""


def example_of(name: str, index: int) -> Example:
    return operator(name).examples[index]


def play(name: str, example: Example) -> CallRecord:
    """The passage of the example's call, after those that went before it."""
    subject = example.subject
    middleware = operator(name).middleware(subject, Random(SEED))

    async def waited(seconds: float) -> None:
        """There is no time to pass here."""

    def go(values: Mapping[str, Any], replied: Mapping[str, Any]) -> CallRecord:
        call = Call(
            subject.operation, subject.pattern, values, idle=Reply(), payload=object(), wait=waited,
            time=lambda: example.time,
            previous=lambda: example.previous, is_refusal=lambda error: isinstance(error, Refused),
        )  # fmt: skip
        return rehearse(
            middleware, call, replied, current=example.current, payload=object(), operator=name,
            refusal=Refused() if example.refused else None,
        )  # fmt: skip

    for earlier in example.earlier:
        sides = ({quantity.name for quantity in side} for side in (subject.written, subject.read))
        go(*({name: earlier[name] for name in side if name in earlier} for side in sides))
    return go(example.values, example.replied)


def shown(call: Call) -> dict[str, Any]:
    """A performed call, as examples write it."""
    reversed_ = {"reversed": True} if call.reversed else {}
    return {**call.values, **reversed_, **{str(name): much for name, much in call.call_faults.items()}}


@pytest.mark.parametrize(("name", "index"), CASES)
def test_the_example_does_what_it_says(name: str, index: int) -> None:
    example = example_of(name, index)
    if example.raises is not None:
        with pytest.raises(example.raises):
            play(name, example)
        return
    passage = play(name, example)
    if example.away:
        assert not passage.acted, example.away
        assert len(passage.performed) == 1
        assert passage.away or example.subject.quantity is None
        return
    assert passage.acted
    for calls, told in ((passage.performed, example.performed), (passage.deferred, example.afterwards)):
        for got, expected in zip(map(shown, calls), told, strict=True):
            assert got.keys() == expected.keys()
            assert all(got[key] == pytest.approx(expected[key]) for key in got)
    assert passage.waited == example.waited
    if example.received is not None:
        assert passage.received is not None
        assert changes((), example.received, passage.received.values) == {}
        assert passage.received.values.keys() == example.received.keys()
    if passage.received is not None:
        assert (passage.received.lost, passage.received.late) == (example.lost, example.late)
        assert passage.received.error == example.fails
        assert [part.values for part in passage.received.more] == list(example.then)


def test_every_operator_shows_where_it_acts() -> None:
    acting = {name for name in names() if any(not example.away for example in operator(name).examples)}
    assert {name for name in names() if name not in acting or not operator(name).summary} == set()


def test_operators_on_values_show_where_they_stay_away() -> None:
    on_values = {
        name for name in names() if any(example.subject.quantity for example in operator(name).examples)
    }
    assert {
        name for name in on_values if not any(example.away for example in operator(name).examples)
    } == set()


@pytest.mark.parametrize("name", [name for name in names() if operator(name).family == CATALOGUE])
def test_operators_of_the_catalogue_say_what_they_stand_for_and_where_they_apply(name: str) -> None:
    rule = operator(name)
    assert re.search(r"\b(28|20|14|13|9|4|2) of the bugs", rule.rationale), "no evidence"
    assert rule.rationale.endswith(".")
    assert rule.where


@pytest.mark.needs("catalogue")
def test_the_catalogue_is_one() -> None:
    assert sum(operator(name).family == CATALOGUE for name in names()) >= 30


def test_operators_keep_what_they_promise_about_doing_nothing() -> None:
    idle = [(name, index) for name, index in CASES if operator(name).does_nothing]
    assert idle
    assert [case for case in idle if example_of(*case).away or example_of(*case).performed] == []


def test_who_never_makes_the_call_promises_it() -> None:
    silent = {
        name
        for name in names()
        if all(
            not example.away and not example.performed and not example.afterwards
            for example in operator(name).examples
        )
    }
    assert {name for name in names() if operator(name).does_nothing} == silent


def test_the_example_is_a_place_where_the_operator_acts() -> None:
    def is_one(name: str, index: int) -> bool:
        example = example_of(name, index)
        whole = Subject(example.subject.operation, example.subject.pattern)
        subjects = operator(name).subjects(whole)
        return example.subject in list(subjects) or bool(example.away)

    assert [case for case in CASES if case[0] not in CONTROLS and not is_one(*case)] == []


def test_the_original_values_are_left_alone() -> None:
    for name, index in CASES:
        example = example_of(name, index)
        if name in CONTROLS or example.raises is not None:
            continue
        before = repr(example.values), repr(example.replied)
        play(name, example)
        assert (repr(example.values), repr(example.replied)) == before, f"{name}, example {index}"


def test_an_opposite_command_is_named_without_its_module() -> None:
    assert Opposite().describe(Subject(CLOSE), None, None) == "Gripper.open instead"
