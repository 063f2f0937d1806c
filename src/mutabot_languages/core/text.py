"""A program's text: decoded so that any file comes out byte for byte, with lines and columns."""

from __future__ import annotations

import re
from bisect import bisect_right

#: first line (1-based), first column, last line, last column (0-based, in UTF-8 bytes)
TextSpan = tuple[int, int, int, int]
_LINE_ENDS = re.compile(r"\r\n|\r|\n")


def decode(content: bytes) -> tuple[str, str]:
    """Return the text of a file, and the encoding that gives its bytes back: UTF-8 or else Latin-1."""
    try:
        return content.decode("utf-8"), "utf-8"
    except UnicodeDecodeError:
        return content.decode("latin-1"), "latin-1"


class SourceText:
    """A text with its name.

    Args:
        name: of the file, as messages show it.
        text: as ``decode`` gives it.
    """

    def __init__(self, name: str, text: str) -> None:
        self.name, self.text = name, text
        self._starts = [0, *(found.end() for found in _LINE_ENDS.finditer(text))]

    def line_of(self, offset: int) -> int:
        """Return the 1-based line of an offset."""
        return bisect_right(self._starts, offset)

    def position(self, offset: int) -> tuple[int, int]:
        """Return the 1-based line and the 0-based column, in UTF-8 bytes, of an offset."""
        line = self.line_of(offset)
        return line, len(self.text[self._starts[line - 1] : offset].encode())

    def extent(self, start: int, end: int) -> TextSpan:
        """Return the place of a part of the text."""
        return (*self.position(start), *self.position(end))

    def place(self, offset: int) -> str:
        """Return ``file:line:column`` with the 1-based column that editors show."""
        line = self.line_of(offset)
        return f"{self.name}:{line}:{offset - self._starts[line - 1] + 1}"
