"""Source lines with an expression underlined."""

from __future__ import annotations

from rich.cells import cell_len

from mutabot.model import Span

_TAB = 4


def excerpt(source: str, span: Span, *, around: int = 2) -> list[str]:
    """The lines of a span and ``around`` lines before and after it, with a caret underline.

    Columns of the span count UTF-8 bytes; the underline counts the cells that a terminal shows.
    """
    lines = source.splitlines()
    if not 1 <= span.line <= len(lines):
        return []
    first, last = max(1, span.line - around), min(len(lines), span.end_line + around)
    width = len(str(last))
    shown = []
    for number in range(first, last + 1):
        line = lines[number - 1]
        shown.append(f"{number:>{width}} │ {line.expandtabs(_TAB)}".rstrip())
        if span.line <= number <= span.end_line:
            shown.append(f"{'':>{width}} │ {_underline(line, number, span)}")
    return shown


def _underline(line: str, number: int, span: Span) -> str:
    raw = line.encode()
    indent = len(raw) - len(raw.lstrip())
    start = span.column if number == span.line else indent
    end = span.end_column if number == span.end_line else len(raw)
    before, marked = _cells(raw[:start]), _cells(raw[:end])
    return " " * before + "^" * max(1, marked - before)


def _cells(raw: bytes) -> int:
    return cell_len(raw.decode(errors="ignore").expandtabs(_TAB))
