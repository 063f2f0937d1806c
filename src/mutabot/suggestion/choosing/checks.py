"""A check that could be added: what it looks at, what it expects, and whom it would notice."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeGuard

from mutabot.suggestion.measuring.measure import Read
from mutabot.suggestion.measuring.readings import WAY, Reading
from mutabot.suggestion.styles.choice import style_of
from mutabot.suggestion.styles.style import Addition, Place

from .bands import Band, decimal

#: longest line that is written where it can be parted
_WIDTH = 90
_NAME = re.compile(r"[^\W\d]\w*")


@dataclass(frozen=True, slots=True)
class Expected:
    """What a reading is held against.

    Attributes:
        values: what is expected: by the label's value, or by None where nothing else decides.
        label: expression by which it is looked up; None if there is one value.
        minus: expression that is taken off before.
        band: how far it may be off; None if it must be equal.
        runs: how many runs of the original agree.
    """

    values: Mapping[Any, Any]
    runs: int
    label: str | None = None
    minus: str | None = None
    band: Band | None = None

    def margin(self, text: str, read: Read) -> float:
        """How far a run is from it, in tolerances: above 1 is outside. 0 where it cannot be told."""
        found = read.get(text)
        key = read.get(self.label) if self.label is not None else None
        if text not in read or (self.label is not None and key not in self.values):
            return 0.0
        expected = self.values[key]
        if self.band is None:
            return 0.0 if found == expected and type(found) is type(expected) else 2.0
        other = read.get(self.minus) if self.minus is not None else 0.0
        if not (is_number(found) and is_number(other)):
            return 0.0
        return float(abs(found - other - expected)) / self.band.tolerance


@dataclass(frozen=True, eq=False)
class Check:
    """A check at the end of a test.

    Attributes:
        place: the test.
        reading: what it reads.
        expected: what it expects.
        margins: mutant id to round to how far it is outside, in tolerances; only what it would notice.
        needs: imports of what it uses beside its reading.
    """

    place: Place
    reading: Reading
    expected: Expected
    margins: Mapping[str, Mapping[int, float]] = field(default_factory=dict)
    needs: tuple[str, ...] = ()

    @property
    def trials(self) -> frozenset[tuple[str, int]]:
        """The mutants and rounds that it would notice."""
        return frozenset((mutant, round) for mutant, rounds in self.margins.items() for round in rounds)

    @property
    def margin(self) -> float:
        """How far outside the least of them is."""
        return min((margin for rounds in self.margins.values() for margin in rounds.values()), default=0.0)

    @property
    def looked_at(self) -> str:
        """The expression that it holds against what it expects."""
        minus = self.expected.minus
        return self.reading.expression + (f" - {minus}" if minus is not None else "")

    @property
    def lines(self) -> tuple[str, ...]:
        """It in the style of its test: the assertion is the last of them."""
        style = style_of(self.place)
        band, label = self.expected.band, self.expected.label
        texts = {key: self._text(value) for key, value in self.expected.values.items()}
        head: tuple[str, ...] = ()
        value = "expected"
        if label is None:
            value = texts[None]
        else:
            head = _looked_up([f"{literal(key)}: {text}" for key, text in texts.items()], label)
        if band is None:
            return *head, style.equal(self.looked_at, value)
        return *head, style.within(self.looked_at, value, decimal(band.tolerance))

    @property
    def statement(self) -> str:
        """The assertion."""
        return self.lines[-1]

    def _text(self, value: Any) -> str:
        if self.reading.way == WAY and self.expected.band is None:
            return str(value)  # a list, as it was noted
        return decimal(value) if self.expected.band is not None else literal(value)

    @property
    def words(self) -> str:
        """What it looks at, in words that can be a step of a scenario."""
        expected = self.expected
        of = f"what {said(expected.label)} asks for" if expected.label is not None else None
        what = said(self.looked_at)
        if self.reading.watch is not None:
            what = said(f"{self.reading.text} on the way".replace("args[0].", "").removeprefix("all "))
        if expected.band is None:
            return f"{what} is {of or said(self._text(expected.values[None]))}"
        near = of or self._text(expected.values[None])
        return f"{what} is within {decimal(expected.band.tolerance)} of {near}"

    def addition(self) -> Addition:
        """It as something that is added to a test."""
        names = set(_NAME.findall(" ".join(self.lines)))
        return Addition(
            self.place,
            self.lines,
            self.words,
            tuple(name for name in self.place.names if name in names),
            (*self.reading.needs, *self.needs, *style_of(self.place).needs(self.statement)),
            self.reading.watch,
        )


def _looked_up(pairs: list[str], label: str) -> tuple[str, ...]:
    """What is expected by a label, in one line or in one per value."""
    line = f"expected = {{{', '.join(pairs)}}}[{label}]"
    if len(line) <= _WIDTH:
        return (line,)
    return "expected = {", *(f"    {pair}," for pair in pairs), f"}}[{label}]"


def said(text: str) -> str:
    """An expression in words: ``world()["tool.theta_z"]`` is world tool.theta_z."""
    return re.sub(r"\s+", " ", re.sub(r"[()\[\]\"'{}]+", " ", text).replace(" .", " ")).strip()


def literal(value: Any) -> str:
    """A value as a text of a program."""
    text = repr(value)
    if isinstance(value, str) and '"' not in text and "\\" not in text:
        return f'"{value}"'
    return text


def is_number(value: Any) -> TypeGuard[float]:
    """Whether a value is one that can be near another."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
