"""When probes are read along the way: by the number of commands alone, often at first, then more seldom."""

from __future__ import annotations

import random
import threading
import time
from collections.abc import Callable
from functools import partial
from itertools import count
from typing import Any

import pytest

from mutabot.runtime.observation.probes import FIRST, Along, Reading, first_reading


def read_after(commands: int, stride: int) -> list[int]:
    along = Along(lambda: Reading({"x": 1.0}))
    along.start(stride)
    for call in range(1, commands + 1):
        along.after(call)
    return [call for call, _, _ in along.entries]


def test_readings_thin_out_by_the_number_of_commands() -> None:
    few, many = read_after(FIRST, 1), read_after(5000, 1)
    assert few == list(range(1, FIRST + 1))
    assert many[: len(few)] == few
    assert 200 < len(many) < 500
    assert many == read_after(5000, 1)
    assert read_after(5, 0) == []
    assert read_after(9, 4) == [4, 8]


def test_a_reading_holds_what_has_changed_since_the_one_before() -> None:
    values: list[dict[str, Any]] = [{"x": 1, "y": 2}, {"x": 1, "y": 3}, {"x": 1}, {"x": 1}]
    waiting = iter(values)
    along = Along(lambda: Reading(next(waiting)))
    along.start(1)
    for call in range(1, 5):
        along.after(call)
    assert along.entries == [(1, values[0], True), (2, {"y": 3}, False), (3, {"x": 1}, True), (4, {}, False)]


def test_commands_of_other_threads_are_counted_but_not_read() -> None:
    along = Along(lambda: Reading({"x": 1.0}))
    along.start(1)
    thread = threading.Thread(target=along.after, args=(1,))
    thread.start()
    thread.join()
    along.after(2)
    assert [call for call, _, _ in along.entries] == [2]


def test_a_reading_that_changes_nothing_can_be_repeated() -> None:
    found = first_reading(lambda: Reading({"x": float("nan")}))
    assert found.values.keys() == {"x"}
    assert found.not_along is None
    assert found.seconds is not None
    assert 0 <= found.seconds < 1


@pytest.mark.parametrize("slow", range(2))
@pytest.mark.parametrize("clock", [time.thread_time, time.perf_counter], ids=["at work", "waiting"])
def test_one_reading_that_happens_to_take_long_does_not_count(slow: int, clock: Callable[[], float]) -> None:
    number = count()

    def read() -> Reading:
        if next(number) == slow:
            until = clock() + 0.5
            while clock() < until:
                pass
        return Reading({"x": 1.0})

    found = first_reading(read)
    assert found.not_along is None
    assert found.seconds is not None
    assert found.seconds < 0.25


def test_readings_that_always_take_long_are_not_repeated() -> None:
    def read() -> Reading:
        time.sleep(0.06)
        return Reading({"x": 1.0})

    found = first_reading(read)
    assert found.seconds is None
    assert found.not_along is not None
    assert found.not_along.startswith("reading them takes")


@pytest.mark.parametrize(
    ("read", "why"),
    [
        (lambda: Reading({"x": random.random()}), "reading them draws random numbers"),
        (partial(lambda counter: Reading({"x": next(counter)}), count()), "x changes when it is read twice"),
        (lambda: Reading({}, {"x": "cannot"}), None),
    ],
)
def test_a_reading_that_changes_something_cannot(read: Any, why: str | None) -> None:
    found = first_reading(read)
    assert (found.seconds, found.not_along) == (None, why)
