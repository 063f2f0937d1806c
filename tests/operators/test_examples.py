"""The operators' own examples, run as tests."""

from __future__ import annotations

from random import Random

import pytest

from mutabot.model import Call, Reply
from mutabot.model.values.quantity import same_values
from mutabot.operators import Example, names, operator
from mutabot.operators.control import CONTROLS
from mutabot.operators.passage import Passage, rehearse

CASES = [(name, index) for name in [*names(), *CONTROLS] for index in range(len(operator(name).examples))]
SEED = 1


def example_of(name: str, index: int) -> Example:
    return operator(name).examples[index]


def play(name: str, example: Example) -> Passage:
    subject = example.subject
    call = Call(subject.operation, subject.pattern, example.values, idle=Reply())
    middleware = operator(name).middleware(subject, Random(SEED))
    return rehearse(middleware, call, example.replied, current=example.current, operator=name)


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
    shown = [{**call.values, **({"reversed": True} if call.reversed else {})} for call in passage.performed]
    assert len(shown) == len(example.performed)
    for got, expected in zip(shown, example.performed, strict=True):
        assert got.keys() == expected.keys()
        assert all(got[key] == pytest.approx(expected[key]) for key in got)
    if example.received is not None:
        assert passage.received is not None
        assert same_values(passage.received.values, example.received)


@pytest.mark.parametrize("name", names())
def test_every_operator_shows_where_it_acts(name: str) -> None:
    examples = operator(name).examples
    assert any(not example.away for example in examples)
    assert operator(name).summary


@pytest.mark.parametrize("name", names())
def test_operators_on_values_show_where_they_stay_away(name: str) -> None:
    examples = operator(name).examples
    is_on_values = any(example.subject.quantity is not None for example in examples)
    assert any(example.away for example in examples) == is_on_values


@pytest.mark.parametrize(("name", "index"), CASES)
def test_operators_keep_what_they_promise_about_doing_nothing(name: str, index: int) -> None:
    example = example_of(name, index)
    assert operator(name).does_nothing == (not example.away and not example.performed)


@pytest.mark.parametrize(("name", "index"), [case for case in CASES if case[0] not in CONTROLS])
def test_the_example_is_a_place_where_the_operator_acts(name: str, index: int) -> None:
    example = example_of(name, index)
    subjects = list(operator(name).subjects(example.subject.operation, example.subject.pattern))
    assert (example.subject in subjects) or example.away


@pytest.mark.parametrize(("name", "index"), [case for case in CASES if case[0] not in CONTROLS])
def test_the_original_values_are_left_alone(name: str, index: int) -> None:
    example = example_of(name, index)
    values, replied = repr(example.values), repr(example.replied)
    play(name, example)
    assert (repr(example.values), repr(example.replied)) == (values, replied)
