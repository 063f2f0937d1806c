"""Finds checks for a test's end that would notice survivors: other tests' checks, and checks of readings."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from math import isnan, nan, pi
from typing import Any

from .bands import DIGITS, Band, band_of, digits_of, precision_of, readable
from .checks import (
    ANGLE,
    PLACE,
    CheckAtEnd,
    CheckOfSuite,
    CheckProposal,
    MutantReadings,
    Trials,
    rank_of,
)
from .forms import is_clock, is_number, last_name
from .mocks import CALL
from .project import PlaceInTest, SuiteFiles, function_of
from .readings import ORACLE, Measured, ReadExpression, ValuesRead, is_reading, reading_of
from .stated_bounds import stated_ranges
from .suite import ReusableCheck, SuiteChecks
from .tolerances import StatedTolerance, StatedTolerances, stated_in

_PARTNERS = 8
#: times what the original may be: that far off is no matter of tolerances
_CLEARLY = 10
_NAME = re.compile(r"[^\W\d]\w*")
_ITEM = re.compile(r"\[\d+\]$")
#: what an expression reads of what: ``pose`` and ``.x``
_PART = re.compile(r"(.+?)(\.\w+|\[\d+\])")
_LAST = re.compile(r"(\w+)\W*$")
#: texts in which names are replaced that belong together: ``HOME.x``, ``HOME.y``
_LAST_NAMES = re.compile(r"\.\w+(?=[,)\s])")


def candidates(
    project: SuiteFiles, suite: SuiteChecks, measured: Measured
) -> tuple[list[CheckProposal], dict[str, str]]:
    """Return the checks that would notice a survivor and are written as a person would write them.

    Beside them, by mutant, what would notice it and is no such check.
    """
    found: list[CheckProposal] = []
    refused: dict[str, str] = {}
    ranges = stated_ranges(project)
    everywhere = [read for reads in measured.originals.values() for read in reads.values()]
    for place, originals in measured.originals.items():
        mutants, runs = measured.mutants.get(place, {}), list(originals.values())
        if not mutants or not runs:
            continue
        found += _of_suite(measured.reusable_checks.get(place, []), place, runs, mutants)
        texts = [text for text in runs[0] if is_reading(text) and all(text in read for read in runs)]
        readings = [reading_of(measured, place, text) for text in texts]
        given = [candidate for candidate in readings if _is_input(candidate.text, originals, mutants)]
        module = project.module(place.file)
        compared, stated = stated_in(module)
        stated |= {name: max(size, stated.get(name, 0.0)) for name, size in ranges.items()}
        beside, own = stated_in(function_of(module, place))
        usual = max(own.values()) if len(set(own.values())) == 1 else 0.0
        readings = [
            replace(candidate, way=ORACLE) if candidate.text in compared else candidate
            for candidate in readings
        ]
        limits = StatedTolerances(suite, stated, runs, mutants, everywhere)
        seen = _EndReadings(place, runs, mutants, given, limits, usual, suite)
        for reading in readings:
            refused |= dict(seen.allowed(reading))
        for check in (check for reading in readings for check in seen.checks(reading)):
            why = _why_not(check, seen.limit(check.reading.text).tolerance)
            if why is None:
                starts = accumulate(check.reading.text)
                common = (any(name.startswith(start) for name in beside) for start in starts)
                found.append(replace(check, alike=sum(common)))
            else:
                for mutant, _ in check.trials:  # a clock is the reason only where there is no other
                    refused.setdefault(mutant, why)
                    if refused[mutant] == ONLY_TIME:
                        refused[mutant] = why
    return found, refused


def _of_suite(
    reusable_checks: Sequence[ReusableCheck],
    place: PlaceInTest,
    runs: Sequence[ValuesRead],
    mutants: MutantReadings,
) -> Iterator[CheckOfSuite]:
    """Yield other tests' checks that hold in every run of the original; checks of the same thing together."""
    groups: dict[str, list[tuple[ReusableCheck, str]]] = {}
    for check in reusable_checks:
        if not all(read.get(check.key) is True for read in runs):
            continue
        tolerance = None
        if check.lacks_tolerance and check.near is not None:
            sizes = {read.get(f"{check.near.key}.tolerance") for read in runs}
            tolerance = max(sizes) if all(map(is_number, sizes)) else None  # type: ignore[type-var]
            if tolerance is None:
                continue
        statement = check.written(tolerance)
        name = _LAST_NAMES.sub("", statement) if check.near is not None else statement
        groups.setdefault(name, []).append((check, statement))
    for group in groups.values():
        trials = frozenset(
            (mutant, round)
            for mutant, reads in mutants.items()
            for (round, _), read in reads.items()
            if any(read.get(reusable.key) is False for reusable, _ in group)
        )
        needs = tuple(dict.fromkeys(line for reusable, _ in group for line in reusable.needs))
        texts = tuple(statement for _, statement in group)
        if trials:
            yield CheckOfSuite(place=place, trials=trials, runs=len(runs), needs=needs, statements=texts)


def _is_input(text: str, originals: Mapping[tuple[int, str], ValuesRead], mutants: MutantReadings) -> bool:
    """Return whether a reading equals the original's in all mutants: an input of the round or the test."""
    return all(
        read.get(text) == originals.get(key, {}).get(text)
        for reads in mutants.values()
        for key, read in reads.items()
    )


@dataclass(frozen=True, slots=True)
class _EndReadings:
    """The readings at the end of a test.

    Attributes:
        place: the test.
        runs: what the original read, in each run.
        mutants: what mutants made it read.
        given: the readings of what the test was given.
        limits: how far its readings may be off by what the tests state.
        usual: the one tolerance that this test states, which then holds for other places too; or 0.
        suite: the suite's checks; None where there is only their text.
    """

    place: PlaceInTest
    runs: Sequence[ValuesRead]
    mutants: MutantReadings
    given: Sequence[ReadExpression]
    limits: StatedTolerances
    usual: float = 0.0
    suite: SuiteChecks | None = None

    def limit(self, text: str) -> StatedTolerance:
        """Return the tolerance stated for a reading; lengths of lists and numbers of calls have none."""
        if text.startswith("len(") or text.endswith(f"{CALL}count"):
            return StatedTolerance()
        limit = self.limits.of(text)
        if limit.tolerance == 0.0 and rank_of(text) == PLACE:
            return StatedTolerance(self.usual)
        return limit

    def checks(self, reading: ReadExpression) -> Iterator[CheckAtEnd]:
        """Yield the checks of a reading: that it equals an input of the test, or a value."""
        text = reading.text
        is_fact = isinstance(self.runs[0][text], bool)  # that two facts agree says nothing
        partners = [
            partner for partner in self.given if not is_fact and _are_related(partner, reading, self.runs[0])
        ]
        for other in [*partners[:_PARTNERS], None]:
            texts = [text] if other is None else [text, other.text]
            values = [read[text_read] for read in self.runs for text_read in texts]
            are_counts = all(isinstance(value, int) for value in values) and len(set(values)) == 1
            is_near = all(is_number(value) for value in values)
            is_near &= not are_counts or self.limit(text).tolerance > 0.0
            check = self._near(reading, other) if is_near else self._equal(reading, other)
            if check is not None and check.trials:
                yield check

    def allowed(self, reading: ReadExpression) -> Iterator[tuple[str, str]]:
        """Yield the mutants that differ in a reading by less than the suite allows, each with the reason."""
        limit = self.limit(reading.text).tolerance
        values = [read[reading.text] for read in self.runs]
        if limit == 0.0 or not all(is_number(value) for value in values) or is_clock(reading.text):
            return
        band = band_of(values, reading.tolerance)

        def away(read: ValuesRead) -> float:
            value = read.get(reading.text)
            return abs(value - band.middle) if is_number(value) else nan

        for (mutant, _), size in self._furthest(away).items():
            if band.tolerance < size <= limit:
                yield mutant, f"{reading.text} differs by {size:.2g}, within your tolerance of {limit!r}"

    def _near(self, reading: ReadExpression, other: ReadExpression | None) -> CheckAtEnd | None:
        """Return the check that a number is near another reading, or near a value."""

        def apart(read: ValuesRead) -> float:
            value, beside = read.get(reading.text), read.get(other.text) if other is not None else 0.0
            return value - beside if is_number(value) and is_number(beside) else nan

        floor = max(reading.tolerance, other.tolerance if other is not None else 0.0)
        band = band_of([apart(read) for read in self.runs], floor)
        in_degrees = rank_of(reading.text) == ANGLE and max(abs(apart(read)) for read in self.runs) > 2 * pi

        def away(read: ValuesRead) -> float:
            far = abs(apart(read) - band.middle)
            return min(far, abs(360.0 - far)) if in_degrees else far

        sizes = self._furthest(away)
        outside = sorted({size for size in sizes.values() if size > band.tolerance})
        if not outside:
            return None
        limit = self.limit(reading.text)
        stated = limit.tolerance
        written = [(size, *readable(band, size, stated)) for size in outside]
        size_of_value = abs(float(self.runs[0][reading.text]))

        def is_exact(value: float, wide: float) -> bool:
            digits = max(digits_of(value), precision_of(value if other is None else size_of_value, wide))
            return digits > DIGITS and not 0 < stated <= wide

        def is_fine(size: float) -> bool:
            """Return whether the suite states no tolerance and the difference is small."""
            return stated == 0.0 and size < _CLEARLY * band.tolerance

        # let through what only many digits would notice, or less than the tests allow, if there are others
        fitting = (
            stated_tolerance
            for stated_tolerance in written
            if not is_exact(*stated_tolerance[1:])
            and stated_tolerance[2] >= stated
            and not is_fine(stated_tolerance[0])
        )
        nearest, value, wide = next(fitting, written[0])
        if other is not None and abs(band.middle) > wide - band.tolerance:
            return None  # it is always as far from it, but not there
        middle = 0.0 if other is not None else value
        check = CheckAtEnd(
            place=self.place,
            reading=reading,
            value=value if other is None else other,
            runs=len(self.runs),
            spread=band.spread,
            tolerance=wide,
            is_clear=nearest >= _CLEARLY * band.tolerance,
            is_exact=is_exact(value, wide) or is_fine(nearest),
        )
        if self.suite is not None:
            check = self._in_form(check, limit)
            check, middle = self._with_constant(check, band, middle)
        differing = self._furthest(lambda read: abs(apart(read) - middle))
        noticed = {trial for trial, size in sizes.items() if size > band.tolerance}
        return replace(check, trials=_beyond(differing, wide) & noticed)

    def _in_form(self, check: CheckAtEnd, limit: StatedTolerance) -> CheckAtEnd:
        """Return the check in the suite's form, with the suite's constant for the tolerance if any."""
        assert self.suite is not None
        needs = None if limit.check is None else self.suite.needs_of_form(self.place, limit.check)
        if limit.check is None or needs is None:
            return check
        check = replace(check, like=limit.check, needs=(*check.needs, *needs))
        bound = self.suite.constant(self.place, limit.check.file, limit.check.tolerance)
        if bound is not None and check.tolerance == limit.tolerance:
            check = replace(check, bound=limit.check.tolerance, needs=(*check.needs, *bound))
        return check

    def _with_constant(self, check: CheckAtEnd, band: Band, middle: float) -> tuple[CheckAtEnd, float]:
        """Return the check with the suite's constant for its value, and that value, if one fits."""
        assert self.suite is not None
        if isinstance(check.value, ReadExpression) or check.tolerance is None:
            return check, middle
        for text, value, file in self._constants(check.reading.text):
            more = self.suite.constant(self.place, file, text)
            is_near = abs(value - band.middle) + band.tolerance <= check.tolerance
            if more is not None and is_near and not self._is_of_another(text, check):
                named = replace(check, expected=text, needs=(*check.needs, *more), is_exact=False)
                return named, value
        return check, middle

    def _constants(self, reading: str) -> Iterator[tuple[str, float, str]]:
        """Yield the suite's expressions for values of this name or item, with their values and files."""
        assert self.suite is not None
        name = last_name(reading)
        for check in self.suite.checks:
            for number, _, expected, _ in check.parts_in(self.runs[0]):
                text = check.names(number)[1]
                if name in {last_name(compared_name) for compared_name in check.names(number)}:
                    yield text, expected, check.file
        item = _ITEM.search(reading)
        for text, value in self.suite.constants(self.place.file):
            if item is not None and text.endswith(item[0]):
                yield text, value, self.place.file

    def _is_of_another(self, constant: str, check: CheckAtEnd) -> bool:
        """Return whether what a constant is a part of differs in another part from what the test reads.

        The parts are equal by chance then, as many angles are zero: ``HOME.theta_y`` at the pallet.
        """
        assert self.suite is not None
        meant, read = _PART.fullmatch(constant), _PART.fullmatch(check.reading.text)
        if meant is None or read is None:
            return False
        stated = [
            (checked.names(number)[1], expected, tolerance)
            for checked in self.suite.checks
            for number, _, expected, tolerance in checked.parts_in(self.runs[0])
        ]
        stated += [(*item, check.tolerance or 0.0) for item in self.suite.constants(self.place.file)]
        for text, value, tolerance in stated:
            part = _PART.fullmatch(text)
            if part is not None and part[1] == meant[1] and part[2] != meant[2]:
                found = self.runs[0].get(f"{read[1]}{part[2]}")
                if is_number(found) and abs(found - value) > tolerance:
                    return True
        return False

    def _equal(self, reading: ReadExpression, other: ReadExpression | None) -> CheckAtEnd | None:
        """Return the check that a reading equals another one, or a value; None if it does not always."""
        text, first = reading.text, self.runs[0][reading.text]

        def expected(read: ValuesRead) -> Any:
            return read.get(other.text) if other is not None else first

        if any(repr(read[text]) != repr(expected(read)) for read in self.runs):
            return None
        differing = self._furthest(lambda read: text in read and bool(read[text] != expected(read)))
        value = first if other is None else other
        return CheckAtEnd(
            place=self.place,
            reading=reading,
            value=value,
            runs=len(self.runs),
            trials=_beyond(differing, 0.0),
        )

    def _furthest(self, away: Callable[[ValuesRead], float]) -> dict[tuple[str, int], float]:
        """Return how far each mutant's readings are from the expected value at most, by mutant and round."""
        found: dict[tuple[str, int], float] = {}
        for mutant, reads in self.mutants.items():
            for (round, _), read in reads.items():
                size, before = away(read), found.get((mutant, round), 0.0)
                found[mutant, round] = before if isnan(size) or size <= before else size
        return found


def _beyond(sizes: Mapping[tuple[str, int], float], tolerance: float) -> Trials:
    return frozenset(trial for trial, size in sizes.items() if size > tolerance)


def _why_not(check: CheckAtEnd, own: float) -> str | None:
    """Return why a person would not merge the check; None if they might. ``own``: the suite's tolerance."""
    text = check.reading.text
    if is_clock(text):
        return ONLY_TIME
    if check.tolerance is not None and check.tolerance < own:
        return f"{text} may be off by {own!r}, as your tests say: the least that would notice it is less"
    if check.is_exact:
        return f"only an exact value would notice it: {check.statement}"
    return None


#: what is said of a survivor if times alone differ among what its tests read: it may have gone another way
ONLY_TIME = "of what was read at the ends of its tests, only times differ: add a deadline if the task has one"


def _are_related(first_reading: ReadExpression, second_reading: ReadExpression, read: ValuesRead) -> bool:
    """Return whether two readings are the same part of two things: by name, or of lists with equal values."""
    if _LAST.findall(first_reading.text) != _LAST.findall(second_reading.text):
        return False
    if CALL in first_reading.text + second_reading.text:  # two commands of one value are equal by chance
        return False
    first, second = _NAME.findall(first_reading.text), _NAME.findall(second_reading.text)
    if first[-1] == second[-1]:
        return first != second
    names = [each.text.rpartition("[")[0] for each in (first_reading, second_reading)]
    mine, others = ([read[text] for text in read if text.startswith(f"{name}[")] for name in names)
    wide = max(first_reading.tolerance, second_reading.tolerance)
    near = (is_number(a) and is_number(b) and abs(a - b) <= wide for a, b in zip(mine, others, strict=False))
    return len(set(mine)) > 1 and len(mine) == len(others) and all(near)  # lists of zeros say nothing
