"""Stamps of both ROS as seconds, and back."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from mutabot.model import Kind, Path, Quantity
from mutabot.model.quantity import seconds_of, with_seconds

STAMPS = [SimpleNamespace(sec=12, nanosec=250_000_000), SimpleNamespace(secs=12, nsecs=250_000_000)]
STAMP = Quantity("stamp", Path.parse(".header.stamp", rooted=False), Kind.STAMP, unit="s")


@pytest.mark.parametrize("stamp", STAMPS, ids=["ROS 2", "ROS 1"])
def test_a_stamp_is_seconds_and_stays_what_it_is(stamp: Any) -> None:
    assert seconds_of(stamp) == 12.25
    assert with_seconds(stamp, 12.25) == stamp
    assert seconds_of(with_seconds(stamp, 2.5)) == 2.5
    assert seconds_of(stamp) == 12.25


@pytest.mark.parametrize("stamp", STAMPS, ids=["ROS 2", "ROS 1"])
def test_no_stamp_is_before_zero(stamp: Any) -> None:
    assert seconds_of(with_seconds(stamp, -3.0)) == 0.0


def test_a_number_is_a_stamp_and_a_text_is_none() -> None:
    assert seconds_of(3) == 3.0
    assert with_seconds(3, 4.5) == 4.5
    assert seconds_of("now") is None


def test_the_message_of_the_program_is_never_changed() -> None:
    message = SimpleNamespace(header=SimpleNamespace(stamp=STAMPS[0]))
    changed = STAMP.put(message, STAMP.get(message) - 10.0)
    assert STAMP.get(changed) == 2.25
    assert STAMP.get(message) == 12.25
