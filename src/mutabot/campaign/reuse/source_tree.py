"""The program files of a project at one moment, and where their places stand at another."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

from mutabot.languages.registry import unit_parser
from mutabot.model.source_units import File

if TYPE_CHECKING:
    from .parts import Parts


#: a place as outcomes name it: ``file:line``, or ``file:line:column-line:column``
_PLACE = re.compile(r"(?<![\w./$-])([\w./$-]+\.\w+):(\d+)(?::(\d+)-(\d+):(\d+))?")
#: cached for two versions of a file: most places that moved lie in the same ones
_moves = lru_cache(8)(File.moves_to)


class SourceTree:
    """The program files of a project at one moment.

    Args:
        digests: by their names.
        text: what stood in a file with this name and digest; None if that is no longer known.
    """

    def __init__(self, digests: Parts, text: Callable[[str, str], bytes | None]) -> None:
        self.digests = digests
        self._text = text
        self._files: dict[str, File | None] = {}

    def file(self, name: str) -> File | None:
        """Return a file; None if it does not exist, or its content is no longer known."""
        if name not in self._files:
            text = self._text(name, self.digests[name]) if name in self.digests else None
            self._files[name] = File(name, text, unit_parser(name)) if text is not None else None
        return self._files[name]

    @cached_property
    def unit_digests(self) -> dict[str, Mapping[str, str] | None]:
        """The content of each unit of each file."""
        files = {name: self.file(name) for name in self.digests}
        return {name: file.digests if file is not None else None for name, file in files.items()}

    def moved(self, text: str, new: SourceTree) -> str | None:
        """Return a text with the lines that it names as in a new tree; None if one no longer exists."""
        gone = False

        def place(match: re.Match[str]) -> str:
            nonlocal gone
            name = match[1]
            before, now = self.file(name), new.file(name)
            if name not in self.digests or self.digests[name] == new.digests.get(name):
                return match[0]
            extent = tuple(int(part) for part in match.groups()[1:] if part is not None)
            found = _moves(before, now).get(extent) if before is not None and now is not None else None
            if found is None:
                gone = True
                return match[0]
            line, *rest = map(str, found)
            return f"{name}:{line}:{rest[0]}-{rest[1]}:{rest[2]}" if rest else f"{name}:{line}"

        text = _PLACE.sub(place, text)
        return None if gone else text
