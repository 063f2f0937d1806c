"""Text in pictures, with the fonts that the machine has."""

from __future__ import annotations

import unicodedata
from bisect import bisect_right
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from PIL import ImageDraw, ImageFont

#: fonts with the signs of units and of mathematics, which most systems have one of
_FONTS = ("DejaVuSans.ttf", "NotoSans-Regular.ttf", "LiberationSans-Regular.ttf", "Arial.ttf")
#: letters that are looked at to see what finds room
_LONGEST = 600
#: what stands for signs that other fonts lack
_SPOKEN = {
    "→": "to",
    "−": "-",
    "×": "x",
    "µ": "u",
    "θ": "theta",
    "≥": ">=",
    "≤": "<=",
    "–": "-",
    "…": "...",
    "·": "-",
    "°": " deg",
    "±": "+-",
}


@dataclass(frozen=True)
class Font:
    """A font in one size.

    Attributes:
        is_whole: whether it has more than the letters of English.
    """

    font: ImageFont.FreeTypeFont | ImageFont.ImageFont
    is_whole: bool

    def width(self, text: str) -> float:
        """Return the width of a text, in pixels."""
        found: float = self.font.getlength(self.known(text))
        return found

    def draw(
        self,
        onto: ImageDraw.ImageDraw,
        place: tuple[float, float],
        text: str,
        fill: str | tuple[int, ...],
        anchor: str = "la",
    ) -> None:
        """Draw a text; ``anchor`` is Pillow's."""
        onto.text(place, self.known(text), fill=fill, font=self.font, anchor=anchor)

    def lines(self, text: str, width: float, most: int) -> list[str]:
        """Break a text into at most this many lines; the rest is cut, with three dots."""
        lines: list[str] = []
        rest = text[:_LONGEST].split()
        while rest and len(lines) < most:
            count = 1
            while count < len(rest) and self.width(" ".join(rest[: count + 1])) <= width:
                count += 1
            line, rest = " ".join(rest[:count]), rest[count:]
            is_cut = bool(rest) and len(lines) + 1 == most
            lines.append(self._fitted(line, width, is_cut))
        return lines

    def _fitted(self, line: str, width: float, is_cut: bool) -> str:
        if not is_cut and self.width(line) <= width:
            return line
        room = bisect_right(range(len(line)), width, key=lambda count: self.width(f"{line[:count]} …"))
        return f"{line[: max(0, room - 1)].rstrip()} …"

    def known(self, text: str) -> str:
        """Return the text reduced to the characters in the font."""
        return text if self.is_whole else ascii_only(text)


@lru_cache
def font_of_size(size: int) -> Font:
    """Return a font in this size, in pixels."""
    from PIL import ImageFont  # noqa: PLC0415  # an extra

    for name in _FONTS:
        try:
            return Font(ImageFont.truetype(name, size), True)
        except OSError:
            continue
    return Font(ImageFont.load_default(size), False)


def ascii_only(text: str) -> str:
    """Return a text in ASCII, for fonts with hardly any other characters."""
    for sign, spoken in _SPOKEN.items():
        text = text.replace(sign, spoken)
    plain = unicodedata.normalize("NFKD", text)
    return "".join(sign for sign in plain if sign.isascii())
