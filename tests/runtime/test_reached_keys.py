"""Keys are told when they are reached: in time, by number, and in a fork from where it begins."""

from __future__ import annotations

import json

import pytest

from mutabot.model import Span
from mutabot.model.activation import FATAL_CONTROL, Activation, Key
from mutabot.model.codec import from_data, to_data
from mutabot.runtime.reached_keys import ReachedKeys

MOVE = Activation.at_call(Span("a.py", 1, 0, 1, 9, "run"), "robot:Arm.move", None)


class Told:
    """What is told of keys."""

    def __init__(self, *keys: Key) -> None:
        self.keys: list[Key] = []
        self.first_ticks = 0
        self.reached = ReachedKeys(self._reach, self._tick)
        self.reached.watch(keys)
        self.reached.start_test()

    def _reach(self, keys: list[Key], number: int | None) -> None:
        self.keys += keys

    def _tick(self) -> None:
        self.first_ticks += 1


def test_a_time_is_reached_once_in_each_test_at_the_first_tick_that_is_no_earlier() -> None:
    told = Told(Activation.at_time(1.0), Activation.at_time(2.0))
    for seconds in (0.0, 0.9, 1.1, 1.2):
        told.reached.tick(seconds)
    assert told.keys == [Activation.at_time(1.0)]
    told.reached.tick(5.0)
    assert told.keys == [Activation.at_time(1.0), Activation.at_time(2.0)]
    told.reached.start_test()
    told.reached.tick(1.0)
    assert told.keys[2:] == [Activation.at_time(1.0)]
    assert told.first_ticks == 2


def test_of_a_key_with_a_number_the_others_are_counted() -> None:
    told = Told(Activation.nth(2, MOVE))
    for _ in range(3):
        told.reached.call(MOVE, 1)
    assert [key for key in told.keys if key != MOVE] == [
        Activation.nth(1, MOVE),
        Activation.nth(2, MOVE),
        Activation.nth(3, MOVE),
    ]
    told.keys.clear()
    told.reached.start_test()
    told.reached.call(MOVE, 1)
    assert told.keys == [MOVE, Activation.nth(1, MOVE)]


def test_a_time_with_a_number_is_that_time() -> None:
    told = Told(Activation.nth(1, Activation.at_time(0.5)))
    told.reached.tick(0.5)
    assert told.keys == [Activation.at_time(0.5), Activation.nth(1, Activation.at_time(0.5))]


def test_what_a_fork_has_passed_as_the_original_is_not_reached_again() -> None:
    told = Told(Activation.at_time(1.0), Activation.at_time(2.0), Activation.at_time(3.0))
    told.reached.tick(2.0)
    told.reached.watch([Activation.at_time(2.0), Activation.at_time(3.0)])  # it was forked at 2 s
    told.reached.tick(2.5)
    assert told.keys == [Activation.at_time(1.0), Activation.at_time(2.0)]
    told.reached.tick(3.0)
    assert told.keys[-1] == Activation.at_time(3.0)


@pytest.mark.parametrize(
    ("keys", "asks"), [((MOVE,), True), ((Activation.nth(3, MOVE),), True), ((Activation.EACH_TEST,), False)]
)
def test_calls_are_only_reported_if_somebody_awaits_one(keys: tuple[Key, ...], asks: bool) -> None:
    assert Told(*keys).reached.asks_calls is asks


def test_a_control_is_where_its_fault_is() -> None:
    fault = Activation("package:Fault", {"size": 1}, (Activation.at_time(3.0),), "mujoco")
    assert fault.control(is_fatal=True) == Activation(
        FATAL_CONTROL, {"size": 1}, (Activation.at_time(3.0),), "mujoco"
    )
    text = Activation.of_text(7, 2)
    assert [text.control(is_fatal=is_fatal).data for is_fatal in (False, True)] == [(7, -1), (7, -2)]


def test_keys_are_the_same_on_another_machine() -> None:
    keys = (
        MOVE,
        Activation.at_time(1.0),
        Activation.nth(2, MOVE),
        Activation.nth(1, Activation.at_time(0.5)),
        Activation.EACH_TEST,
        *Activation.of_text(7, 2).keys,
    )
    fault = Activation("package:Fault", {"size": 1}, keys)
    sent = json.loads(json.dumps(to_data(fault)))
    assert {*from_data(Activation, sent).keys} == {*keys}
