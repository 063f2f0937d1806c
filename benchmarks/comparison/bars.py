"""Stacked bars of the ends of each family."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from mutabot.errors import plural

from .drawing import FAINT, INK, PAPER, Picture, Rectangle, Words
from .ends import End
from .families import Family

_WIDTH, _MARGIN, _LABELS = 860, 20, 165
_BAR, _GAP, _HEAD, _LEGEND_ROW, _LEGEND_COLUMNS = 34, 20, 52, 22, 3
#: pixels that a percentage needs
_ROOM = 34
#: dark and light beside each other, so that the parts can be told apart without colour
COLOURS: Mapping[End, str] = {
    End.CHECK: "#1b7837",
    End.EXCEPTION: "#7fbf7b",
    End.TIMEOUT: "#d9c84a",
    End.SURVIVED: "#c51b29",
    End.NOT_COVERED: "#f4a582",
    End.INDISTINGUISHABLE: "#8d8d8d",
    End.NO_EFFECT: "#d0d0d0",
    End.REFUSED: "#2f6fb0",
    End.GUARDED: "#1b4f8f",
    End.BEFORE: "#9ecae1",
    End.INVALID: "#3f3a6b",
    End.UNSTABLE: "#c994c7",
    End.ERROR: "#000000",
}


@dataclass(frozen=True, slots=True)
class FamilyBar:
    """What one bar shows: its name, a line below it, and the number of outcomes of each end."""

    name: str
    note: str
    counts: Mapping[End, int]


def bar_of(family: Family) -> FamilyBar:
    """The bar of a family."""
    counts = {end: share.count for end, share in family.ends.items()}
    return FamilyBar(family.name, f"{family.role} · {plural(family.mutants, 'mutant')}", counts)


def picture_of(bars: Sequence[FamilyBar], title: str) -> Picture:
    """Bars below each other, each as long as all its outcomes, and a legend of the ends that occur."""
    below = _HEAD + len(bars) * (_BAR + _GAP)
    occurring = [end for end in End if any(bar.counts.get(end) for bar in bars)]
    rows = -(-len(occurring) // _LEGEND_COLUMNS)
    height = below + 20 + rows * _LEGEND_ROW + _MARGIN // 2
    shapes = [
        Rectangle(0, 0, _WIDTH, height, PAPER),
        Words(_MARGIN, 30, title, 16, bold=True),
        Words(_WIDTH - _MARGIN, 30, "share of outcomes, over all rounds", 11, "end", FAINT),
        *(shape for index, bar in enumerate(bars) for shape in _bar(bar, _HEAD + index * (_BAR + _GAP))),
        *(Words(_at(n / 4), below, f"{25 * n} %", 11, "middle", FAINT) for n in range(5)),
        *_legend(occurring, below + 20),
    ]
    boxes = [shape for shape in shapes if isinstance(shape, Rectangle)]
    return Picture(_WIDTH, height, boxes, [shape for shape in shapes if isinstance(shape, Words)])


def bars_of(families: Iterable[Family]) -> list[FamilyBar]:
    """One bar per family and role."""
    return [bar_of(family) for family in families]


def _at(share: float) -> float:
    return _LABELS + share * (_WIDTH - _LABELS - _MARGIN - 10)


def _legend(ends: Sequence[End], y: float) -> Iterator[Rectangle | Words]:
    for index, end in enumerate(ends):
        row, column = divmod(index, _LEGEND_COLUMNS)
        x = _MARGIN + column * (_WIDTH - 2 * _MARGIN) / _LEGEND_COLUMNS
        yield Rectangle(x, y + row * _LEGEND_ROW, 14, 14, COLOURS[end])
        yield Words(x + 20, y + row * _LEGEND_ROW + 12, end.value)


def _bar(bar: FamilyBar, y: float) -> Iterator[Rectangle | Words]:
    yield Words(_MARGIN, y + 15, bar.name, bold=True)
    yield Words(_MARGIN, y + 31, bar.note, 11, fill=FAINT)
    total = sum(bar.counts.values())
    if not total:
        yield Words(_LABELS, y + _BAR / 2 + 5, "nothing was run", fill=FAINT)
        return
    before = 0
    for end in End:
        count = bar.counts.get(end, 0)
        left, right = _at(before / total), _at((before + count) / total)
        before += count
        if count:
            yield Rectangle(left, y, right - left, _BAR, COLOURS[end])
        if right - left >= _ROOM:
            text = f"{100 * count / total:.0f} %"
            yield Words((left + right) / 2, y + _BAR / 2 + 4, text, 12, "middle", legible(COLOURS[end]))


def legible(colour: str) -> str:
    """Black or white, whichever is easier to read on this colour."""
    red, green, blue = (int(colour[start : start + 2], 16) for start in (1, 3, 5))
    return INK if 0.299 * red + 0.587 * green + 0.114 * blue > 150 else PAPER
