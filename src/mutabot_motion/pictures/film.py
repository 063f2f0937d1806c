"""A film: the pictures of one test, written by its process and read after that has ended.

Each picture is kept as its difference from the one before, compressed: most of a work cell stands still.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

#: before each picture of a film: its time in s, height, width, and bytes that follow
_HEAD = struct.Struct("<dIII")


class FilmWriter:
    """Writes pictures to a film until it is closed or its process ends.

    Attributes:
        count: how many there are.
    """

    def __init__(self, path: str) -> None:
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC, 0o600)
        self._before = b""
        self.count = 0

    def add(self, time: float, picture: Any) -> None:
        """Add a picture. Raises ValueError for an invalid one, TypeError for one without numbers.

        Args:
            time: s.
            picture: shape (height, width, 3) or (height, width, 4), of bytes; the fourth of each is left out.
        """
        height, width, pixels = _pixels_of(picture)
        data = zlib.compress(_differing(pixels, self._before), 1)
        left = memoryview(_HEAD.pack(time, height, width, len(data)) + data)
        while left:
            left = left[os.write(self._file, left) :]
        self._before = pixels
        self.count += 1

    def close(self) -> None:
        """Close the film; no further pictures are added."""
        os.close(self._file)


def _pixels_of(picture: Any) -> tuple[int, int, bytes]:
    """Return height, width and pixels of a picture. Raises the errors of ``FilmWriter.add``."""
    view = memoryview(picture)
    if view.ndim != 3 or view.shape is None or view.shape[2] not in (3, 4) or view.format != "B":
        raise ValueError(
            f"a picture has the shape (height, width, 3) and numbers of the type uint8, not {view.shape} "
            f"of the type {view.format!r}"
        )
    height, width, depth = view.shape
    if not height or not width:
        raise ValueError(f"a picture of {width} by {height} pixels")
    data = view.tobytes()
    if depth == 3:
        return height, width, data
    pixels = bytearray(height * width * 3)
    for colour in range(3):
        pixels[colour::3] = data[colour::4]
    return height, width, bytes(pixels)


def _differing(pixels: bytes, before: bytes) -> bytes:
    """Return the bitwise difference of two pictures of the same size; applied twice it restores a picture."""
    if len(pixels) != len(before):
        return pixels
    both = int.from_bytes(pixels, "little") ^ int.from_bytes(before, "little")
    return both.to_bytes(len(pixels), "little")


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture.

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
    """A film that was written; if its process was killed, it has only the complete pictures.

    Args:
        path: its file. One that does not exist has no pictures.
    """

    def __init__(self, path: Path) -> None:
        self._path = path

    @property
    def times(self) -> list[float]:
        """The times of its pictures, s."""
        return [head[0] for head, _ in self._headers()]

    @property
    def end(self) -> float:
        """The time of its last picture so far, s; 0 without any."""
        return max(self.times, default=0.0)

    def pictures(self) -> Iterator[Picture]:
        """Yield all pictures in order."""
        before = b""
        for (at, height, width, size), file in self._headers():
            before = _differing(zlib.decompress(file.read(size)), before)
            yield Picture(at, height, width, before)

    def _headers(self) -> Iterator[tuple[tuple[float, int, int, int], BinaryIO]]:
        """Yield the header of each picture, and the file, positioned at its start."""
        if not self._path.is_file():
            return
        length = self._path.stat().st_size
        with self._path.open("rb") as file:
            while len(head := file.read(_HEAD.size)) == _HEAD.size:
                time, height, width, size = _HEAD.unpack(head)
                after = file.tell() + size
                if after > length:
                    return
                yield (time, height, width, size), file
                file.seek(after)
