"""Lengths of time as users write them."""

from __future__ import annotations

import pytest

from mutabot.config.options import duration_text, parse_duration
from mutabot.errors import UsageError


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("90s", 90),
        ("10m", 600),
        ("1h", 3600),
        ("1h30m", 5400),
        ("1 h 30 min", 5400),
        ("1.5m", 90),
        ("2M", 120),
    ],
)
def test_a_length_of_time_is_read(text: str, seconds: float) -> None:
    assert parse_duration(text) == seconds


@pytest.mark.parametrize("text", ["", "10", "m", "ten minutes", "10m!", "-5m", "0s", "10mm", "1d"])
def test_anything_else_is_an_error_that_says_what_is_right(text: str) -> None:
    with pytest.raises(UsageError, match="10m"):
        parse_duration(text)


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(600, "10 min"), (90, "90 s"), (5400, "1 h 30 min"), (3601, "1 h 1 s"), (150, "2 min 30 s")],
)
def test_a_length_of_time_is_said_again(seconds: float, text: str) -> None:
    assert duration_text(seconds) == text
    assert parse_duration(text) == seconds
