"""Read a film that the test process wrote: see ``mutabot.evidence.tape.FilmWriter``."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from mutabot.evidence.tape import HEAD, differing
from mutabot.frozen import frozen


@frozen
class Picture:
    """One picture.

    Attributes:
        time: s, on the same clock as the recording of the test.
        height, width: pixels.
        pixels: red, green and blue, a byte each, row by row from the top.
    """

    time: float
    height: int
    width: int
    pixels: bytes


class Film:
    """A film that was written; of one whose process was killed it has the pictures that are whole.

    Args:
        path: its file. One that does not exist has no pictures.
    """

    def __init__(self, path: Path) -> None:
        self._path = path

    @property
    def times(self) -> list[float]:
        """When its pictures were taken, s."""
        return [head[0] for head, _ in self._heads()]

    def pictures(self) -> Iterator[Picture]:
        """All of them, one after the other."""
        before = b""
        for (at, height, width, size), file in self._heads():
            before = differing(zlib.decompress(file.read(size)), before)
            yield Picture(at, height, width, before)

    def _heads(self) -> Iterator[tuple[tuple[float, int, int, int], BinaryIO]]:
        """What stands before each picture, and the file at its beginning."""
        if not self._path.is_file():
            return
        length = self._path.stat().st_size
        with self._path.open("rb") as file:
            while len(head := file.read(HEAD.size)) == HEAD.size:
                time, height, width, size = HEAD.unpack(head)
                after = file.tell() + size
                if after > length:
                    return
                yield (time, height, width, size), file
                file.seek(after)
