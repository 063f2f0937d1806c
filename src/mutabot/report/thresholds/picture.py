"""Thresholds as a picture: a bar per ladder from where no round notices to where all do, on a log scale.

Ladders of a unit share an axis. Left of a bar no round notices, which is the rail; right of it all do, which
is a pale band. A bar is split from top to bottom by how the rounds ended, as many parts as rounds.
Pictures are rectangles and texts in pixels, written as SVG.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path

from mutabot.errors import UsageError
from mutabot.frozen import frozen
from mutabot.report.terminal.console import plural
from mutabot.results.ladders import Above, Ladder, LadderRound
from mutabot.results.thresholds import Thresholds, amount

INK, FAINT, PAPER = "#222222", "#767676", "#ffffff"


@frozen
class Rectangle:
    """A filled rectangle, in pixels from the upper left corner."""

    x: float
    y: float
    width: float
    height: float
    fill: str


@frozen
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


@frozen
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


def check_picture(path: Path) -> None:
    """Raise UsageError for a file that could not be written; said before a campaign rather than after it."""
    if path.suffix.lower() != ".svg":
        raise UsageError(f"{path} is no picture that can be drawn: pictures are SVG; write {_svg_name(path)}")
    if path.is_dir() or not path.parent.is_dir():
        what = "a folder is" if path.is_dir() else "there is no folder"
        raise UsageError(
            f"the picture {path} cannot be written: {what} {path if path.is_dir() else path.parent}"
        )


def write_drawing(picture: Picture, path: Path, *, by: str) -> None:
    """Write a drawing, which says by which command. Raises UsageError if the file cannot be written."""
    try:
        path.write_text(svg(picture, by), encoding="utf-8")
    except OSError as error:
        raise UsageError(f"the picture {path} cannot be written: {error.strerror}") from error


def _svg_name(path: Path) -> Path:
    return path.with_suffix(".svg") if path.name else Path("ends.svg")


_WIDTH, _MARGIN, _LABELS, _ENDS = 1200, 20, 400, 150
_ROW, _BAR, _HEAD, _PANEL, _AXIS = 24, 14, 76, 34, 30
_INK, _FAINT, _PAPER, _RAIL, _GRID = "#222222", "#6b6b6b", "#ffffff", "#b8bcc2", "#e6e8eb"
#: letters that find room beside the bars
_LETTERS = 58
#: as far left of the smallest magnitude as bars begin that have no lower end, in decades
_BEFORE, _AFTER = 0.3, 0.12
#: how a round ended: colour, pale colour behind the bar, and name; those of the families' picture
_KINDS: dict[str, tuple[str, str, str]] = {
    "check": ("#1b7837", "#d3ead8", "noticed by a check"),
    "exception": ("#7fbf7b", "#e4f3e2", "by an exception"),
    "timeout": ("#d9c84a", "#f6f1cf", "by a time-out"),
    "refused": ("#2f6fb0", "#d4e3f2", "the robot refuses"),
    "missed": ("#c51b29", "#f7d9db", "not noticed up to the largest"),
    "nothing": ("#8d8d8d", "#e8e8e8", "no effect above"),
}


def picture_of(thresholds: Thresholds) -> Picture:
    """All ladders of which something is known, in their order, a panel for each unit."""
    panels: dict[str, list[Ladder]] = {}
    for one in thresholds.ladders:
        panels.setdefault(one.unit or "", []).append(one)
    shapes: list[Rectangle | Words] = []
    y = float(_HEAD)
    for unit, ladders in panels.items():
        shapes += _panel(unit, ladders, y)
        y += _PANEL + len(ladders) * _ROW + _AXIS
    height = round(y + _MARGIN / 2)
    title = f"From which magnitude on the tests notice, over {plural(thresholds.rounds, 'round')}"
    head = [
        Rectangle(0, 0, _WIDTH, height, _PAPER),
        Words(_MARGIN, 30, title, 17, bold=True),
        *_legend(thresholds.ladders),
    ]
    shapes = [*head, *shapes]
    boxes = [shape for shape in shapes if isinstance(shape, Rectangle)]
    return Picture(_WIDTH, height, boxes, [shape for shape in shapes if isinstance(shape, Words)])


def kind_of(one: LadderRound) -> str:
    """How a round ended: who notices, or why nobody does."""
    if one.noticed_by is not None:
        return one.noticed_by
    return {Above.REFUSED: "refused", Above.NO_EFFECT: "nothing"}.get(one.above, "missed")


class _Scale:
    """Where magnitudes stand, in pixels, on a log scale."""

    def __init__(self, ladders: Sequence[Ladder]) -> None:
        sizes = [size for one in ladders for size in one.sizes]
        self.low, self.high = math.log10(min(sizes)) - _BEFORE, math.log10(max(sizes)) + _AFTER
        self.ticks = sorted({size for size in sizes if _is_round(size)})

    def at(self, magnitude: float) -> float:
        left, right = _LABELS, _WIDTH - _ENDS
        if magnitude <= 0.0:
            return left
        if math.isinf(magnitude):
            return right
        share = (math.log10(magnitude) - self.low) / (self.high - self.low)
        return left + share * (right - left)


def _is_round(size: float) -> bool:
    """Whether a magnitude is one of 1, 2, 5, 10 …, so that it is worth a line."""
    return any(math.isclose(size / 10 ** math.floor(math.log10(size) + 1e-9), one) for one in (1, 2, 5))


def _panel(unit: str, ladders: Sequence[Ladder], y: float) -> Iterator[Rectangle | Words]:
    scale = _Scale(ladders)
    top = y + _PANEL
    bottom = top + len(ladders) * _ROW
    for tick in _apart(scale):
        yield Rectangle(scale.at(tick) - 0.5, top - 4, 1, bottom - top + 4, _GRID)
        yield Words(scale.at(tick), bottom + 14, amount(tick, unit or None), 11, "middle", _FAINT)
    yield Words(_MARGIN, y + 22, f"in {unit}" if unit else "without a unit", 13, bold=True)
    for index, ladder in enumerate(ladders):
        yield from _row(ladder, scale, top + index * _ROW)


def _apart(scale: _Scale) -> Iterator[float]:
    """Ticks whose labels do not touch."""
    last = -math.inf
    for tick in scale.ticks:
        if scale.at(tick) - last >= 46:
            last = scale.at(tick)
            yield tick


def _row(ladder: Ladder, scale: _Scale, y: float) -> Iterator[Rectangle | Words]:
    top, middle = y + (_ROW - _BAR) / 2, y + _ROW / 2
    yield Words(_LABELS - 10, middle + 4, _label(ladder), 12, "end")
    smallest, largest = scale.at(ladder.sizes[0]), scale.at(ladder.sizes[-1])
    yield Rectangle(smallest, middle - 1, largest - smallest, 2, _RAIL)
    kinds = Counter(kind_of(one) for one in ladder.counted)
    ordered = [kind for kind in _KINDS if kinds[kind]]
    left, right = scale.at(ladder.none_up_to), scale.at(ladder.all_from)
    if math.isfinite(ladder.all_from) and largest > right:
        yield Rectangle(right, top, largest - right, _BAR, _KINDS[ordered[0]][1])
    before = 0.0
    for kind in ordered:
        share = kinds[kind] / len(ladder.counted)
        yield Rectangle(left, top + before * _BAR, right - left, share * _BAR, _KINDS[kind][0])
        before += share
    yield Words(_WIDTH - _ENDS + 10, middle + 4, _ends(ladder), 12, fill=_FAINT)


def _label(ladder: Ladder) -> str:
    """The place and the name, cut where they have no room: the middle of a path tells least."""
    text = f"{ladder.place} {ladder.name}"
    if len(text) <= _LETTERS:
        return text
    text = f"{ladder.place.rpartition('/')[2]} {ladder.name}"
    return text if len(text) <= _LETTERS else f"…{text[-_LETTERS + 1 :]}"


def _ends(ladder: Ladder) -> str:
    low = amount(ladder.none_up_to, ladder.unit) if ladder.none_up_to else ""
    if math.isinf(ladder.all_from):
        return f"above {low}" if low else "not in all"
    return f"{low} to {amount(ladder.all_from, ladder.unit)}".removeprefix(" ")


def _legend(ladders: Sequence[Ladder]) -> Iterator[Rectangle | Words]:
    occurring = {kind_of(one) for ladder in ladders for one in ladder.counted}
    x = float(_MARGIN)
    for kind, (colour, _, name) in _KINDS.items():
        if kind in occurring:
            yield Rectangle(x, 46, 14, 14, colour)
            yield Words(x + 20, 58, name, 12)
            x += 34 + 6.6 * len(name)
    yield Rectangle(x, 52, 24, 2, _RAIL)
    yield Words(x + 30, 58, "tried; no round notices left of a bar, all do right of it", 12, fill=_FAINT)
