"""Renaming: how files and functions were called before, so that old and new can be compared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
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

    def dotted(self, name: str) -> str:
        """``a.b.c`` as it was called."""
        return ".".join(self.words.get(part, part) for part in name.split("."))
