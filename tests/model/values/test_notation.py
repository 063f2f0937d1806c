"""Text commands: values out of them, and back in the same notation."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mutabot.model.notation import Notation

numbers = st.integers(-(10**12), 10**12) | st.floats(-1e12, 1e12)
words = st.text("abcXYZ09_", min_size=1, max_size=8)


@given(height=numbers, count=st.integers(-(10**9), 10**9), name=words)
def test_what_is_written_is_read_back(height: float, count: int, name: str) -> None:
    notation = Notation.compile("lift/{height:g}/{count:d}/{name}!")
    values = {"height": height, "count": count, "name": name}
    assert notation.read(notation.write(values)) == values


@given(old=numbers, new=numbers, decimals=st.integers(0, 6), plus=st.booleans(), zeros=st.integers(0, 4))
def test_what_is_written_like_another_command_is_read_back(
    old: float, new: float, decimals: int, plus: bool, zeros: int
) -> None:
    notation = Notation.compile("lift/{height:g};")
    like = f"lift/{old:{'+' if plus else '-'}0{zeros + decimals}.{decimals}f};"
    # the noise of floating point (0.1 + 0.2) is not worth another look
    written = notation.read(notation.write({"height": new}, like=like))
    assert written == {"height": pytest.approx(new, rel=1e-12, abs=1e-12)}


@given(value=numbers, decimals=st.integers(0, 6))
def test_an_unchanged_value_is_written_as_it_was(value: float, decimals: int) -> None:
    notation = Notation.compile("lift/{height:g}")
    message = f"lift/{value:+012.{decimals}f}"
    values = notation.read(message)
    assert values is not None
    assert notation.write(values, like=message) == message


@given(value=st.floats(-1e6, 1e6), decimals=st.integers(0, 4))
def test_the_reverse_of_a_command_has_as_many_decimals(value: float, decimals: int) -> None:
    notation = Notation.compile("go {x:g}")
    digits = f"{abs(value):.{decimals}f}"
    values = notation.read(f"go {digits}")
    assert values is not None
    if values["x"] != 0:
        assert notation.write({"x": -values["x"]}, like=f"go {digits}") == f"go -{digits}"


@pytest.mark.parametrize(
    ("text", "like", "value", "expected"),
    [
        ("lift/{h:g}", "lift/5.00", -5, "lift/-5.00"),
        ("lift/{h:g}", "lift/5.00", 2.5, "lift/2.50"),
        ("lift/{h:g}", "lift/5.00", 2.125, "lift/2.125"),
        ("lift/{h:g}", "lift/-5.0", 5, "lift/5.0"),
        ("lift/{h:g}", "lift/+5", 7, "lift/+7"),
        ("lift/{h:g}", "lift/+5", -5, "lift/-5"),
        ("lift/{h:g}", "lift/-5", 5, "lift/5"),
        ("lift/{h:g}", "lift/005", 7, "lift/007"),
        ("lift/{h:g}", "lift/005", -5, "lift/-005"),
        ("lift/{h:g}", "lift/005", 0.5, "lift/0.5"),
        ("lift/{h:g}", "lift/5.", -5, "lift/-5."),
        ("lift/{h:g}", "lift/5", 1234.5678, "lift/1234.5678"),
        ("lift/{h:g}", None, -5.0, "lift/-5"),
        ("lift/{h:d}", "lift/5", -5, "lift/-5"),
        ("lift/{h:.2f}", None, 5, "lift/5.00"),
        ("grip {h}", "grip open", "closed", "grip closed"),
    ],
)
def test_a_changed_command_keeps_its_look(text: str, like: str | None, value: Any, expected: str) -> None:
    assert Notation.compile(text).write({"h": value}, like=like) == expected


@pytest.mark.parametrize(
    "message",
    ["drop/5", "lift/", "lift/five", "lift/5 ", " lift/5", "lift/5/6", "Lift/5", "lift/5\n", "lift/١"],
)
def test_another_command_is_not_read(message: str) -> None:
    assert Notation.compile("lift/{height:g}").read(message) is None


def test_a_whole_number_is_not_read_from_a_fraction() -> None:
    assert Notation.compile("go {n:d}").read("go 1.5") is None


def test_literal_braces_and_signs_of_regular_expressions_stand_for_themselves() -> None:
    notation = Notation.compile("{{a.b}}*{x:g}")
    assert notation.read("{a.b}*3") == {"x": 3}
    assert notation.write({"x": 4}) == "{a.b}*4"
    assert notation.read("{aXb}*3") is None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "empty"),
        ("go/{x", "expected '}'"),
        ("go/{}", "plain name"),
        ("go/{0}", "plain name"),
        ("go/{a.b}", "plain name"),
        ("go/{x}/{x}", "two fields named 'x'"),
        ("go/{x!r}", "conversion"),
        ("go/{x:yd}", "is not a format"),
        ("go/{x:,.2f}", "cannot be read back"),
        ("go/{x:8.2f}", "cannot be read back"),
    ],
)
def test_a_text_that_is_no_notation_is_refused(text: str, words: str) -> None:
    with pytest.raises(ValueError, match=r"notation|expected") as caught:
        Notation.compile(text)
    assert words in str(caught.value)


def test_the_short_form_has_no_format_specifications() -> None:
    assert Notation.compile("lift/{height:.2f}/{name}").short == "lift/{height}/{name}"
