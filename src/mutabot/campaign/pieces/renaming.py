"""Renaming: how files and functions were called before, so that old and new can be compared."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import field

from mutabot.frozen import frozen

_IDENTIFIER = re.compile(r"[^\W\d]\w*")


@frozen
class Renaming:
    """What had another name before.

    Attributes:
        files: renamed files, from what they are called now to what they were.
        functions: ``file:name`` of functions that stand elsewhere, likewise.
        words: identifiers, likewise.
    """

    files: Mapping[str, str] = field(default_factory=dict)
    functions: Mapping[str, str] = field(default_factory=dict)
    words: Mapping[str, str] = field(default_factory=dict)

    def __bool__(self) -> bool:
        return bool(self.files or self.functions or self.words)

    def target(self, name: str) -> str:
        """A file, or ``file:name``, as it was called."""
        file, separator, rest = name.partition(":")
        if not separator:
            return self.files.get(name, name)
        top, dot, inner = rest.partition(".")
        moved = self.functions.get(name) or self.functions.get(f"{file}:{top}")
        if moved is not None:
            return moved if name in self.functions else f"{moved}{dot}{inner}"
        return f"{self.files.get(file, file)}:{rest}"

    def word(self, text: str) -> str:
        """A text with the identifiers in it as they were."""
        return _IDENTIFIER.sub(lambda match: self.words.get(match[0], match[0]), text) if self.words else text

    def path(self, text: str) -> str:
        """A text with the files in it as they were called."""
        for now, was in self.files.items():
            text = re.sub(rf"(?<![\w./-]){re.escape(now)}(?![\w./-])", was, text)
        return text

    def tells_of(self, text: str) -> bool:
        """Whether a text names something by what it was called."""
        names = {*self.words.values(), *self.files.values()}
        names |= {was.partition(":")[0] for was in self.functions.values()}
        return any(re.search(rf"(?<![\w]){re.escape(name)}(?![\w])", text) for name in names)

    def dotted(self, name: str) -> str:
        """``a.b.c`` as it was called."""
        return ".".join(self.words.get(part, part) for part in name.split("."))
