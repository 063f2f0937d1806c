"""Lines: where a line of an old text stands in a new one, as far as the same piece stands in both."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Callable, Mapping
from itertools import zip_longest

from .piece import Piece
from .project import Project
from .renaming import Renaming

#: a place as outcomes name it
_PLACE = re.compile(r"(?<![\w./-])([\w./-]+\.py):(\d+)")


class Lines:
    """From the lines of an old project to those of a new one.

    Args:
        old, new: the projects.
        renaming: how files and functions of the new one were called in the old one.
    """

    def __init__(self, old: Project, new: Project, renaming: Renaming | None = None) -> None:
        self._old, self._new = old, new
        self._renaming = renaming or Renaming()
        self._known: Mapping[str, Mapping[int, tuple[str, int] | None]] | None = None

    def moved(self, text: str) -> str | None:
        """The text with the places that it names as they are now; None if one of them is gone."""
        gone = False

        def place(match: re.Match[str]) -> str:
            nonlocal gone
            file, line = match[1], int(match[2])
            if file not in self._old.texts or (
                self._new.digests.get(file) == self._old.digests[file] and not self._renaming
            ):
                return match[0]
            found = self._map.get(file, {}).get(line)
            gone = gone or found is None
            return match[0] if found is None else f"{found[0]}:{found[1]}"

        text = _PLACE.sub(place, text)
        return None if gone else text

    @property
    def _map(self) -> Mapping[str, Mapping[int, tuple[str, int] | None]]:
        if self._known is None:
            self._known = self._compared()
        return self._known

    def _compared(self) -> dict[str, dict[int, tuple[str, int] | None]]:
        before = _by_name(self._old, lambda piece: f"{piece.file}:{piece.name}")
        now = _by_name(self._new, lambda piece: self._renaming.target(f"{piece.file}:{piece.name}"))
        found: dict[str, dict[int, tuple[str, int] | None]] = defaultdict(dict)
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


def _lines(old: Piece, new: Piece) -> set[tuple[int, int]]:
    """Lines of two pieces that say the same."""
    found = set()
    for before, now in zip_longest(old.nodes, new.nodes):
        for one, other in zip(ast.walk(before), ast.walk(now), strict=True):
            for field in ("lineno", "end_lineno"):
                lines = getattr(one, field, None), getattr(other, field, None)
                if lines[0] is not None and lines[1] is not None:
                    found.add((int(lines[0]), int(lines[1])))
    return found
