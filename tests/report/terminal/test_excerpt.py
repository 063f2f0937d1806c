"""Excerpts of source: a sign stands before the lines of the call."""

from __future__ import annotations

from mutabot.model import Span
from mutabot.report.texts import excerpt


def span(line: int, end_line: int) -> Span:
    return Span("f.py", line, 0, end_line, 1, "f")


def test_tabs_are_widened() -> None:
    assert excerpt("\tg()", span(1, 1)) == ["> 1 │     g()"]


def test_a_call_over_several_lines_is_marked_on_each() -> None:
    lines = excerpt("x = g(\n    1,\n)\n\ny\n", span(1, 3))
    assert lines == ["> 1 │ x = g(", "> 2 │     1,", "> 3 │ )", "  4 │", "  5 │ y"]


def test_lines_around_are_shown() -> None:
    source = "\n".join(f"line{number}" for number in range(1, 13))
    lines = excerpt(source, span(9, 9))
    assert lines[0] == "   7 │ line7"
    assert lines[2] == ">  9 │ line9"
    assert lines[-1] == "  11 │ line11"


def test_only_what_ends_a_line_of_a_program_ends_one() -> None:
    assert excerpt("a\x0c\nb = 'x\u2028y'\nc()\n", span(3, 3))[-1] == "> 3 │ c()"


def test_a_place_that_is_no_longer_there_gives_nothing() -> None:
    assert excerpt("x", span(9, 9)) == []
