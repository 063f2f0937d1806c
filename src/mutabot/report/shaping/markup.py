"""Markdown as GitHub and GitLab read it, with texts in it that mean nothing but themselves."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Sequence

from .texts import one_line

#: what begins a structure within a line: emphasis, code, links, images, tables, formulas, strikethrough
_SPECIAL = re.compile(r"([\\`*_\[\]|~$])")
#: what begins one at the start of a line
_START = re.compile(r"^(#+|[-+=]+)(?=\s|$)|^(\d+)([.)])(?=\s|$)")


def escaped(text: str) -> str:
    """A text as one line of Markdown that shows it as it is, wherever it stands."""
    line = one_line(text).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    line = _SPECIAL.sub(r"\\\1", line)
    # no link is made of an address that a program wrote
    line = line.replace("://", ":&#47;&#47;").replace("www.", "www&#46;")
    return _START.sub(lambda found: f"\\{found[1]}" if found[1] else f"{found[2]}\\{found[3]}", line)


def table(head: Sequence[str], rows: Iterable[Sequence[str]], *, right: Container[int] = ()) -> Iterator[str]:
    """The lines of a table, and an empty one. ``right``: columns of numbers."""
    yield _row(head)
    yield _row_of("---:" if index in right else "---" for index in range(len(head)))
    for row in rows:
        yield _row(row)
    yield ""


def _row(cells: Iterable[str]) -> str:
    return _row_of(escaped(cell) for cell in cells)


def _row_of(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"
