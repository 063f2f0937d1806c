"""Applies the hunks of a patch to a file's content as ``git apply`` does.

Every line of context must be there as the patch has it; a hunk may stand some lines further up or down than
it says, and goes to the nearest place.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from .diffs import Hunk, PatchError, lines_of

#: first line (1-based), first column, last line, last column (0-based, in bytes)
HunkExtent = tuple[int, int, int, int]


@dataclass(frozen=True, slots=True)
class Applied:
    """The result of applying hunks to a file.

    Attributes:
        content: what it holds then.
        extents: where each hunk stands in what it held before: the lines that change, or the line before
            those that are added.
        notes: hunks that stand elsewhere than the patch says, a sentence each.
    """

    content: bytes
    extents: tuple[HunkExtent, ...]
    notes: tuple[str, ...]


def apply(content: bytes, hunks: Sequence[Hunk], path: str) -> Applied:
    """Apply the hunks of a file. Raises PatchError, which names the first hunk that does not apply."""
    lines = _PatchedLines(content)
    extents, notes = list[HunkExtent](), list[str]()
    for hunk in hunks:
        expected = hunk.new - 1 if hunk.new else 0
        found = lines.find(hunk, expected)
        if found is None:
            raise PatchError(lines.why_not(hunk, expected, path))
        if found != expected:
            count, way = abs(found - expected), "down" if found > expected else "up"
            notes.append(f"hunk {hunk.number} {count} line{'s' * (count > 1)} further {way}")
        extents.append(lines.replace(hunk, found))
    return Applied(lines.content, tuple(extents), tuple(notes))


class _PatchedLines:
    """The lines of a file, some of them replaced."""

    def __init__(self, content: bytes) -> None:
        self._before = lines_of(content)
        #: the lines now, and the number of each before, from 0; None for those of a hunk
        self._now: list[tuple[bytes, int | None]] = [(line, n) for n, line in enumerate(self._before)]

    @property
    def content(self) -> bytes:
        return b"".join(line for line, _ in self._now)

    def find(self, hunk: Hunk, expected: int) -> int | None:
        """Return where a hunk fits: the nearest place, below before above; None if there is none."""
        last = len(self._now) - len(hunk.before)
        if not hunk.leading and not hunk.trailing and hunk.old > 1:  # without context nothing says where else
            places: Iterator[int] = iter((expected,))
        elif hunk.old <= 1:
            places = iter((0,))
        elif not hunk.trailing:
            places = iter((last,))
        else:
            places = _around(min(expected, max(last, 0)), last)
        return next((place for place in places if self._fits(hunk, place)), None)

    def _fits(self, hunk: Hunk, at: int) -> bool:
        there = self._now[at : at + len(hunk.before)]
        is_whole = len(there) == len(hunk.before) and 0 <= at <= len(self._now)
        if not hunk.trailing and hunk.leading:  # it is the end of the file
            is_whole = is_whole and at + len(hunk.before) == len(self._now)
        pairs = zip(there, hunk.before, strict=False)
        return is_whole and all(line == wanted and n is not None for (line, n), wanted in pairs)

    def replace(self, hunk: Hunk, at: int) -> HunkExtent:
        """Put the lines of a hunk in place; return the position in the original file."""
        end = at + len(hunk.before)
        changed = [n for _, n in self._now[at + hunk.leading : end - hunk.trailing] if n is not None]
        if not changed:
            above = [n for _, n in self._now[: at + hunk.leading] if n is not None]
            changed = above[-1:] or [0]
        self._now[at:end] = [(line, None) for line in hunk.after]
        text = self._before[changed[-1]] if changed[-1] < len(self._before) else b""
        return changed[0] + 1, 0, changed[-1] + 1, len(text.rstrip(b"\r\n"))

    def why_not(self, hunk: Hunk, expected: int, path: str) -> str:
        """Return why a hunk does not apply: the first line that differs, or that it is already applied."""
        begin = f"hunk {hunk.number} does not apply to {path}"
        now = [line for line, _ in self._now]
        if now[expected : expected + len(hunk.after)] == [*hunk.after] and hunk.after != hunk.before:
            return f"{begin}: what it makes is there already"
        bare = [line.rstrip(b"\r\n") for line in now]
        wanted = [line.rstrip(b"\r\n") for line in hunk.before]
        if any(bare[n : n + len(wanted)] == wanted for n in range(len(bare))) and wanted:
            return f"{begin}: its lines are there, but end otherwise (CRLF, LF, none) or stand elsewhere"
        for n, line in enumerate(wanted):
            there = bare[expected + n] if expected + n < len(bare) else None
            if there != line:
                has = "the file ends before" if there is None else f"there is {_shown(there)}"
                return f"{begin}: line {expected + n + 1} was {_shown(line)}, and {has}"
        return f"{begin}: it has no context, and is to be applied elsewhere than at line {hunk.old}"


def _around(start: int, last: int) -> Iterator[int]:
    """Yield places from 0 to the last, the nearest first; of two equally near, the one below first."""
    for distance in range(max(start, last - start, 0) + 1):
        yield from (
            position
            for position in dict.fromkeys((start + distance, start - distance))
            if 0 <= position <= last
        )


def _shown(line: bytes) -> str:
    text = line.decode("utf-8", errors="replace").strip()
    return repr(text if len(text) <= 60 else text[:59] + "…")
