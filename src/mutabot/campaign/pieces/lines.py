"""Lines: where a line of an old text stands in a new one, as far as the same piece stands in both."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping

from .piece import Piece
from .project import Project
from .renaming import Renaming

#: a place as outcomes name it: ``file:line``, or ``file:line:column-line:column``
_PLACE = re.compile(r"(?<![\w./-])([\w./-]+\.py):(\d+)(?::(\d+)-(\d+):(\d+))?")
#: a line, or the first and last line and column of a node
Extent = tuple[int, ...]


_Place = tuple[str, Extent]


class Lines:
    """From the lines of an old project to those of a new one.

    Args:
        old, new: the projects.
        renaming: how files and functions of the new one were called in the old one.
    """

    def __init__(self, old: Project, new: Project, renaming: Renaming | None = None) -> None:
        self._old, self._new = old, new
        self._renaming = renaming or Renaming()
        self._known: Mapping[str, Mapping[Extent, _Place | None]] | None = None

    def moved(self, text: str) -> str | None:
        """The text with the places that it names as they are now; None if one of them is gone."""
        gone = False

        def place(match: re.Match[str]) -> str:
            nonlocal gone
            file = match[1]
            if file not in self._old.texts or (
                self._new.digests.get(file) == self._old.digests[file] and not self._renaming
            ):
                return match[0]
            extent = tuple(int(part) for part in match.groups()[1:] if part is not None)
            found = self._map.get(file, {}).get(extent)
            gone = gone or found is None
            return match[0] if found is None else f"{found[0]}:{_shown(found[1])}"

        text = _PLACE.sub(place, text)
        return None if gone else text

    @property
    def _map(self) -> Mapping[str, Mapping[Extent, _Place | None]]:
        if self._known is None:
            self._known = self._compared()
        return self._known

    def _compared(self) -> dict[str, dict[Extent, _Place | None]]:
        before = _by_name(self._old, lambda piece: f"{piece.file}:{piece.name}")
        now = _by_name(self._new, lambda piece: self._renaming.target(f"{piece.file}:{piece.name}"))
        found: dict[str, dict[Extent, _Place | None]] = defaultdict(dict)
        for name, olds in before.items():
            for old, new in zip(olds, now.get(name, ()), strict=False):
                if self._old.digest(old) != self._new.digest(new, self._renaming):
                    continue
                for was, is_now in _lines(old, new):
                    place = (new.file, is_now)
                    if found[old.file].setdefault(was, place) != place:
                        found[old.file][was] = None
        return found


def _by_name(project: Project, name_of: Callable[[Piece], str]) -> dict[str, list[Piece]]:
    found: dict[str, list[Piece]] = defaultdict(list)
    for piece in project.pieces:
        found[name_of(piece)].append(piece)
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
