"""Moments: which calls are meant."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mutabot.model import Moment
from mutabot.model.mutant import When


@pytest.mark.parametrize("text", ["3", "from 10", "once", "2-2.5 s", "0-1 s"])
def test_a_moment_is_written_as_it_is_read(text: str) -> None:
    assert Moment.parse(text).text == text


@pytest.mark.parametrize("text", ["0", "-1", "from 0", "from", "2.5-2 s", "2-2 s", "sometimes", "", "1-2"])
def test_what_is_no_moment_is_refused_and_the_message_says_what_is(text: str) -> None:
    with pytest.raises(ValueError, match=r"moment|before it begins"):
        Moment.parse(text)


def test_every_call_is_no_moment() -> None:
    assert Moment.parse_any("every") is None


@given(st.integers(1, 500), st.integers(1, 500))
def test_the_number_of_a_call_decides(first: int, call: int) -> None:
    assert Moment.parse(str(first)).holds(call, None) == (call == first)
    assert Moment.parse(f"from {first}").holds(call, None) == (call >= first)


def test_a_window_of_time_needs_a_clock() -> None:
    moment = Moment.parse("2-2.5 s")
    assert moment.holds(1, 2.0)
    assert not moment.holds(1, 2.5)
    assert not moment.holds(1, None)


@given(st.integers(1, 300), st.integers(0, 2**32 - 1))
def test_a_drawn_call_is_one_of_those_that_the_test_makes(calls: int, seed: int) -> None:
    moment = Moment(When.ONCE, calls={"1 tests/test_a.py::test": calls})
    drawn = moment.drawn(1, "tests/test_a.py::test", seed)
    assert sum(drawn.holds(call, None) for call in range(1, calls + 1)) == 1
    assert drawn == moment.drawn(1, "tests/test_a.py::test", seed)


def test_a_test_without_such_calls_has_no_moment() -> None:
    drawn = Moment(When.ONCE, calls={}).drawn(0, "tests/test_a.py::test", 1)
    assert not any(drawn.holds(call, None) for call in range(1, 100))
