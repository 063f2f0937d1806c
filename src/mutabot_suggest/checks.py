"""Candidate checks: what each reads and expects, and which mutants it notices.

A check holds for all runs of the original: it allows a band around them, and is written as a person writes.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import Any

from .project import Addition, PlaceInTest, SuiteFiles, equal, function_of, text_of, within
from .readings import ORACLE, Measured, ReadExpression, ValuesRead, is_number, known

CONFIDENCE = 0.95
#: digits of a value, down to its tolerance, above which it is no more than what the original happened to read
_DIGITS = 3
_PARTNERS = 8
_NAME = re.compile(r"[^\W\d]\w*")
_LAST = re.compile(r"(\w+)\W*$")
_CLOCK = re.compile(
    r"(?:^|_)(?:time|clock|elapsed|duration|seconds|secs|now|timestamp|ticks?|cycle)(?:_|$)", re.I
)
#: names of what a person would rather look at, the best first
_RANKS = (
    re.compile(r"(?:^|_)(?:[xyz]|pos|pose|position|place|height|distance|depth|gap|width)s?(?:_|$)", re.I),
    re.compile(
        r"(?:^|_)(?:angle|theta|yaw|pitch|roll|tilt|heading|joint|rot\w*|r[xyz]|j\d+|q\d*)s?(?:_|$)", re.I
    ),
)

#: what mutants made tests read: per mutant id, by (round, node id)
MutantReadings = Mapping[str, Mapping[tuple[int, str], ValuesRead]]
#: mutant ids, each with a round
Trials = frozenset[tuple[str, int]]


@dataclass(frozen=True, slots=True)
class Band:
    """The range in which a reading of the original stays.

    Attributes:
        middle: of all runs.
        tolerance: to each side of the middle, the least that a check may ask for.
        spread: the greatest distance of two runs.
    """

    middle: float
    tolerance: float
    spread: float


def band_of(values: Sequence[float], floor: float) -> Band:
    """The range of the runs, widened by itself on both sides; ``floor`` is the least tolerance.

    No distribution is assumed. Of a normal one with 20 runs, fewer than 1 in 100 000 lie outside.
    """
    low, high = min(values), max(values)
    return Band((low + high) / 2, max(floor, 1.5 * (high - low)), high - low)


def unseen(count: int) -> float:
    """The share of runs in which something may happen that did not in ``count``, with ``CONFIDENCE``."""
    return 1 - (1 - CONFIDENCE) ** (1 / count) if count else 1.0


def readable(band: Band, nearest: float, stated: float = 0.0) -> tuple[float, float]:
    """Round a value and its tolerance as a person would.

    The tolerance is the one that the tests state already, if it lies between the band's and ``nearest``, the
    least distance of a survivor from the middle; else the largest of 1, 2, 5, 10 … that is at most half of
    ``nearest``, never under the band's. The value has no more digits than that needs, but a short one stays.
    """
    tolerance = stated if band.tolerance <= stated < nearest else _round_up(band.tolerance)
    while tolerance != stated and _round_up(tolerance * 1.5) <= nearest / 2:
        tolerance = _round_up(tolerance * 1.5)
    digits = -math.floor(math.log10(tolerance) + 1e-9)
    value = band.middle if digits_of(band.middle) < _DIGITS else round(band.middle, digits)
    while abs(value - band.middle) + band.tolerance > tolerance * (1 + 1e-9) and digits < 12:
        digits += 1
        value = round(band.middle, digits)
        if abs(value - band.middle) <= 0.01 * tolerance:
            break
    return value + 0.0, tolerance


def _round_up(size: float) -> float:
    step = 10.0 ** math.floor(math.log10(size))
    factor = next(one for one in (1, 2, 5, 10) if one * step >= size * (1 - 1e-9))
    return float(f"{factor * step:.1g}")


def digits_of(value: float) -> int:
    """How many digits a person must read."""
    return len(f"{value!r}".partition("e")[0].replace(".", "").strip("-0")) if value else 1


def precision_of(value: float, tolerance: float) -> int:
    """How many digits of a value a check asks for, down to that of its tolerance; zero counts like 0.1."""
    return math.floor(math.log10(abs(value) or 0.1)) - math.floor(math.log10(tolerance) + 1e-9) + 1


@dataclass(frozen=True, eq=False)
class ProposedCheck:
    """A check at the end of a test.

    Attributes:
        place: the test.
        reading: what it reads.
        value: what that must be: a plain value, or the other reading that it must equal.
        runs: how many runs of the original agree.
        spread: how far these are apart; None if both must be equal.
        tolerance: greatest distance; None if both must be equal.
        trials: the mutants and rounds that it would notice.
        is_clear: whether all of these are far off: ten times what the original may be.
        is_exact: whether it asks for more digits than the suite justifies.
        alike: how much its reading has in common with what its test looks at already.
    """

    place: PlaceInTest
    reading: ReadExpression
    value: Any
    runs: int
    spread: float | None = None
    tolerance: float | None = None
    trials: Trials = frozenset()
    is_clear: bool = True
    is_exact: bool = False
    alike: int = 0

    @property
    def worth(self) -> tuple[int, ...]:
        """What a person would rather write: the suite's reader, a relation, a place, few digits."""
        name = _last(self.reading.text)
        rank = next((rank for rank, names in enumerate(_RANKS) if names.search(name)), len(_RANKS))
        digits = digits_of(self.value) if is_number(self.value) else 1
        is_relation = isinstance(self.value, ReadExpression)
        kind = -self.reading.way, is_relation, -rank, self.is_clear
        return *kind, -digits, self.alike, -len(self.statement)

    @property
    def statement(self) -> str:
        """The assertion, in the style of its test."""
        style, text = self.place.style, self.reading.text
        other = self.value.text if isinstance(self.value, ReadExpression) else None
        if self.tolerance is None:
            return equal(style, text, other or text_of(ast.Constant(self.value)))
        return within(style, text, other or repr(float(self.value)), repr(self.tolerance))

    def addition(self) -> Addition:
        """The check as an addition to a test."""
        names = set(_NAME.findall(self.statement))
        needs = (*self.reading.needs, *(self.value.needs if isinstance(self.value, ReadExpression) else ()))
        approx = ["import pytest"] if "pytest.approx" in self.statement else []
        used = tuple(name for name in self.place.names if name in names)
        return Addition(self.place, (self.statement,), used, (*needs, *approx))


def candidates(project: SuiteFiles, measured: Measured) -> tuple[list[ProposedCheck], dict[str, str]]:
    """Return the checks that would notice a survivor and that a person would merge.

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
        module = project.module(place.file)
        compared, stated = _stated(module)
        beside, own = _stated(function_of(module, place))
        usual = max(own.values()) if len(set(own.values())) == 1 else 0.0
        readings = [replace(one, way=ORACLE) if one.text in compared else one for one in readings]
        seen = _ReadAtEnd(place, runs, mutants, given, stated, usual)
        for check in (check for reading in readings for check in seen.checks(reading)):
            why = _why_not(check, seen.allowed(check.reading.text))
            if why is None:
                starts = accumulate(check.reading.text)
                common = (any(one.startswith(start) for one in beside) for start in starts)
                found.append(replace(check, alike=sum(common)))
            else:
                for mutant, _ in check.trials:  # a clock is the reason only where there is no other
                    refused[mutant] = refused.get(mutant, why) if is_clock(check.reading.text) else why
    return found, refused


def _is_given(text: str, originals: Mapping[tuple[int, str], ValuesRead], mutants: MutantReadings) -> bool:
    """Whether a reading belongs to the round and the test, and is nothing that a program did."""
    return all(
        read.get(text) == originals.get(key, {}).get(text)
        for reads in mutants.values()
        for key, read in reads.items()
    )


@dataclass(frozen=True, slots=True)
class _ReadAtEnd:
    """The readings at the end of a test.

    Attributes:
        place: the test.
        runs: what the original read, in each run.
        mutants: what mutants made it read.
        given: the readings of what the test was given.
        stated: the largest tolerance that the tests state, by the last name of what they look at, and by
            all of it with an equals sign before it.
        usual: the one tolerance that this test states, which then holds for other places too; or 0.
    """

    place: PlaceInTest
    runs: Sequence[ValuesRead]
    mutants: MutantReadings
    given: Sequence[ReadExpression]
    stated: Mapping[str, float]
    usual: float = 0.0

    def checks(self, reading: ReadExpression) -> Iterator[ProposedCheck]:
        """The checks of a reading: that it equals what the test was given, or a value."""
        text = reading.text
        partners = [one for one in self.given if _are_related(one, reading, self.runs[0])]
        for other in [*partners[:_PARTNERS], None]:
            texts = [text] if other is None else [text, other.text]
            values = [read[one] for read in self.runs for one in texts]
            are_counts = all(isinstance(value, int) for value in values) and len(set(values)) == 1
            is_near = all(is_number(value) for value in values)
            is_near &= not are_counts or (_last(text) in self.stated and not text.startswith("len("))
            check = self._near(reading, other) if is_near else self._equal(reading, other)
            if check is not None and check.trials:
                yield check

    def allowed(self, text: str) -> float:
        """The tolerance that the tests state for what a reading reads, under whatever name."""
        reads = [*self.runs, *(read for found in self.mutants.values() for read in found.values())]
        names = (name for name in self.stated if name.startswith("="))
        same = (name for name in names if all(read.get(name[1:]) == read.get(text) for read in reads))
        return max((self.stated[name] for name in {*same, f"={text}"} if name in self.stated), default=0.0)

    def _near(self, reading: ReadExpression, other: ReadExpression | None) -> ProposedCheck | None:
        """The check that a number is near another reading, or near a value."""

        def apart(read: ValuesRead) -> float:
            value, beside = read.get(reading.text), read.get(other.text) if other is not None else 0.0
            return value - beside if is_number(value) and is_number(beside) else math.nan

        floor = max(reading.tolerance, other.tolerance if other is not None else 0.0)
        band = band_of([apart(read) for read in self.runs], floor)
        sizes = self._furthest(lambda read: abs(apart(read) - band.middle))
        outside = sorted({size for size in sizes.values() if size > band.tolerance})
        if not outside:
            return None
        name = _last(reading.text)
        stated = self.stated.get(name, self.usual if _RANKS[0].search(name) else 0.0)
        written = [(size, *readable(band, size, stated)) for size in outside]
        # let through what only many digits would notice, or less than the tests allow, if there are others
        own, size = self.allowed(reading.text), float(self.runs[0][reading.text])

        def is_exact(value: float, wide: float) -> bool:
            digits = max(digits_of(value), precision_of(value if other is None else size, wide))
            return digits > _DIGITS and not 0 < stated <= wide

        fitting = (one for one in written if not is_exact(*one[1:]) and one[2] >= own)
        nearest, value, wide = next(fitting, written[0])
        if other is not None and abs(band.middle) > wide - band.tolerance:
            return None  # it is always as far from it, but not there
        middle = 0.0 if other is not None else value
        trials = _beyond(self._furthest(lambda read: abs(apart(read) - middle)), wide)
        expected = value if other is None else other
        is_clear = nearest >= 10 * band.tolerance
        exact = is_exact(value, wide)
        return ProposedCheck(
            self.place, reading, expected, len(self.runs), band.spread, wide, trials, is_clear, exact
        )

    def _equal(self, reading: ReadExpression, other: ReadExpression | None) -> ProposedCheck | None:
        """The check that something equals another reading, or a value; None if it does not always do so."""
        text, first = reading.text, self.runs[0][reading.text]

        def expected(read: ValuesRead) -> Any:
            return read.get(other.text) if other is not None else first

        if any(repr(read[text]) != repr(expected(read)) for read in self.runs):
            return None
        differing = self._furthest(lambda read: text in read and bool(read[text] != expected(read)))
        value = first if other is None else other
        return ProposedCheck(self.place, reading, value, len(self.runs), trials=_beyond(differing, 0.0))

    def _furthest(self, away: Callable[[ValuesRead], float]) -> dict[tuple[str, int], float]:
        """By mutant and round, how far its readings are from what is expected at most."""
        found: dict[tuple[str, int], float] = {}
        for mutant, reads in self.mutants.items():
            for (round, _), read in reads.items():
                size, before = away(read), found.get((mutant, round), 0.0)
                found[mutant, round] = size if size > before else before
        return found


def _beyond(sizes: Mapping[tuple[str, int], float], tolerance: float) -> Trials:
    return frozenset(trial for trial, size in sizes.items() if size > tolerance)


def _why_not(check: ProposedCheck, own: float) -> str | None:
    """Why a person would not merge it, if the tests state the tolerance ``own`` for it; None if one may."""
    text = check.reading.text
    if is_clock(text):
        return clock_text(text)
    if check.tolerance is not None and check.tolerance < own:
        return f"{text} differs by less than the tests allow: {own!r}"
    if check.is_exact:
        return f"only an exact value would notice it: {check.statement}"
    return None


def is_clock(text: str) -> bool:
    """Whether a reading is a time, by its name: where it differs, the same may only have happened later."""
    return _CLOCK.search(_last(text)) is not None


def clock_text(text: str) -> str:
    """Describe a survivor that differs only in a time."""
    return f"at the ends of its tests only the clock differs ({text}): add a deadline if the task has one"


def _are_related(one: ReadExpression, other: ReadExpression, read: ValuesRead) -> bool:
    """Whether two readings are the same part of two things: of one name, or of lists that are all equal."""
    if _LAST.findall(one.text) != _LAST.findall(other.text):
        return False
    first, second = _NAME.findall(one.text), _NAME.findall(other.text)
    if first[-1] == second[-1]:
        return first != second
    names = [each.text.rpartition("[")[0] for each in (one, other)]
    mine, others = ([read[text] for text in read if text.startswith(f"{name}[")] for name in names)
    wide = max(one.tolerance, other.tolerance)
    near = (is_number(a) and is_number(b) and abs(a - b) <= wide for a, b in zip(mine, others, strict=False))
    return len(set(mine)) > 1 and len(mine) == len(others) and all(near)  # lists of zeros say nothing


def _last(text: str) -> str:
    """The last name in it, of what may be a list: ``places`` of ``places[0][2]``."""
    return str([text, *_NAME.findall(text)][-1])


def _stated(module: ast.AST | None) -> tuple[set[str], dict[str, float]]:
    """What tests compare, and the largest tolerances that they state, as in ``_ReadAtEnd``."""
    compared: set[str] = set()
    tolerances: dict[str, float] = {}
    for node in ast.walk(module) if module is not None else ():
        if isinstance(node, ast.Compare):
            compared.update(text_of(one) for one in ast.walk(node) if isinstance(one, ast.expr))
        match node:
            case ast.Compare(left=looked, comparators=[ast.Call(keywords=keywords)]):
                allowed = [one.value for one in keywords if one.arg == "abs"]
            case ast.Compare(
                left=ast.Call(
                    func=ast.Name(id="abs"), args=[ast.BinOp(left=looked, op=ast.Sub() | ast.Add())]
                ),
                comparators=[ast.Constant() as most],
            ):
                allowed = [most]
            case ast.Call(args=[looked, *_], keywords=keywords):
                allowed = [one.value for one in keywords if one.arg == "delta"]
            case _:
                continue
        text = text_of(looked)
        sizes = [one.value for one in allowed if isinstance(one, ast.Constant)]
        for size in (float(size) for size in sizes if is_number(size)):
            for name in (f"={text}", _last(text)):
                tolerances[name] = max(tolerances.get(name, 0.0), size)
    return compared, tolerances
