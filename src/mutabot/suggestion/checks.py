"""A check that could be added: what it looks at, what it expects, and whom it would notice."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from .bands import Band, rounded
from .measure import Read
from .readings import Reading
from .styles.choice import style_of
from .styles.style import Addition, Place

#: longest line of a written test
_WIDTH = 100


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
        if not _is_number(found):
            return 0.0
        if self.minus is not None:
            other = read.get(self.minus)
            if not _is_number(other):
                return 0.0
            found -= other
        return abs(found - expected) / self.band.tolerance


@dataclass(frozen=True, eq=False)
class Check:
    """A check at the end of a test.

    Attributes:
        place: the test.
        reading: what it reads.
        expected: what it expects.
        margins: mutant id to round to how far it is outside, in tolerances; only what it would notice.
    """

    place: Place
    reading: Reading
    expected: Expected
    margins: Mapping[str, Mapping[int, float]] = field(default_factory=dict)

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
        return self.reading.text + (f" - {minus}" if minus is not None else "")

    @property
    def wanted(self) -> tuple[str, str | None]:
        """What it expects, as a text of a program, and the tolerance."""
        found = {}
        tolerance = None
        for key, value in self.expected.values.items():
            band = self.expected.band
            found[key], tolerance = (repr(value), None) if band is None else rounded(value, band.tolerance)
        if self.expected.label is None:
            return found[None], tolerance
        inner = ", ".join(f"{_literal(key)}: {text}" for key, text in found.items())
        return f"{{{inner}}}[{self.expected.label}]", tolerance

    @property
    def statement(self) -> str:
        """The assertion in the style of its test."""
        style = style_of(self.place)
        value, tolerance = self.wanted
        value = _literal(next(iter(self.expected.values.values()))) if self._is_plain_text else value
        if tolerance is None:
            return style.equal(self.looked_at, value)
        return style.within(self.looked_at, value, tolerance)

    @property
    def _is_plain_text(self) -> bool:
        only = self.expected.values.get(None)
        return self.expected.band is None and self.expected.label is None and isinstance(only, str)

    @property
    def words(self) -> str:
        """What it looks at, in words that can be a step of a scenario."""
        value, tolerance = self.wanted
        label = self.expected.label
        if label is not None:
            value = f"as its {_said(label)} wants it"
        within = f" within {tolerance}" if tolerance is not None else ""
        return f"{_said(self.looked_at)} is {_said(value)}{within}"

    def addition(self) -> Addition:
        """It as something that is added to a test."""
        statement = self.statement
        names = set(re.findall(r"[^\W\d]\w*", statement))
        return Addition(
            self.place,
            tuple(_folded(statement)),
            self.words,
            tuple(name for name in self.place.names if name in names),
            (*self.reading.needs, *style_of(self.place).needs(statement)),
        )


def _folded(statement: str) -> list[str]:
    return [statement]


def _said(text: str) -> str:
    """An expression in words: ``world()["tool.theta_z"]`` is world tool.theta_z."""
    return re.sub(r"\s+", " ", re.sub(r"[()\[\]\"'{}]+", " ", text).replace(" .", " ")).strip()


def _literal(value: Any) -> str:
    text = repr(value)
    if isinstance(value, str) and '"' not in text and "\\" not in text:
        return f'"{value}"'
    return text


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and value == value
