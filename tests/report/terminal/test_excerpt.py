"""Excerpts of source: the caret stands under the call, whatever the characters are."""

from __future__ import annotations

from mutabot.model import Span
from mutabot.report.terminal.mutant import excerpt


def span(line: int, column: int, end_line: int, end_column: int) -> Span:
    return Span("f.py", line, column, end_line, end_column, "f")


def test_columns_are_utf8_bytes() -> None:
    assert excerpt("é = g(1)", span(1, 5, 1, 9)) == ["1 │ é = g(1)", "  │     ^^^^"]


def test_wide_characters_take_two_cells() -> None:
    assert excerpt('"箱", g()', span(1, 7, 1, 10)) == ['1 │ "箱", g()', "  │       ^^^"]


def test_tabs_are_widened() -> None:
    assert excerpt("\tg()", span(1, 1, 1, 4)) == ["1 │     g()", "  │     ^^^"]


def test_a_call_over_several_lines_is_underlined_on_each() -> None:
    lines = excerpt("x = g(\n    1,\n)\n", span(1, 4, 3, 1))
    assert lines == ["1 │ x = g(", "  │     ^^", "2 │     1,", "  │     ^^", "3 │ )", "  │ ^"]


def test_lines_around_are_shown() -> None:
    source = "\n".join(f"line{number}" for number in range(1, 13))
    lines = excerpt(source, span(9, 0, 9, 4))
    assert lines[0] == " 7 │ line7"
    assert lines[-1] == "11 │ line11"


def test_a_place_that_is_no_longer_there_gives_nothing() -> None:
    assert excerpt("x", span(9, 0, 9, 4)) == []
