"""Reads unified diffs, as git and diff write them.

Everything is bytes: a patch need not have the encoding of this machine, and ends of lines count.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from mutabot.api.reports import MutabotError

_HUNK = re.compile(rb"@@ -(\d{1,9})(?:,(\d{1,9}))? \+(\d{1,9})(?:,(\d{1,9}))? @@")
_SUBJECT = re.compile(rb"Subject: (?:\[PATCH[^\]]*\] )?(.*)")
_HEADER = re.compile(rb"(From [0-9a-f]{7,} |(From|Date|Index|To|Cc|MIME-Version|Content-\S+):|=+$|Only in )")
_OCTAL = re.compile(rb"\\([0-7]{3}|.)")
_ESCAPES = {b"n": b"\n", b"t": b"\t", b"r": b"\r", b"a": b"\a", b"b": b"\b", b"f": b"\f", b"v": b"\v"}
#: lines of git that say what else than lines differs
_OTHER_THAN_LINES = {
    b"GIT binary patch": "is binary",
    b"Binary files ": "is binary",
    b"rename from ": "is renamed",
    b"copy from ": "is a copy",
    b"diff --cc ": "is part of a merge, whose diffs have two originals",
    b"diff --combined ": "is part of a merge, whose diffs have two originals",
}


class PatchError(MutabotError):
    """Raised for a patch that cannot be a mutant; the message says why."""


@dataclass(frozen=True, slots=True)
class Hunk:
    """Lines that change together.

    Attributes:
        number: in its patch, from 1.
        old: the number of its first line before the change, from 1.
        new: the number of its first line after the change, from 1; 0 for none.
        before: the lines before the change, with their ends.
        after: the lines after the change.
        leading, trailing: how many of the first and last lines are context.
    """

    number: int
    old: int
    new: int
    before: tuple[bytes, ...]
    after: tuple[bytes, ...]
    leading: int
    trailing: int


@dataclass(frozen=True, slots=True)
class FileDiff:
    """The changes of a patch to a file.

    Attributes:
        old, new: its path before and after, with the first folder that git adds; None if there is no file.
        hunks: the lines that change.
        other: what differs beside lines, such as ``is binary``; empty if nothing does.
    """

    old: str | None
    new: str | None
    hunks: tuple[Hunk, ...] = ()
    other: str = ""

    @property
    def path(self) -> str:
        """The path of the file, as the patch writes it."""
        return self.new or self.old or ""


@dataclass(frozen=True, slots=True)
class Diff:
    """A patch: its title, if it has one, and its changes to files."""

    title: str
    files: tuple[FileDiff, ...]


def read_diff(content: bytes) -> Diff:
    """Read a unified diff. Raises PatchError for one that is cut off or makes no sense."""
    return _Reader(lines_of(content)).read()


def lines_of(content: bytes) -> list[bytes]:
    """Return the lines of a content with their ends; a lone carriage return does not end a line."""
    *lines, last = content.split(b"\n")
    return [*(line + b"\n" for line in lines), *([last] if last else [])]


class _Reader:
    def __init__(self, lines: list[bytes]) -> None:
        self._lines, self._at, self._hunks = lines, 0, 0

    def read(self) -> Diff:
        title, files = "", list[FileDiff]()
        git: tuple[str, str] | None = None  # what the last line `diff --git` names, if no file followed yet
        other = ""
        while self._at < len(self._lines):
            line = self._lines[self._at].rstrip(b"\r\n")
            if line.startswith(b"--- ") and self._next().startswith(b"+++ "):
                files.append(self._file(other))
                git, other = None, ""
                continue
            if line.startswith(b"diff --"):
                files += _without_lines(git, other)
                git, other = _named(line), ""
            other = next((why for begin, why in _OTHER_THAN_LINES.items() if line.startswith(begin)), other)
            if line.startswith(b"Binary files ") and git is None:
                files.append(FileDiff(None, line.decode(errors="replace").split(" and ")[0][13:], (), other))
                other = ""
            if line.startswith(b"@@ "):
                raise PatchError(f"line {self._at + 1} begins a hunk, and no lines --- and +++ name its file")
            if not files and git is None and not title:
                title = _title(line)
            self._at += 1
        return Diff(title, (*files, *_without_lines(git, other)))

    def _next(self) -> bytes:
        return self._lines[self._at + 1] if self._at + 1 < len(self._lines) else b""

    def _file(self, other: str) -> FileDiff:
        old, new = (_path(self._lines[self._at + n].rstrip(b"\r\n")[4:]) for n in (0, 1))
        self._at += 2
        return FileDiff(old, new, tuple(self._of_file()), other)

    def _of_file(self) -> Iterator[Hunk]:
        while self._at < len(self._lines):
            found = _HUNK.match(self._lines[self._at])
            if found is None:
                return
            self._hunks += 1
            self._at += 1
            yield self._hunk(found)

    def _hunk(self, found: re.Match[bytes]) -> Hunk:
        old, had, new, has = (int(group) if group is not None else 1 for group in found.groups())
        before, after, signs = list[bytes](), list[bytes](), list[bytes]()
        while len(before) < had or len(after) < has or self._is_end_of_file():
            line = self._lines[self._at] if self._at < len(self._lines) else b""
            sign, text = (line[:1], line[1:]) if line.strip(b"\r\n") else (b" " if line else b"", line)
            if sign == b"\\":  # the line before has no end
                for side, other in ((before, b"+"), (after, b"-")):
                    if side and signs[-1:] != [other]:
                        side[-1] = side[-1].removesuffix(b"\n")
            elif sign in (b" ", b"-", b"+") and sign:
                if sign != b"+":
                    before.append(text)
                if sign != b"-":
                    after.append(text)
                signs.append(sign)
            if sign not in (b" ", b"-", b"+", b"\\") or not sign or len(before) > had or len(after) > has:
                raise PatchError(
                    f"hunk {self._hunks} says {had} lines before and {has} after, and has others "
                    f"(line {self._at + 1} of the patch)"
                )
            self._at += 1
        leading = next((n for n, sign in enumerate(signs) if sign != b" "), len(signs))
        trailing = next((n for n, sign in enumerate(reversed(signs)) if sign != b" "), len(signs))
        return Hunk(self._hunks, old, new, tuple(before), tuple(after), leading, trailing)

    def _is_end_of_file(self) -> bool:
        return self._at < len(self._lines) and self._lines[self._at].startswith(b"\\ ")


def _without_lines(git: tuple[str, str] | None, other: str) -> Iterator[FileDiff]:
    """Yield a file for which git shows no lines: it is binary, moved, empty, or its mode differs."""
    if git is not None:
        yield FileDiff(*git, (), other)


def _named(line: bytes) -> tuple[str, str]:
    """Return the two paths of a line ``diff --git a/x b/x``."""
    names = line.split(b" ", 2)[2]
    middle = names.find(b" b/") if names.startswith(b"a/") else (len(names) - 1) // 2
    return _path(names[:middle]) or "", _path(names[middle + 1 :]) or ""


def _path(text: bytes) -> str | None:
    """Return a path as a patch writes it: quoted if it has special characters; a time may follow."""
    if text.startswith(b'"'):
        quoted = text[1 : text.rfind(b'"')]
        text = _OCTAL.sub(lambda match: _unescaped(match[1]), quoted)
    else:
        text = text.split(b"\t")[0].rstrip(b" ")
    return None if text == b"/dev/null" else text.decode("utf-8", errors="surrogateescape")


def _unescaped(sign: bytes) -> bytes:
    return bytes([int(sign, 8) & 255]) if len(sign) == 3 else _ESCAPES.get(sign, sign)


def _title(line: bytes) -> str:
    """Return a title from a line before the diff, as a single line."""
    subject = _SUBJECT.match(line)
    if subject is None and _HEADER.match(line):
        return ""
    text = (subject[1] if subject is not None else line).decode("utf-8", errors="replace")
    return " ".join(text.split())[:100]
