"""The bounds and ranges that the suite states for readings: no suggested check allows less.

``wrench.force < MOST`` and ``math.hypot(wrench.fx, wrench.fy) < 40`` bound ``cell.truth.wrench().force``;
``0.17 < travel(belt) < 0.45`` allows 0.14 to either side.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping

from .forms import is_number
from .project import SuiteFiles, text_of
from .suite import assigned

_NAME = re.compile(r"[^\W\d]\w*")
#: names that every reading of the cell's state has
_COMMON = {"cell", "truth"}


def greatest_bound(project: SuiteFiles, text: str) -> float:
    """Return the greatest number below which any comparison of the suite wants a reading; 0 without any."""
    names = {*_NAME.findall(text)} - _COMMON
    names |= {name.rpartition("_")[2] for name in names}
    constants = dict(_constants(project))
    sizes = [
        size
        for file in project.suite_files
        for node in ast.walk(project.module(file) or ast.Module([], []))
        if isinstance(node, ast.Compare)
        for size in _bounds(node, names, constants)
    ]
    return max(sizes, default=0.0)


def stated_ranges(project: SuiteFiles) -> dict[str, float]:
    """Return half the width of the widest range that the suite states, by ``=`` and the expression's text."""
    constants = dict(_constants(project))
    found: dict[str, float] = {}
    for file in project.suite_files:
        for node in ast.walk(project.module(file) or ast.Module([], [])):
            match node:
                case ast.Compare(
                    left=first,
                    ops=[ast.Lt() | ast.LtE(), ast.Lt() | ast.LtE()]
                    | [ast.Gt() | ast.GtE(), ast.Gt() | ast.GtE()],
                    comparators=[actual, last],
                ):
                    ends = _number(first, constants), _number(last, constants)
                    if ends[0] is not None and ends[1] is not None:
                        name = f"={text_of(actual)}"
                        found[name] = max(abs(ends[1] - ends[0]) / 2, found.get(name, 0.0))
    return found


def _constants(project: SuiteFiles) -> Iterator[tuple[str, float]]:
    """Yield the numbers that files of the suite name at their top level."""
    for file in project.suite_files:
        module = project.module(file)
        found = (
            (statement for statement in module.body if isinstance(statement, ast.Assign))
            if module is not None
            else ()
        )
        for name, value in (
            pair for assignment in found for pair in assigned(assignment.targets[0], assignment.value)
        ):
            if isinstance(value, ast.Constant) and is_number(value.value):
                yield name, float(value.value)


def _bounds(node: ast.Compare, names: set[str], constants: Mapping[str, float]) -> Iterator[float]:
    sides = [node.left, *node.comparators]
    for first, operator, second in zip(sides, node.ops, sides[1:], strict=False):
        match operator:
            case ast.Lt() | ast.LtE():
                smaller, larger = first, second
            case ast.Gt() | ast.GtE():
                smaller, larger = second, first
            case _:
                continue
        size = _number(larger, constants)
        if size is not None and names & {*_NAME.findall(ast.unparse(smaller))}:
            yield size


def _number(node: ast.expr, constants: Mapping[str, float]) -> float | None:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        size = _number(node.operand, constants)
        return None if size is None else -size
    if isinstance(node, ast.Constant) and is_number(node.value):
        return float(node.value)
    return constants.get(node.id) if isinstance(node, ast.Name) else None
