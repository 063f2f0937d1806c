"""Tolerances that the tests state for a reading: no suggested check is tighter.

The checks of one quantity are found by what they compared when they ran, and by names.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .checks import MutantReadings
from .forms import SuiteCheck, is_number, last_name
from .project import text_of
from .readings import ValuesRead
from .stated_bounds import greatest_bound
from .suite import SuiteChecks

#: names of the parts of one thing, which have one tolerance if only some are checked
_GROUPS = ({"x", "y", "z"}, {"theta_x", "theta_y", "theta_z"}, {"roll", "pitch", "yaw"}, {"rx", "ry", "rz"})
#: share of a check's tolerance up to which values of two names are those of one quantity
_NEAR = 0.2


@dataclass(frozen=True, slots=True)
class StatedTolerance:
    """The tolerance that the tests state for a reading.

    Attributes:
        tolerance: the largest that the tests state; 0 if they state none.
        check: a check that states it; None if it has no form to imitate.
    """

    tolerance: float = 0.0
    check: SuiteCheck | None = None


class StatedTolerances:
    """The tolerances that the tests state for readings of one test.

    Args:
        suite: its checks.
        stated: the largest tolerances by names, as ``stated_in`` finds them.
        runs: what the original read in this test, in each run.
        mutants: what mutants made it read.
        elsewhere: what the original read in any test.
    """

    def __init__(
        self,
        suite: SuiteChecks,
        stated: Mapping[str, float],
        runs: Sequence[ValuesRead],
        mutants: MutantReadings,
        elsewhere: Sequence[ValuesRead],
    ) -> None:
        self._suite, self._stated = suite, stated
        self._runs = runs
        self._reads = [*runs, *(read for found in mutants.values() for read in found.values())]
        self._elsewhere = elsewhere
        self._found: dict[str, StatedTolerance] = {}

    def of(self, text: str) -> StatedTolerance:
        """Return what the tests state for a reading."""
        if text not in self._found:
            self._found[text] = self._of(text)
        return self._found[text]

    def bound(self, text: str) -> float:
        """Return the greatest bound that the tests state for a force or speed."""
        return greatest_bound(self._suite.project, text)

    def _of(self, text: str) -> StatedTolerance:
        """Return the largest tolerance for this quantity, by values or name; else the least of its group."""
        found = [*self._by_value(text)]
        if found:
            best = max(found, key=lambda tolerance: tolerance.tolerance)
            return StatedTolerance(max(best.tolerance, self._by_text(text)), best.check)
        own = self._by_text(text)
        if own:
            return StatedTolerance(own, self._form_of({last_name(text)}))
        name = last_name(text)
        group = next((candidate for candidate in _GROUPS if name in candidate), set())
        for names in ({name}, group):
            sizes = [size for related_name in names if (size := self._of_name(related_name))]
            if sizes:
                return StatedTolerance(min(sizes), self._form_of(names))
        return StatedTolerance()

    def _by_value(self, text: str) -> Iterator[StatedTolerance]:
        """Yield the tolerances of checks that compared the same values, under any name."""
        name = last_name(text)
        for check in self._suite.checks:
            numbers = {number for read in self._runs for number, *_ in check.parts_in(read)}
            for number in numbers:
                pairs = [(part, read.get(text)) for read in self._reads for part in check.parts_in(read)]
                parts = [(part, value) for part, value in pairs if part[0] == number and is_number(value)]
                if not parts:
                    continue
                tolerance = max(part[3] for part, _ in parts)
                far = max(abs(part[1] - value) for part, value in parts)
                is_named = name in {last_name(compared_name) for compared_name in check.names(number)}
                if far <= tolerance * (1.0 if is_named else _NEAR):
                    yield StatedTolerance(tolerance, check)

    def _by_text(self, text: str) -> float:
        names = (name for name in self._stated if name.startswith("="))
        reads = [read for read in self._reads if text in read]
        same = {name for name in names if reads and all(read.get(name[1:]) == read[text] for read in reads)}
        return max((self._stated[name] for name in {*same, f"={text}"} if name in self._stated), default=0.0)

    def _of_name(self, name: str) -> float:
        """Return the largest tolerance of checks of anything with this name."""
        sizes = [self._stated.get(name, 0.0)]
        for read in (*self._reads, *self._elsewhere):
            for check in self._suite.checks:
                for number, _, _, tolerance in check.parts_in(read):
                    if name in {last_name(compared_name) for compared_name in check.names(number)}:
                        sizes.append(tolerance)
        return max(sizes)

    def _form_of(self, names: set[str]) -> SuiteCheck | None:
        """Return a check of something with this name; None if there is none."""
        for check in self._suite.checks:
            actual = {last_name(text) for text in (*check.actual, *check.expected)}
            if actual & names:
                return check
        return None


def stated_in(module: ast.AST | None) -> tuple[set[str], dict[str, float]]:
    """Return the expressions that tests compare, and the largest tolerance that their text states for each.

    Keys of the tolerances are the last name of what is compared, ``x``, and the whole expression after an
    equals sign, ``=tool.x``.
    """
    compared: set[str] = set()
    tolerances: dict[str, float] = {}
    for node in ast.walk(module) if module is not None else ():
        if isinstance(node, ast.Compare):
            compared.update(text_of(inner) for inner in ast.walk(node) if isinstance(inner, ast.expr))
        actual, allowed = _comparison_parts(node)
        if actual is None:
            continue
        text = text_of(actual)
        values: list[Any] = [
            expression.value for expression in allowed if isinstance(expression, ast.Constant)
        ]
        for size in (float(size) for size in values if is_number(size)):
            for name in (f"={text}", last_name(text)):
                tolerances[name] = max(tolerances.get(name, 0.0), size)
    return compared, tolerances


def _comparison_parts(node: ast.AST) -> tuple[ast.expr | None, list[ast.expr]]:
    """Return the expression that a comparison checks, and its tolerances."""
    match node:
        case ast.Compare(left=actual, comparators=[compared]):
            calls = [inner_call for inner_call in ast.walk(compared) if isinstance(inner_call, ast.Call)]
            sizes = [word.value for call in calls for word in call.keywords if word.arg == "abs"]
            match actual:
                case ast.Call(
                    func=ast.Name(id="abs"), args=[ast.BinOp(left=inner, op=ast.Sub() | ast.Add())]
                ):
                    return inner, [compared]
            return (actual, sizes) if sizes else (None, [])
        case ast.Call(args=[actual, *_], keywords=keywords):
            sizes = [keyword.value for keyword in keywords if keyword.arg == "delta"]
            return (actual, sizes) if sizes else (None, [])
    return None, []
