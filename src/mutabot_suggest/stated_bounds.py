"""The bounds and ranges that the suite states for readings: no suggested check allows less.

``wrench.force < MOST`` and ``math.hypot(wrench.fx, wrench.fy) < 40`` bound ``cell.truth.wrench().force``;
``0.17 < travel(belt) < 0.45`` allows 0.14 to either side, as do two checks in one test.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping

from .forms import is_number
from .project import SuiteFiles, text_of
from .suite import assigned

_NAME = re.compile(r"[^\W\d]\w*")
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
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
        for size in _bounds(project.module(file) or ast.Module([], []), names, constants)
    ]
    return max(sizes, default=0.0)


def stated_ranges(project: SuiteFiles) -> dict[str, float]:
    """Return half the width of the widest range that the suite states, by ``=`` and the expression's text.

    A test states one by its lowest and its highest bound, which may be two checks.
    """
    constants = dict(_constants(project))
    found: dict[str, float] = {}
    for file in project.suite_files:
        module = project.module(file) or ast.Module([], [])
        functions: list[ast.AST] = [node for node in ast.walk(module) if isinstance(node, _FUNCTIONS)]
        for scope in functions or [module]:
            lowest: dict[str, float] = {}
            highest: dict[str, float] = {}
            for smaller, larger in _inequalities(scope):
                low, high = _number(smaller, constants), _number(larger, constants)
                if low is not None and high is None:
                    text = text_of(larger)
                    lowest[text] = min(low, lowest.get(text, low))
                elif high is not None and low is None:
                    text = text_of(smaller)
                    highest[text] = max(high, highest.get(text, high))
            for text in lowest.keys() & highest.keys():
                found[f"={text}"] = max((highest[text] - lowest[text]) / 2, found.get(f"={text}", 0.0))
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


def _bounds(node: ast.AST, names: set[str], constants: Mapping[str, float]) -> Iterator[float]:
    for smaller, larger in _inequalities(node):
        size = _number(larger, constants)
        if size is not None and names & {*_NAME.findall(ast.unparse(smaller))}:
            yield size


def _inequalities(scope: ast.AST) -> Iterator[tuple[ast.expr, ast.expr]]:
    """Yield the smaller and the larger side of each inequality, also of unittest's."""
    for node in ast.walk(scope):
        match node:
            case ast.Compare():
                sides = [node.left, *node.comparators]
                for first, operator, second in zip(sides, node.ops, sides[1:], strict=False):
                    if isinstance(operator, ast.Lt | ast.LtE):
                        yield first, second
                    elif isinstance(operator, ast.Gt | ast.GtE):
                        yield second, first
            case ast.Call(func=ast.Attribute(attr=name), args=[first, second, *_]):
                if name in ("assertLess", "assertLessEqual"):
                    yield first, second
                elif name in ("assertGreater", "assertGreaterEqual"):
                    yield second, first


def _number(node: ast.expr, constants: Mapping[str, float]) -> float | None:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        size = _number(node.operand, constants)
        return None if size is None else -size
    if isinstance(node, ast.Constant) and is_number(node.value):
        return float(node.value)
    return constants.get(node.id) if isinstance(node, ast.Name) else None
