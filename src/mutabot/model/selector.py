"""Selectors: the words by which people choose mutants, such as names, numbers, files and lines."""

from __future__ import annotations

import re

from .mutant import Mutant

#: numbers with more digits than these are of nothing
_NUMBERS = re.compile(r"\d{1,9}(-\d{1,9})?(,\d{1,9}(-\d{1,9})?)*")
_LINE = re.compile(r"(.+):(\d{1,9}(?:-\d{1,9})?)")


def fits(pattern: str, mutant: Mutant) -> bool:
    """Whether a word of ``--only`` or ``--skip`` means this mutant."""
    if means_numbers(pattern):
        return any(mutant.number in _range(part) for part in pattern.split(","))
    line = line_of(pattern)
    if line is not None and _is_at(mutant, *line):
        return True
    names = (mutant.operator, mutant.family, mutant.site.role.value)
    file = mutant.site.span.file
    return (
        pattern in names
        or is_like(pattern, mutant.id)
        or is_like(pattern, file)
        or file.startswith(pattern.rstrip("/") + "/")
    )


def means_numbers(pattern: str) -> bool:
    """Whether a word means numbers of mutants."""
    return _NUMBERS.fullmatch(pattern) is not None


def line_of(pattern: str) -> tuple[str, range] | None:
    """The file and the lines that a word means; None if it means something else."""
    line = _LINE.fullmatch(pattern)
    return (line[1], _range(line[2])) if line is not None else None


def _range(text: str) -> range:
    """The numbers that ``7`` or ``3-7`` means."""
    first, _, last = text.partition("-")
    return range(int(first), int(last or first) + 1)


def _is_at(mutant: Mutant, file: str, lines: range) -> bool:
    """Whether a mutant stands in these lines of a file, whose first folders may be left out."""
    span = mutant.site.span
    is_here = is_like(file, span.file) or span.file.endswith("/" + file.removeprefix("…/"))
    return is_here and span.line < lines.stop and span.end_line >= lines.start


def is_like(pattern: str, text: str) -> bool:
    """Whether a text fits a pattern, in which ``*`` and ``?`` are wild and brackets are just brackets."""
    parts = re.split(r"([*?])", pattern)
    wild = {"*": ".*", "?": "."}
    expression = "".join(wild.get(part, re.escape(part)) for part in parts)
    return pattern == text or re.fullmatch(expression, text) is not None
