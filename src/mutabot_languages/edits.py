"""Edits of a program's text, and those that are active in this process: a mutant is a few of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Edit:
    """A part of a text that becomes another.

    Attributes:
        start, end: offsets in the decoded text.
        text: what stands there instead.
    """

    start: int
    end: int
    text: str


def applied(text: str, edits: Iterable[Edit]) -> str:
    """Return the text with the edits, which do not overlap."""
    for edit in sorted(edits, key=lambda change: change.start, reverse=True):
        text = text[: edit.start] + edit.text + text[edit.end :]
    return text


def digest(content: bytes) -> str:
    """Return a digest that shows whether a file is as it was."""
    return sha256(content).hexdigest()


@dataclass(slots=True)
class ActiveEdits:
    """Edits of a file that programs which are loaded in this process have.

    Attributes:
        file: path relative to the project's root, with ``/``.
        digest: of the file that they belong to.
        edits: what is different.
        reached: called when the program carries out what is different there.
    """

    file: str
    digest: str
    edits: Sequence[Edit]
    reached: Callable[[], None]
    missed: list[str] = field(default_factory=list)

    def is_of(self, path: Path) -> bool:
        """Return whether a file is meant, by its path."""
        return f"/{path.as_posix()}".endswith(f"/{self.file}")

    def concern(self, path: Path, content: bytes) -> bool:
        """Return whether a file that is loaded is meant."""
        if not self.is_of(path):
            return False
        if digest(content) != self.digest:
            self.missed.append(f"{self.file} is not as it was when the mutant was planned")
            return False
        return True


class _Active:
    """The edits of this process, empty for the original, and the files that were read for a run."""

    edits: tuple[ActiveEdits, ...] = ()
    read: set[Path] = set()  # noqa: RUF012  # of the process


def note_read(path: Path) -> None:
    """Note that a file was read for a run of its program."""
    _Active.read.add(path)


def were_read() -> frozenset[Path]:
    """Return the files that this process, or the one that it was forked from, has read for runs."""
    return frozenset(_Active.read)


def active() -> tuple[ActiveEdits, ...]:
    """Return the edits that are active in this process."""
    return _Active.edits


def activate(edits: Iterable[ActiveEdits]) -> None:
    """Let programs that are loaded from now on have these edits, and no others."""
    _Active.edits = tuple(edits)
