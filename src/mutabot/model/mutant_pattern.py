"""Words that name mutants: numbers, lines, names and patterns of ids."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mutabot.model.mutant import Mutant, Span

#: numbers with more digits than these are of nothing
_NUMBERS = re.compile(r"\d{1,9}(-\d{1,9})?(,\d{1,9}(-\d{1,9})?)*")
_LINE = re.compile(r"(.+):(\d{1,9}(?:-\d{1,9})?)")


def fits(pattern: str, mutant: Mutant) -> bool:
    """Return whether a word of ``--only`` or ``--skip`` matches this mutant."""
    if means_numbers(pattern):
        return any(mutant.number in _range(part) for part in pattern.split(","))
    line = lines_of_pattern(pattern)
    if line is not None and any(_is_at(span, *line) for span in mutant.site.spans):
        return True
    names = (mutant.operator, mutant.family, mutant.site.role.value)
    if pattern in names or is_like(pattern, mutant.id):
        return True
    return any(_is_in(pattern, span) for span in mutant.site.spans)


def _is_in(pattern: str, span: Span) -> bool:
    """Return whether a word is a line of a span, its file or one of its folders."""
    lines = (f"{span.file}:{number}" for number in range(span.line, span.end_line + 1))
    return (
        is_like(pattern, span.file)
        or span.file.startswith(pattern.rstrip("/") + "/")
        or any(is_like(pattern, line) for line in lines)
    )


def means_numbers(pattern: str) -> bool:
    """Return whether a word consists of mutants' numbers."""
    return _NUMBERS.fullmatch(pattern) is not None


def numbers_in(pattern: str) -> Iterator[int]:
    """Yield the numbers in ``3,16-20``, in order."""
    return (number for part in pattern.split(",") for number in _range(part))


def lines_of_pattern(pattern: str) -> tuple[str, range] | None:
    """Return the file and the lines that a word names; None if it is no ``file:line``."""
    line = _LINE.fullmatch(pattern)
    return (line[1], _range(line[2])) if line is not None else None


def _range(text: str) -> range:
    """Return the numbers in ``7`` or ``3-7``."""
    first, _, last = text.partition("-")
    return range(int(first), int(last or first) + 1)


def _is_at(span: Span, file: str, lines: range) -> bool:
    """Return whether a span is in these lines of a file, whose first folders may be left out."""
    is_here = is_like(file, span.file) or span.file.endswith("/" + file.removeprefix("…/"))
    return is_here and span.line < lines.stop and span.end_line >= lines.start


def is_like(pattern: str, text: str) -> bool:
    """Return whether a text matches a pattern in which only ``*`` and ``?`` are special.

    What stands between stars is looked for once, from left to right: no pattern takes long.
    """
    first, *between = pattern.split("*")
    if not between:
        return pattern == text or _literal_pattern(pattern).fullmatch(text) is not None
    last = between.pop()
    at, end = len(first), len(text) - len(last)
    if at > end or not _literal_pattern(first).match(text) or not _literal_pattern(last).fullmatch(text, end):
        return pattern == text
    for part in filter(None, between):
        found = _literal_pattern(part).search(text, at, end)
        if found is None:
            return pattern == text
        at = found.end()
    return True


@lru_cache(maxsize=1024)
def _literal_pattern(part: str) -> re.Pattern[str]:
    """Return the regular expression for a part of a pattern without stars."""
    return re.compile("".join("." if sign == "?" else re.escape(sign) for sign in part), re.DOTALL)
