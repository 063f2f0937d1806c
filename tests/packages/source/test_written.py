"""A mutant of a file that tests read as text is an edit of that file."""

from __future__ import annotations

import ast

import pytest

from mutabot.api.faults import Alternative, TextPlace
from mutabot_source import registry
from mutabot_source.texts import find_places
from mutabot_source.written import TextWriter


def edited(content: bytes, text: str, operator: str, variant: str = "") -> bytes | None:
    """The content with a mutant of the first place of this text."""
    place, alternative = found_in(content, text, operator, variant)
    edit = TextWriter(content).edit(place, alternative)
    return None if edit is None else content[: edit[0]] + edit[2] + content[edit[1] :]


def found_in(content: bytes, text: str, operator: str, variant: str) -> tuple[TextPlace, Alternative]:
    places, _ = find_places(content, "mission.py", registry.select([operator]))
    return next(
        (place, alternative)
        for place in places
        for alternative in place.alternatives
        if place.text == text and alternative.variant == variant
    )


@pytest.mark.parametrize(
    ("content", "text", "operator", "variant", "after"),
    [
        (b"y = x * 2\n", "x * 2", "AOR", "sub", b"y = (x - 2)\n"),
        (b"y = 3 * (a + b)  # both\n", "a + b", "UOI", "neg", b"y = 3 * ((-(a + b)))  # both\n"),
        (b"if x: y = 1; z = 2\n", "y = 1", "BSR", "", None),
        (b"y = (x *\n     2)\nz = 1\n", "x * 2", "AOR", "sub", b"y = ((x - 2\n))\nz = 1\n"),
    ],
)
def test_the_mutant_stands_where_the_place_stood_and_what_follows_keeps_its_line(
    content: bytes, text: str, operator: str, variant: str, after: bytes | None
) -> None:
    made = edited(content, text, operator, variant)
    assert made is not None
    ast.parse(made)
    if after is not None:
        assert made == after


@pytest.mark.parametrize(
    ("head", "encoding", "end"),
    [
        ("# coding: latin-1\n", "latin-1", "\n"),
        ("", "utf-8", "\n"),
        ("\ufeff", "utf-8", "\n"),
        ("t = 1\r\n", "utf-8", "\r\n"),
    ],
    ids=["latin-1", "utf-8", "byte order mark", "carriage returns"],
)
def test_encodings_and_ends_of_lines_stay(head: str, encoding: str, end: str) -> None:
    content, after = (
        f"{head}t = 'ä'; y = {expression}; u = 'ö'{end}z = 2{end}".encode(encoding)
        for expression in ("größe * 2", "(größe - 2)")
    )
    assert edited(content, "größe * 2", "AOR", "sub") == after


@pytest.mark.parametrize(("variant", "result"), [("abs", 2), ("negAbs", -2), ("failOnZero", -2)])
def test_a_text_needs_nothing_of_mutabot(variant: str, result: int) -> None:
    made, space = edited(b"y = x\n", "x", "ABS", variant), {"x": -2}
    assert made is not None
    exec(made, space)
    assert space["y"] == result


def test_a_value_that_must_not_be_zero_raises_if_it_is() -> None:
    made = edited(b"y = x\n", "x", "ABS", "failOnZero")
    assert made is not None
    with pytest.raises(Exception, match="the value is zero") as raised:
        exec(made, {"x": 0})
    assert type(raised.value).__name__ == "ZeroValue"


def test_a_bomb_is_an_exception() -> None:
    made = edited(b"y = 1\n", "y = 1", "BSR")
    assert made is not None
    with pytest.raises(Exception, match="bomb went off") as raised:
        exec(made)
    assert type(raised.value).__name__ == "Bomb"
