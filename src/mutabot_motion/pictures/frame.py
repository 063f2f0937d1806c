"""A video frame: both sides with their labels, the time, and the moment of the fault."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

from PIL import Image, ImageDraw, ImageOps

from mutabot_motion.pictures.film import Film, Picture
from mutabot_motion.view import COLOURS, MotionView

from .fonts import font_of_size

_GROUND, _TEXT, _DIM, _RAIL = "#14171c", "#e8ebf0", "#98a1ad", "#3a414b"
_FAULT, _APART = "#ff6b45", "#f0e442"
_MARGIN, _TITLE, _FOOT = 14, 74, 112
#: a video takes at least and at most so long, s, if it need not be slower than this
_SHORTEST, _LONGEST, _SLOWEST = 3.0, 120.0, 1 / 8
#: a picture is shown at least and at most this wide, pixels
_LEAST, _MOST = 480, 960

#: a moment that is meant may differ by this much from that of its picture, s
_SLACK = 1e-6


def _speed(end: float) -> float:
    speed = 1.0
    while speed > _SLOWEST and end / speed < _SHORTEST:
        speed /= 2.0
    while end / speed > _LONGEST:
        speed *= 2.0
    return speed


class SidePictures(Protocol):
    """The interface of one side's pictures.

    Attributes:
        end: the last moment that they show, s.
    """

    @property
    def end(self) -> float: ...

    def at(self, time: float) -> Image.Image:
        """Return the picture at a time, s; later calls must have the same or a later time."""


class FilmedPictures:
    """The pictures of a simulator's camera. Raises ValueError if there are none."""

    def __init__(self, film: Film) -> None:
        times = film.times
        if not times:
            raise ValueError("a film without pictures")
        self.end = times[-1]
        self._coming: Iterator[Picture] = film.pictures()
        self._next: Picture | None = next(self._coming)
        self._image_now = self._image(self._next)

    def at(self, time: float) -> Image.Image:
        """Return the picture at a time, s, or the first one before that; see ``SidePictures``."""
        latest = None
        while self._next is not None and self._next.time <= time + _SLACK:
            latest, self._next = self._next, next(self._coming, None)
        if latest is not None:
            self._image_now = self._image(latest)
        return self._image_now

    @staticmethod
    def _image(picture: Picture) -> Image.Image:
        return Image.frombytes("RGB", (picture.width, picture.height), picture.pixels)


class Frames:
    """The frames of a video.

    Args:
        sides: the pictures of the original and of the mutant.

    Attributes:
        end: the last moment, s.
        speed: seconds that pass in one of the video: fewer where there are few, more where there are many.
        size: width and height, even numbers of pixels, as H.264 wants them.
    """

    def __init__(self, view: MotionView, sides: tuple[SidePictures, SidePictures]) -> None:
        self._view, self._sides = view, sides
        self.end = max(side.end for side in sides)
        self.speed = _speed(self.end)
        width, height = sides[0].at(0.0).size
        self._width: int = min(_MOST, max(_LEAST, width)) & ~1
        self._height: int = max(2, round(height * self._width / width) & ~1)
        self.size = 3 * _MARGIN + 2 * self._width, _TITLE + self._height + _FOOT
        self._rail = _MARGIN + 160, self.size[0] - _MARGIN, _TITLE + self._height + 22
        story = f"{view.story[:1].upper()}{view.story[1:]}"
        self._story = font_of_size(15).lines(story, self.size[0] - 2 * _MARGIN, 2)
        self._empty = Image.new("RGB", self.size, _GROUND)
        self._draw_titles(ImageDraw.Draw(self._empty))
        self._draw_rail(ImageDraw.Draw(self._empty))

    def at(self, time: float) -> Image.Image:
        """Return the frame at a time, s; later calls must have the same or a later time."""
        frame = self._empty.copy()
        for number, side in enumerate(self._sides):
            frame.paste(self._fitted(side.at(time)), (self._left(number), _TITLE))
        draw = ImageDraw.Draw(frame)
        for number, side in enumerate(self._sides):
            if time >= side.end:
                ended = self._view.ended[number].partition(":")[0]
                self._badge(draw, number, f"ended at {side.end:.1f} s{f', {ended}' if ended else ''}", _DIM)
        self._draw_fault(draw, time)
        self._draw_time(draw, time)
        return frame

    def _left(self, number: int) -> int:
        return _MARGIN + number * (self._width + _MARGIN)

    def _fitted(self, image: Image.Image) -> Image.Image:
        """Return a picture of another size, scaled to fit."""
        size = self._width, self._height
        return image if image.size == size else ImageOps.pad(image, size, Image.Resampling.BILINEAR, _GROUND)

    def _draw_titles(self, draw: ImageDraw.ImageDraw) -> None:
        view = self._view
        where = f"{view.test.rpartition('::')[2]}, round {view.round + 1}"
        texts = ("original", where), (f"mutant {view.number}", f"{view.place} · {view.what}")
        for number, (name, more) in enumerate(texts):
            left, big, small = self._left(number), font_of_size(18), font_of_size(14)
            big.draw(draw, (left, 8), name, tuple(COLOURS.values())[number])
            for line, text in enumerate(small.lines(more, self._width - 4, 2)):
                small.draw(draw, (left, 34 + 18 * line), text, _TEXT)

    def _draw_rail(self, draw: ImageDraw.ImageDraw) -> None:
        left, right, y = self._rail
        draw.rectangle((left, y - 3, right, y + 3), fill=_RAIL)
        small = font_of_size(13)
        marks = [(self._view.fault, "fault", _FAULT), (self._view.apart, "apart", _APART)]
        taken = 0.0
        for time, name, colour in sorted(
            (mark for mark in marks if mark[0] is not None), key=lambda mark: mark[0] or 0
        ):
            assert time is not None
            x = self._x(time)
            draw.rectangle((x - 1, y - 8, x + 1, y + 8), fill=colour)
            label = f"{name} {time:.1f} s"
            place = min(max(x - small.width(label) / 2, left, taken), right - small.width(label) - 60)
            small.draw(draw, (place, y + 11), label, colour)
            taken = place + small.width(label) + 10
        small.draw(draw, (right, y + 11), f"{self.end:.1f} s", _DIM, "ra")

    def _draw_time(self, draw: ImageDraw.ImageDraw, time: float) -> None:
        left, _, y = self._rail
        draw.rectangle((left, y - 3, self._x(time), y + 3), fill=_TEXT)
        for moment, colour in ((self._view.fault, _FAULT), (self._view.apart, _APART)):
            if moment is not None:
                x = self._x(moment)
                draw.rectangle((x - 1, y - 8, x + 1, y + 8), fill=colour)
        font_of_size(18).draw(draw, (_MARGIN, y), f"{time:.2f} s", _TEXT, "lm")
        clock = self._view.clock if self.speed == 1.0 else f"{self._view.clock} ×{self.speed:g}"
        font_of_size(13).draw(draw, (_MARGIN, y + 11), clock, _DIM)
        apart = self._view.apart
        if apart is None or time >= apart:
            for number, text in enumerate(self._story):
                font_of_size(15).draw(draw, (_MARGIN, y + 38 + 20 * number), text, _TEXT)

    def _draw_fault(self, draw: ImageDraw.ImageDraw, time: float) -> None:
        fault = self._view.fault
        if fault is None or time < fault:
            return
        left = self._left(1)
        box = left - 4, _TITLE - 4, left + self._width + 3, _TITLE + self._height + 3
        draw.rectangle(box, outline=_FAULT, width=4)
        text, font = f"fault since {fault:.1f} s", font_of_size(15)
        draw.rectangle((left, _TITLE, left + font.width(text) + 16, _TITLE + 26), fill=_FAULT)
        font.draw(draw, (left + 8, _TITLE + 13), text, _GROUND, "lm")

    def _badge(self, draw: ImageDraw.ImageDraw, number: int, text: str, colour: str) -> None:
        left, bottom, font = self._left(number), _TITLE + self._height, font_of_size(15)
        draw.rectangle((left, bottom - 26, left + font.width(text) + 16, bottom), fill=_GROUND)
        font.draw(draw, (left + 8, bottom - 13), text, colour, "lm")

    def _x(self, time: float) -> float:
        left, right, _ = self._rail
        share = min(1.0, time / self.end) if self.end > 0 else 1.0
        found: float = left + (right - left) * share
        return found
