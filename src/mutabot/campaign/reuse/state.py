"""A state of a project's files: what lies there, and what the Python files say."""

from __future__ import annotations

import re
from collections.abc import Mapping, Set
from dataclasses import dataclass
from pathlib import Path

from mutabot.campaign.pieces.mentions import names_in
from mutabot.campaign.request import Request

from .counted import counted
from .snapshot import Snapshot

#: files that may name what is to be called, and bytes beyond which they are data
_MAY_NAME, _LONGEST = re.compile(r".*\.(toml|cfg|ini|json|ya?ml|xml|launch|xacro|urdf|feature)"), 1 << 20
_ENTRY = re.compile(r"[\w.]+:[\w.]+")


@dataclass(frozen=True, slots=True)
class State:
    """The files of a project that count, at one moment.

    Attributes:
        files: all of them, with digests of their content.
        texts: what stands in the Python files.
        names: names that other files mention.
    """

    files: Mapping[str, str]
    texts: Mapping[str, bytes]
    names: frozenset[str] = frozenset()

    @classmethod
    def now(cls, request: Request, before: Snapshot, after: Snapshot, opened: Set[str] | None) -> State:
        """The state after the baseline.

        Args:
            before, after: the files before and after the baseline.
            opened: the files that were opened meanwhile; None if that is not known.
        """
        digests = {name: file.digest for name, file in after.files.items()}
        files = counted(request, digests, after.touched_since(before), opened)
        found = {name: read(request.root / name) for name in files if name.endswith(".py")}
        texts = {name: text for name, text in found.items() if text is not None}
        return cls(files, texts, named(request.root, files))


def named(root: Path, files: Mapping[str, str]) -> frozenset[str]:
    """The names that files beside the program text mention: by them, libraries may find what to call."""
    found: set[str] = set()
    for name in files:
        text = read(root / name) if _MAY_NAME.fullmatch(name) else None
        if text is not None and len(text) <= _LONGEST:
            found |= names_in(text.decode("utf-8", "replace"))
    for name in ("pyproject.toml", "setup.cfg"):
        text = read(root / name)
        if text is not None:
            for entry in _ENTRY.findall(text.decode("utf-8", "replace")):
                found |= names_in(entry)
    return frozenset(found)


def read(path: Path) -> bytes | None:
    """What a file holds; None if it cannot be read."""
    try:
        return path.read_bytes()
    except OSError:
        return None
