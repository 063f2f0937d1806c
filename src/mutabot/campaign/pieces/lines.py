"""Lines: where a line of an old text stands in a new one, as far as the same piece stands in both."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from functools import cached_property

from .piece import Piece
from .project import Project

#: a place as outcomes name it: ``file:line``, or ``file:line:column-line:column``
_PLACE = re.compile(r"(?<![\w./-])([\w./-]+\.py):(\d+)(?::(\d+)-(\d+):(\d+))?")
#: a line, or the first and last line and column of a node
Extent = tuple[int, ...]


class Lines:
    """From the lines of an old project to those of a new one.

    Args:
        old, new: the projects.
    """

    def __init__(self, old: Project, new: Project) -> None:
        self._old, self._new = old, new

    def moved(self, text: str) -> str | None:
        """The text with the places that it names as they are now; None if one of them is gone."""
        gone = False

        def place(match: re.Match[str]) -> str:
            nonlocal gone
            file = match[1]
            if file not in self._old.texts or self._new.digests.get(file) == self._old.digests[file]:
                return match[0]
            extent = tuple(int(part) for part in match.groups()[1:] if part is not None)
            found = self._map.get(file, {}).get(extent)
            gone = gone or found is None
            return match[0] if found is None else f"{file}:{_shown(found)}"

        text = _PLACE.sub(place, text)
        return None if gone else text

    @cached_property
    def _map(self) -> Mapping[str, Mapping[Extent, Extent | None]]:
        """By file, where each extent is now; None where that is not clear."""
        now = _by_name(self._new)
        found: dict[str, dict[Extent, Extent | None]] = defaultdict(dict)
        for (file, name), olds in _by_name(self._old).items():
            for old, new in zip(olds, now.get((file, name), ()), strict=False):
                if self._old.digest(old) != self._new.digest(new):
                    continue
                for was, is_now in _lines(old, new):
                    if found[file].setdefault(was, is_now) != is_now:
                        found[file][was] = None
        return found


def _by_name(project: Project) -> dict[tuple[str, str], list[Piece]]:
    found: dict[tuple[str, str], list[Piece]] = defaultdict(list)
    for piece in project.pieces:
        found[piece.file, piece.name].append(piece)
    return found


def _shown(extent: Extent) -> str:
    if len(extent) == 1:
        return str(extent[0])
    line, column, end_line, end_column = extent
    return f"{line}:{column}-{end_line}:{end_column}"


def _lines(old: Piece, new: Piece) -> set[tuple[Extent, Extent]]:
    """Lines and extents in two pieces that say the same."""
    return {pair for nodes in zip(old.nodes, new.nodes, strict=True) for pair in _extents(*nodes)}


def _extents(before: ast.AST, now: ast.AST) -> Iterator[tuple[Extent, Extent]]:
    """Lines and extents of all nodes of two trees that are alike."""
    for one, other in zip(ast.walk(before), ast.walk(now), strict=True):
        was, is_now = (_extent(node) for node in (one, other))
        if was is not None and is_now is not None:
            yield was, is_now
            yield was[:1], is_now[:1]
            yield was[2:3], is_now[2:3]


def _extent(node: ast.AST) -> Extent | None:
    line = getattr(node, "lineno", None)
    if line is None:
        return None
    end, column = getattr(node, "end_lineno", line), getattr(node, "end_col_offset", 0)
    return int(line), int(getattr(node, "col_offset", 0)), int(end), int(column)
