"""Writes a mutant into the text of its file, as a person would edit it by hand."""

from __future__ import annotations

import ast
import tokenize
from bisect import bisect_right
from importlib.util import decode_source
from io import BytesIO
from itertools import accumulate

from mutabot.api.faults import Alternative, TextPlace

from .index import TextExtent, extent_of, segment_of
from .operator import HELPER

#: what the helper's functions are in a text that is run where there is no helper
_FAIL = "(_ for _ in ()).throw(type(name, (Exception,), {'__module__': 'builtins'})(text))"
_EQUAL = "(lambda equal: equal.any() if hasattr(equal, 'any') else equal)(value == wrong)"
_WITHOUT_HELPER = {
    f"{HELPER}.absolute(": "__import__('builtins').abs(",
    f"{HELPER}.fail(": f"(lambda name, text: {_FAIL})(",
    f"{HELPER}.fail_if(": f"(lambda value, wrong, name, text: {_FAIL} if {_EQUAL} else value)(",
}
#: the first byte that is replaced, the one after the last, and what stands there then
TextEdit = tuple[int, int, bytes]


class TextWriter:
    """Writes the mutants of a file.

    Args:
        content: what the file holds.

    Raises SyntaxError if that is no Python.
    """

    def __init__(self, content: bytes) -> None:
        found = tokenize.detect_encoding(BytesIO(content).readline)[0]
        has_mark = found == "utf-8-sig"
        self._encoding, self._mark = "utf-8" if has_mark else found, 3 if has_mark else 0
        rows = content.splitlines(keepends=True)
        self._newline = "\r\n" if rows and rows[0].endswith(b"\r\n") else "\n"
        self._starts: list[int] = [0, *accumulate(map(len, rows))]
        text: str = decode_source(content)
        self._lines = [line.encode() for line in text.split("\n")]
        tree = ast.parse(text)
        self._statements = tree.body
        self._firsts = [_first_line(statement) for statement in self._statements]
        formatted = (extent_of(node) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr))
        self._formatted = {line for first, _, last, _ in formatted for line in range(first, last + 1)}

    def edit(self, place: TextPlace, alternative: Alternative) -> TextEdit | None:
        """Return the change of the file that makes a mutant; None if no text can express it there."""
        line, column, end_line, end_column = place.extent
        text = self._text(place, alternative)
        text += "\n" * (end_line - line - text.count("\n"))  # what comes after it keeps its line
        text = text if place.statement else f"({text})"
        # before Python 3.12 a formatted text cannot hold all that stands elsewhere
        if line in self._formatted and not self._is_program(place.extent, text):
            return None
        written = text.replace("\n", self._newline).encode(self._encoding)
        return self._offset(line, column), self._offset(end_line, end_column), written

    def _text(self, place: TextPlace, alternative: Alternative) -> str:
        """Return an alternative as program text, in which every part of the original is as it was."""
        if HELPER not in alternative.template:
            return alternative.text
        text = alternative.template
        for name, instead in _WITHOUT_HELPER.items():
            text = text.replace(name, instead)
        for index, extent in enumerate(place.kept):
            text = text.replace(Alternative.kept_name(index), f"({segment_of(self._lines, extent)})")
        return text

    def _is_program(self, extent: TextExtent, text: str) -> bool:
        """Return whether the outermost statement around a place can be parsed with another text there."""
        line, column, end_line, end_column = extent
        body = self._statements[bisect_right(self._firsts, line) - 1]
        first, last = _first_line(body), body.end_lineno or end_line
        before = segment_of(self._lines, (first, 0, line, column))
        after = segment_of(self._lines, (end_line, end_column, last, len(self._lines[last - 1])))
        try:
            compile(f"{before}{text}{after}", "<mutant>", "exec", ast.PyCF_ONLY_AST, dont_inherit=True)
        except (SyntaxError, ValueError):
            return False
        return True

    def _offset(self, line: int, column: int) -> int:
        """Return the bytes of the file before a line and column, of which the latter is in UTF-8."""
        before = self._lines[line - 1][:column].decode().encode(self._encoding)
        return self._starts[line - 1] + (self._mark if line == 1 else 0) + len(before)


def _first_line(statement: ast.stmt) -> int:
    first: int = min(
        [statement.lineno, *(decorator.lineno for decorator in getattr(statement, "decorator_list", ()))]
    )
    return first
