"""Pictures of rectangles and texts in pixels, written as SVG."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

INK, FAINT, PAPER = "#222222", "#767676", "#ffffff"


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A filled rectangle, in pixels from the upper left corner."""

    x: float
    y: float
    width: float
    height: float
    fill: str


@dataclass(frozen=True, slots=True)
class Words:
    """A line of text.

    Attributes:
        x, y: where its base line begins, ends or has its middle, in pixels.
        anchor: ``start``, ``middle`` or ``end``.
        size: height of the letters in pixels.
    """

    x: float
    y: float
    text: str
    size: float = 13.0
    anchor: str = "start"
    fill: str = INK
    bold: bool = False


@dataclass(frozen=True, slots=True)
class Picture:
    """A drawing in pixels."""

    width: int
    height: int
    boxes: Sequence[Rectangle]
    words: Sequence[Words]


def svg(picture: Picture, by: str) -> str:
    """The picture as a file of its own, which says which command wrote it."""
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{picture.width}" height="{picture.height}" '
        f'viewBox="0 0 {picture.width} {picture.height}" font-family="Helvetica, Arial, sans-serif">',
        f"<!-- written by {by} -->",
        *map(_svg_of_box, picture.boxes),
        *map(_svg_of_words, picture.words),
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def _svg_of_box(box: Rectangle) -> str:
    place = f'x="{box.x:.1f}" y="{box.y:.1f}" width="{box.width:.1f}" height="{box.height:.1f}"'
    return f'<rect {place} fill="{box.fill}"/>'


def _svg_of_words(words: Words) -> str:
    weight = ' font-weight="bold"' if words.bold else ""
    look = f'font-size="{words.size:g}" text-anchor="{words.anchor}" fill="{words.fill}"{weight}'
    return f'<text x="{words.x:.1f}" y="{words.y:.1f}" {look}>{escape(words.text)}</text>'
