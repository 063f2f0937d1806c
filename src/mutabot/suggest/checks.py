"""Checks that could be added: what each looks at, what it expects, whom it notices."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from mutabot.model.quantity import step_of

from .bands import Band, band_of, decimal, digits_of, is_number, readable
from .measure import Measured, Read
from .place import Addition, PlaceInTest, equal, within
from .project import ProjectFiles
from .readings import HAND, PROBE, ReadExpression

#: digits of a value above which it is no more than what the original happened to read
_DIGITS = 3
#: steps of a reading that are no difference, where it comes in steps: one up or down
_STEPS = 1.5
_PARTNERS = 8
_NAME = re.compile(r"[^\W\d]\w*")
_LAST = re.compile(r"(\w+)\W*$")
_CLOCK = re.compile(
    r"(?:^|_)(?:time|clock|elapsed|duration|seconds|secs|now|timestamp|ticks?|cycle)(?:_|$)", re.I
)
_PLACE = re.compile(r"(?:^|_)(?:[xyz]|pos|position|place|height|distance|depth|gap|width)(?:_|$)", re.I)
_ANGLE = re.compile(
    r"(?:^|_)(?:angle|theta|yaw|pitch|roll|tilt|heading|rot\w*|r[xyz]|j\d+|q\d*)(?:_|$)", re.I
)


@dataclass(frozen=True, eq=False)
class ProposedCheck:
    """A check at the end of a test.

    Attributes:
        place: the test.
        reading: what it reads.
        value: what that must be: a plain value, or the other reading that it must equal.
        band: how the original spreads; None if both must be equal.
        tolerance: greatest distance; None if both must be equal.
        noticed: mutant id to the rounds in which it is outside.
        runs: how many runs of the original agree.
    """

    place: PlaceInTest
    reading: ReadExpression
    value: Any
    runs: int
    band: Band | None = None
    tolerance: float | None = None
    noticed: Mapping[str, tuple[int, ...]] = field(default_factory=dict)

    @property
    def trials(self) -> frozenset[tuple[str, int]]:
        """The mutants and rounds that it would notice."""
        return frozenset((mutant, round) for mutant, rounds in self.noticed.items() for round in rounds)

    @property
    def worth(self) -> tuple[int, ...]:
        """What a person would rather write: the suite's reader, a relation, a place, few digits."""
        is_relation = isinstance(self.value, ReadExpression)
        number = self.value if is_number(self.value) else 0.0
        return (
            -self.reading.way,
            is_relation,
            -_rank(self.reading),
            -digits_of(number),
            -len(self.statement),
        )

    @property
    def statement(self) -> str:
        """The assertion, in the style of its test."""
        style, text = self.place.style, self.reading.text
        if self.tolerance is None:
            value = self.value.text if isinstance(self.value, ReadExpression) else literal(self.value)
            return equal(style, text, value)
        value = self.value.text if isinstance(self.value, ReadExpression) else decimal(self.value)
        return within(style, text, value, decimal(self.tolerance))

    def addition(self) -> Addition:
        """It as something that is added to a test."""
        names = set(_NAME.findall(self.statement))
        needs = (*self.reading.needs, *(self.value.needs if isinstance(self.value, ReadExpression) else ()))
        approx = ["import pytest"] if "pytest.approx" in self.statement else []
        used = tuple(name for name in self.place.names if name in names)
        return Addition(self.place, (self.statement,), used, (*needs, *approx))


def literal(value: Any) -> str:
    """A value as a text of a program."""
    text = repr(value)
    return f'"{value}"' if isinstance(value, str) and '"' not in text and "\\" not in text else text


def candidates(project: ProjectFiles, measured: Measured) -> tuple[list[ProposedCheck], dict[str, str]]:
    """All checks that would notice a survivor and that a person would merge.

    Beside them, by mutant, what would notice it and is no such check.
    """
    found: list[ProposedCheck] = []
    refused: dict[str, str] = {}
    for place, originals in measured.originals.items():
        mutants, runs = measured.mutants.get(place, {}), list(originals.values())
        if not mutants or not runs:
            continue
        readings = [known(measured, place, text) for text in runs[0] if all(text in read for read in runs)]
        given = [one for one in readings if _is_given(one.text, originals, mutants)]
        suite = _tolerances(project, place)
        for reading in readings:
            for check in _of(place, reading, given, runs, mutants, suite):
                why = _why_not(project, check)
                if why is None:
                    found.append(check)
                else:
                    refused.update(dict.fromkeys(check.noticed, why))
    return found, refused


def known(measured: Measured, place: PlaceInTest, text: str) -> ReadExpression:
    """What is known of a part; one that comes in steps may be a step off where it never was yet."""
    of = [
        one
        for one in measured.readings[place]
        if text == one.text or text.startswith((f"{one.text}.", f"{one.text}["))
    ]
    if of:
        found = replace(max(of, key=lambda one: len(one.text)), text=text)
    else:
        objects = [size for target, size in measured.objects if f".{target.rpartition('.')[2]}" in text]
        coarse = max((one.tolerance for one in measured.readings[place]), default=1e-6)
        root = re.match(r"\w+", text)
        way, tolerance = (PROBE, objects[0]) if objects else (HAND, coarse)
        found = ReadExpression(text, way, tolerance, (), (root[0],) if root else ())
    runs = measured.originals.get(place, {}).values()
    values = {read[text] for read in runs if is_number(read.get(text))}
    step = step_of(values) if len(values) > 1 else None
    return found if step is None else replace(found, tolerance=max(found.tolerance, _STEPS * step))


def _is_given(
    text: str,
    originals: Mapping[tuple[int, str], Read],
    mutants: Mapping[str, Mapping[tuple[int, str], Read]],
) -> bool:
    """Whether a reading belongs to the round and the test, and is nothing that a program did."""
    return all(
        read.get(text) == originals.get(key, {}).get(text)
        for reads in mutants.values()
        for key, read in reads.items()
    )


def _of(
    place: PlaceInTest,
    reading: ReadExpression,
    given: Sequence[ReadExpression],
    runs: Sequence[Read],
    mutants: Mapping[str, Mapping[tuple[int, str], Read]],
    suite: Mapping[str, float],
) -> Iterator[ProposedCheck]:
    """The checks of a reading: that it equals what the test was given, or a value."""
    values = [read[reading.text] for read in runs]
    partners = [one for one in given if one.text != reading.text and _last(one) == _last(reading)]
    for other in [*partners[:_PARTNERS], None]:
        others = [read[other.text] if other is not None else 0.0 for read in runs]
        if not all(is_number(value) for value in (*values, *others)):
            yield from _equal(place, reading, other, values, others, mutants)
            continue
        apart = [value - beside for value, beside in zip(values, others, strict=True)]
        tolerance = max(reading.tolerance, other.tolerance if other is not None else 0.0)
        band = band_of(apart, tolerance)
        away = _away(reading, other, band.middle, mutants)
        outside = [size for by_round in away.values() for size in by_round.values() if size > band.tolerance]
        if not outside:
            continue
        value, wide = readable(band, min(outside), suite.get(_last(reading), 0.0))
        if other is not None and abs(band.middle) > wide - band.tolerance:
            continue  # it is always as far from it, but not there
        noticed = _noticed(_away(reading, other, 0.0 if other is not None else value, mutants), wide)
        if noticed:
            yield ProposedCheck(
                place, reading, value if other is None else other, len(runs), band, wide, noticed
            )


def _away(
    reading: ReadExpression,
    other: ReadExpression | None,
    middle: float,
    mutants: Mapping[str, Mapping[tuple[int, str], Read]],
) -> dict[str, dict[int, float]]:
    """By mutant and round, how far a reading is from what is expected."""
    found: dict[str, dict[int, float]] = {}
    for mutant, reads in mutants.items():
        for (round, _), read in reads.items():
            value, beside = read.get(reading.text), read.get(other.text) if other is not None else 0.0
            if is_number(value) and is_number(beside):
                sizes = found.setdefault(mutant, {})
                sizes[round] = max(sizes.get(round, 0.0), abs(value - beside - middle))
    return found


def _noticed(away: Mapping[str, Mapping[int, float]], tolerance: float) -> dict[str, tuple[int, ...]]:
    found = {
        mutant: tuple(round for round, size in sizes.items() if size > tolerance)
        for mutant, sizes in away.items()
    }
    return {mutant: rounds for mutant, rounds in found.items() if rounds}


def _equal(
    place: PlaceInTest,
    reading: ReadExpression,
    other: ReadExpression | None,
    values: Sequence[Any],
    others: Sequence[Any],
    mutants: Mapping[str, Mapping[tuple[int, str], Read]],
) -> Iterator[ProposedCheck]:
    if other is None and len({repr(value) for value in values}) > 1:
        return
    if other is not None and list(values) != list(others):
        return
    noticed: dict[str, tuple[int, ...]] = {}
    for mutant, reads in mutants.items():
        rounds = tuple(
            round
            for (round, _), read in reads.items()
            if reading.text in read
            and read[reading.text] != (read.get(other.text) if other is not None else values[0])
        )
        if rounds:
            noticed[mutant] = rounds
    if noticed:
        yield ProposedCheck(
            place, reading, values[0] if other is None else other, len(values), noticed=noticed
        )


def _why_not(project: ProjectFiles, check: ProposedCheck) -> str | None:
    """Why a person would not merge it; None if one may."""
    text, name = check.reading.text, _last(check.reading)
    if _CLOCK.search(name) and name not in _compared(project, check.place):
        return f"only its time differs ({text}), and the tests set no deadline"
    if is_number(check.value) and digits_of(float(check.value)) > _DIGITS:
        return f"only an exact value would notice it: {check.statement}"
    return None


def _rank(reading: ReadExpression) -> int:
    name = _last(reading)
    return 0 if _PLACE.search(name) else 1 if _ANGLE.search(name) else 2


def _last(reading: ReadExpression) -> str:
    found = _LAST.search(reading.text)
    return found[1] if found else reading.text


def _compared(project: ProjectFiles, place: PlaceInTest) -> set[str]:
    """The names that the tests compare already."""
    module = project.module(place.file)
    compared = (
        [node for node in ast.walk(module) if isinstance(node, ast.Compare)] if module is not None else []
    )
    return {name for node in compared for name in _NAME.findall(ast.unparse(node))}


def _tolerances(project: ProjectFiles, place: PlaceInTest) -> dict[str, float]:
    """The largest tolerance that the tests state already, by the last name of what they look at."""
    module = project.module(place.file)
    found: dict[str, float] = {}
    for node in ast.walk(module) if module is not None else ():
        looked, stated = None, None
        match node:
            case ast.Compare(left=left, comparators=[ast.Call(keywords=keywords)]):
                looked, stated = left, next((one.value for one in keywords if one.arg == "abs"), None)
            case ast.Call(args=[left, *_], keywords=keywords):
                looked, stated = left, next((one.value for one in keywords if one.arg == "delta"), None)
        if looked is not None and isinstance(stated, ast.Constant) and is_number(stated.value):
            last = _LAST.search(ast.unparse(looked))
            if last:
                found[last[1]] = max(found.get(last[1], 0.0), float(stated.value))
    return found
