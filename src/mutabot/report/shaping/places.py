"""Places in source files as other tools count them: columns in characters, not in bytes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mutabot.model import Span


@dataclass(frozen=True, slots=True)
class Place:
    """A place in a file.

    Attributes:
        line, end_line: from 1.
        column: from 1; 1 if the text is not known.
        end_column: from 1, of the first character behind it; None if the text is not known.
        text: what stands there; None if it is not known.
    """

    line: int
    column: int
    end_line: int
    end_column: int | None
    text: str | None


def utf16(text: str) -> int:
    """Length in UTF-16 code units, as programs in JavaScript and SARIF count."""
    return len(text.encode("utf-16-le", errors="replace")) // 2


def place_of(span: Span, source: str | None, length: Callable[[str], int] = len) -> Place:
    """The place of a span. ``length`` counts the characters of a part of a line.

    Other tools know no place without a line: what does not stand in the text is told at the first one.
    """
    lines = source.split("\n") if source is not None else []
    if not 1 <= span.line <= span.end_line <= len(lines):
        line = max(span.line, 1)
        return Place(line, 1, max(line, span.end_line), None, None)
    before = _prefix(lines[span.line - 1], span.column)
    whole = _prefix(lines[span.end_line - 1], span.end_column)
    shown = [*lines[span.line - 1 : span.end_line - 1], whole]
    shown[0] = shown[0][len(before) :]
    return Place(span.line, length(before) + 1, span.end_line, length(whole) + 1, "\n".join(shown))


def _prefix(line: str, column: int) -> str:
    """What stands before a column in UTF-8 bytes, from 0."""
    return line.encode(errors="replace")[:column].decode(errors="ignore")
