"""Proposed checks: where each is placed, its statement, and the survivors that it notices."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .bands import digits_of
from .editing import Addition, equal, within
from .forms import SuiteCheck, is_number, last_name
from .project import PlaceInTest, text_of
from .readings import ReadExpression, ValuesRead

_NAME = re.compile(r"[^\W\d]\w*")
PLACES = re.compile(
    r"(?:^|_)(?:[xyz]|pos|pose|position|place|height|distance|depth|gap|width)s?(?:_|$)", re.I
)
ANGLES = re.compile(
    r"(?:^|_)(?:angle|theta|yaw|pitch|roll|tilt|heading|joint|rot\w*|r[xyz]|j\d+|q\d*)s?(?:_|$)", re.I
)
#: what a person would rather look at, the best first
PLACE, ANGLE, OTHER_KIND = range(3)
#: characters of a line from which on a call is written over several
_LONG = 84
#: checks that the suite has elsewhere come first, then readings at the end, then monitors
_ELSEWHERE, _AT_END, _ON_THE_WAY = 2, 1, 0

#: what mutants made tests read: per mutant id, by (round, node id)
MutantReadings = Mapping[str, Mapping[tuple[int, str], ValuesRead]]
#: mutant ids, each with a round
Trials = frozenset[tuple[str, int]]


@dataclass(frozen=True, eq=False, kw_only=True)
class CheckProposal:
    """A check that could be added to a test.

    Attributes:
        place: the test.
        trials: the mutants and rounds that it would notice.
        runs: how many runs of the original agree.
        spread: how far these are apart; None if they are equal.
        tolerance: greatest distance; None if both must be equal.
        needs: imports.
    """

    place: PlaceInTest
    trials: Trials = frozenset()
    runs: int = 0
    spread: float | None = None
    tolerance: float | None = None
    needs: tuple[str, ...] = ()

    @property
    def lines(self) -> tuple[str, ...]:
        """The statements, in the style of its test."""
        raise NotImplementedError

    @property
    def worth(self) -> tuple[float, ...]:
        """Sort key: the highest is the check that a person would most likely write."""
        raise NotImplementedError

    @property
    def looks_at(self) -> str:
        """The expressions that the check reads."""
        raise NotImplementedError

    @property
    def after(self) -> str:
        """The name after whose assignment the check is placed; empty for the end of the test."""
        return ""

    @property
    def statement(self) -> str:
        """The check's statements as one text."""
        return "\n".join(self.lines)

    def addition(self) -> Addition:
        """Return the check as an addition to a test."""
        names = set(_NAME.findall(self.statement))
        approx = ["import pytest"] if "pytest.approx" in self.statement else []
        used = tuple(name for name in self.place.names if name in names)
        return Addition(self.place, self.lines, used, (*self._all_needs, *approx), self.after)

    @property
    def _all_needs(self) -> tuple[str, ...]:
        return self.needs


@dataclass(frozen=True, eq=False, kw_only=True)
class CheckOfSuite(CheckProposal):
    """Checks that the suite already has, in another test or step.

    Attributes:
        statements: as they stand there.
    """

    statements: tuple[str, ...]

    @property
    def lines(self) -> tuple[str, ...]:
        """The statements as they are in the suite."""
        return self.statements

    @property
    def worth(self) -> tuple[float, ...]:
        """Sort key: few statements with few names come first."""
        return _ELSEWHERE, len(self.trials), -len(self.statements), -len(self.statement)

    @property
    def looks_at(self) -> str:
        """The text of the whole check."""
        return self.statements[0].removeprefix("assert ")


@dataclass(frozen=True, eq=False, kw_only=True)
class Monitor(CheckProposal):
    """A condition that an object of the test monitors from its creation on.

    Attributes:
        owner: the name of the object.
        condition: what must hold at every moment.
        name: its description.
        is_release: whether it says from where something may be let go.
        distance: how far the nearest survivor breaks it, in what counts as clear.
    """

    owner: str
    condition: str
    name: str
    distance: float
    is_release: bool = False

    @property
    def lines(self) -> tuple[str, ...]:
        """The call that adds the condition to the object's monitors."""
        line = f'{self.owner}.always(lambda: {self.condition}, "{self.name}")'
        if len(line) <= _LONG:
            return (line,)
        condition = f"    lambda: {self.condition},"
        if len(condition) > _LONG:  # formatters do not break what has no parentheses
            lines = [f"        {part}" for part in self.condition.replace(" or ", "\nor ").split("\n")]
            broken = (line if len(line) <= _LONG else line.replace(" < ", "\n        < ") for line in lines)
            condition = "\n".join(["    lambda: (", *broken, "    ),"])
        return (f'{self.owner}.always(\n{condition}\n    "{self.name}",\n)',)

    @property
    def worth(self) -> tuple[float, ...]:
        """Sort key: conditions on releases first, then those that many survivors break, then few readings."""
        kills = len({mutant for mutant, _ in self.trials})
        return _ON_THE_WAY, self.is_release, kills, " or " not in self.condition, self.distance

    @property
    def looks_at(self) -> str:
        """The condition."""
        return self.condition

    @property
    def after(self) -> str:
        """The object's name."""
        return self.owner


@dataclass(frozen=True, eq=False, kw_only=True)
class CheckAtEnd(CheckProposal):
    """A check of a reading at the end of a test.

    Attributes:
        reading: what it reads.
        value: what that must be: a plain value, or the other reading that it must equal.
        expected: the suite's own expression for the value; empty where it has none.
        like: the check of the suite whose form it has.
        bound: the suite's own expression for the tolerance; empty where the number is written.
        is_clear: whether all that it notices is far off: ten times what the original may be.
        is_exact: whether it asks for more digits than the suite justifies.
        alike: how much its reading has in common with what its test looks at already.
    """

    reading: ReadExpression
    value: Any
    expected: str = ""
    like: SuiteCheck | None = None
    bound: str = ""
    is_clear: bool = True
    is_exact: bool = False
    alike: int = 0

    @property
    def looks_at(self) -> str:
        """The reading's expression."""
        return self.reading.text

    @property
    def worth(self) -> tuple[float, ...]:
        """Sort key: a reader of the suite, its constant or a relation, its form, a position, few digits."""
        rank = rank_of(self.reading.text)
        is_named = isinstance(self.value, ReadExpression) or bool(self.expected)
        digits = digits_of(self.value) if is_number(self.value) and not is_named else 1
        kind = _AT_END, -self.reading.way, is_named, self.like is not None, -rank, self.is_clear
        return *kind, -digits, self.alike, -len(self.statement)

    @property
    def _all_needs(self) -> tuple[str, ...]:
        other = self.value.needs if isinstance(self.value, ReadExpression) else ()
        return (*self.reading.needs, *other, *self.needs)

    @property
    def lines(self) -> tuple[str, ...]:
        """The assertion, in the suite's form if there is one."""
        style, text = self.place.style, self.reading.text
        other = self.value.text if isinstance(self.value, ReadExpression) else self.expected
        if self.tolerance is None:
            return (equal(style, text, other or text_of(ast.Constant(self.value))),)
        value, tolerance = other or repr(float(self.value)), self.bound or repr(self.tolerance)
        if self.like is not None:
            return (self.like.statement(text, value, tolerance),)
        return (within(style, text, value, tolerance),)


def rank_of(text: str) -> int:
    """Return the rank of a reading by its name: ``PLACE``, ``ANGLE`` or other."""
    name = last_name(text)
    if ANGLES.search(name):
        return ANGLE
    return PLACE if PLACES.search(name) else OTHER_KIND
