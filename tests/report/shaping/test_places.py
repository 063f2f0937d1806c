"""Places in files, in the characters that other tools count."""

from __future__ import annotations

import pytest

from mutabot.model import Span
from mutabot.report.format import FilePlace, place_of, utf16

SOURCE = 'x = "größe"; go(\n    1,\n)\n"😀", go()\n'


def span(line: int, column: int, end_line: int, end_column: int) -> Span:
    return Span("f.py", line, column, end_line, end_column, "f")


def test_columns_are_characters() -> None:
    assert place_of(span(1, 15, 1, 18), SOURCE) == FilePlace(1, 14, 1, 17, "go(")


@pytest.mark.parametrize(("length", "column"), [(len, 6), (utf16, 7)])
def test_a_character_beyond_the_first_65536_counts_as_the_tool_counts(length: object, column: int) -> None:
    assert callable(length)
    assert place_of(span(4, 8, 4, 12), SOURCE, length) == FilePlace(4, column, 4, column + 4, "go()")


def test_a_call_over_several_lines_has_all_its_text() -> None:
    assert place_of(span(1, 15, 3, 1), SOURCE) == FilePlace(1, 14, 3, 2, "go(\n    1,\n)")


@pytest.mark.parametrize("source", [None, "", "x\n"])
def test_a_place_that_is_not_there_has_its_lines_alone(source: str | None) -> None:
    assert place_of(span(3, 4, 3, 9), source) == FilePlace(3, 1, 3, None, None)
