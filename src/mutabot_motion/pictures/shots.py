"""Where the pictures of a side come from: a film, or a drawing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

from PIL import Image

from mutabot.evidence.film import Film, Picture

#: a moment that is meant may differ by this much from that of its picture, s
_SLACK = 1e-6


class Shots(Protocol):
    """The pictures of one side.

    Attributes:
        end: the last moment that they show, s.
    """

    @property
    def end(self) -> float: ...

    def at(self, time: float) -> Image.Image:
        """How it looked at a time, s: from call to call the same or a later one."""


class Filmed:
    """What a simulator's camera saw. Raises ValueError if that is nothing."""

    def __init__(self, film: Film) -> None:
        times = film.times
        if not times:
            raise ValueError("a film without pictures")
        self.end = times[-1]
        self._coming: Iterator[Picture] = film.pictures()
        self._next: Picture | None = next(self._coming)
        self._shown = self._image(self._next)

    def at(self, time: float) -> Image.Image:
        """See ``Shots``. Before its first picture it shows that."""
        latest = None
        while self._next is not None and self._next.time <= time + _SLACK:
            latest, self._next = self._next, next(self._coming, None)
        if latest is not None:
            self._shown = self._image(latest)
        return self._shown

    @staticmethod
    def _image(picture: Picture) -> Image.Image:
        return Image.frombytes("RGB", (picture.width, picture.height), picture.pixels)
