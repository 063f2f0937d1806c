"""From positions of the concrete syntax tree to those of ``ast``."""

from __future__ import annotations

import re
from collections.abc import Mapping

import libcst as cst
from libcst.metadata import CodeRange

from mutabot.model.alternative import Extent

_LINE_ENDS = re.compile(r"\r\n|\r|\n")


class Extents:
    """Extents of nodes in one module.

    Columns of the concrete tree count characters, those of ``ast`` bytes of UTF-8; a tuple's parentheses
    belong to the tuple in ``ast``, other parentheses to nothing.
    """

    def __init__(self, text: str, ranges: Mapping[cst.CSTNode, CodeRange]) -> None:
        self._lines = _LINE_ENDS.split(text)
        self._ranges = ranges

    def of(self, node: cst.CSTNode) -> Extent:
        """Where a node stands."""
        first = last = node
        if isinstance(node, cst.Tuple | cst.GeneratorExp) and node.lpar:
            first, last = node.lpar[-1], node.rpar[0]
        start, end = self._ranges[first].start, self._ranges[last].end
        return (
            start.line,
            self._column(start.line, start.column),
            end.line,
            self._column(end.line, end.column),
        )

    def segment(self, extent: Extent) -> str:
        """The program text at an extent."""
        first, start, last, end = extent
        lines = [line.encode() for line in self._lines[first - 1 : last]]
        lines[-1] = lines[-1][:end]
        lines[0] = lines[0][start:]
        return b"\n".join(lines).decode()

    def _column(self, line: int, column: int) -> int:
        text = self._lines[line - 1]
        return column if text.isascii() else len(text[:column].encode())
