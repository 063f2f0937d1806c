"""A picture as PNG, drawn by Pillow, which brings a typeface of its own: no browser, no fonts, no screen."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.errors import UsageError

from .picture import MARK, Picture, Words

if TYPE_CHECKING:
    from PIL import ImageDraw

#: pixels of the file per pixel of the drawing
_SCALE = 2
_ANCHORS = {"start": "ls", "middle": "ms", "end": "rs"}


def require_png() -> None:
    """Raise UsageError if PNG files cannot be written here."""
    if find_spec("PIL") is None:
        raise UsageError("PNG needs Pillow, which is not installed: `pip install pillow`; SVG needs nothing")


def write_png(picture: Picture, path: Path) -> None:
    """Write the picture, twice as large as it is drawn."""
    from PIL import Image, ImageDraw, PngImagePlugin  # noqa: PLC0415  # optional, and slow to import

    image = Image.new("RGB", (picture.width * _SCALE, picture.height * _SCALE))
    canvas = ImageDraw.Draw(image)
    for box in picture.boxes:
        corners = (box.x, box.y, box.x + box.width, box.y + box.height)
        left, top, right, bottom = (round(number * _SCALE) for number in corners)
        if right > left:
            canvas.rectangle((left, top, right - 1, bottom - 1), fill=box.fill)
    for words in picture.words:
        _write(canvas, words)
    information = PngImagePlugin.PngInfo()
    information.add_text("Software", MARK)
    image.save(path, "PNG", optimize=True, pnginfo=information)


def _write(canvas: ImageDraw.ImageDraw, words: Words) -> None:
    from PIL import ImageFont  # noqa: PLC0415  # as above

    font = ImageFont.load_default(words.size * _SCALE)
    canvas.text(
        (words.x * _SCALE, words.y * _SCALE),
        words.text,
        fill=words.fill,
        font=font,
        anchor=_ANCHORS[words.anchor],
        stroke_width=0.4 * _SCALE if words.bold else 0,
        stroke_fill=words.fill,
    )
