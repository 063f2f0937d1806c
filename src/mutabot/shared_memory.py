"""A memory that forked processes share, as a cache of computed values.

A campaign runs the same tests of the same program many times, each time with one fault. Up to the fault, and
wherever it changes nothing, a simulator computes what it has computed before. What it keeps here must depend
on the key alone, bit by bit: then it makes no difference to a test whether something was found here.
"""

from __future__ import annotations

import mmap
import struct
import zlib
from contextlib import suppress
from typing import ClassVar

_KEY = 16
_SIZE = 1 << 26
_SLOTS = 1 << 18
_PLACE = struct.Struct("Q")
_HEAD = struct.Struct(f"{_KEY}sII")  # key, length of the value, sum of key and value
_FIRST = _PLACE.size * (1 + _SLOTS)


class SharedMemory:
    """A cache of values by keys. New values replace the oldest ones once it is full.

    It takes up memory only as it is filled. Processes read and write without waiting for each other; a sum
    reports a value that is incomplete.

    Attributes:
        key_size: bytes of a key.
    """

    key_size: ClassVar[int] = _KEY
    _current: ClassVar[SharedMemory | None] = None

    def __init__(self) -> None:
        # first the place of the next value, then a table of places by key, then the values in a ring
        self._bytes = mmap.mmap(-1, _SIZE)
        _PLACE.pack_into(self._bytes, 0, _FIRST)

    @classmethod
    def current(cls) -> SharedMemory | None:
        """Return the memory that this process shares with others; None outside of campaigns."""
        return cls._current

    @classmethod
    def share(cls) -> None:
        """Create the memory that processes forked from this one share. Call it before the first fork.

        Where there is not enough memory, nothing is shared.
        """
        if cls._current is None:
            with suppress(OSError):
                cls._current = cls()

    @classmethod
    def forget(cls) -> None:
        """Share nothing from now on."""
        cls._current = None

    def get(self, key: bytes) -> bytes | None:
        """Return the value of a key, if it is still stored."""
        (place,) = _PLACE.unpack_from(self._bytes, _slot(key))
        if not _FIRST <= place <= _SIZE - _HEAD.size:
            return None
        found, length, check = _HEAD.unpack_from(self._bytes, place)
        if found != key:
            return None
        value = self._bytes[place + _HEAD.size : place + _HEAD.size + length]
        return value if zlib.crc32(value, zlib.crc32(key)) == check else None

    def put(self, key: bytes, value: bytes) -> None:
        """Store a value.

        Args:
            key: `key_size` bytes that identify all that the value depends on, such as a digest.
            value: if it is longer than the whole memory, it is not kept.
        """
        end = _HEAD.size + len(value)
        if end > _SIZE - _FIRST:
            return
        (place,) = _PLACE.unpack_from(self._bytes, 0)
        if not _FIRST <= place <= _SIZE - end:
            place = _FIRST
        _PLACE.pack_into(self._bytes, 0, place + end)
        _HEAD.pack_into(self._bytes, place, key, len(value), zlib.crc32(value, zlib.crc32(key)))
        self._bytes[place + _HEAD.size : place + end] = value
        _PLACE.pack_into(self._bytes, _slot(key), place)


def _slot(key: bytes) -> int:
    return _PLACE.size * (1 + int.from_bytes(key[:8], "little") % _SLOTS)
