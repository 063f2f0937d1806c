"""Helpers of the tests that compare numbers, such as ``def is_near(a, b): return abs(a - b) <= 0.01``.

Where such a function does nothing but return a comparison of its arguments, the margin can be worked out from
its text and the numbers that it was given. It is not called again.
"""

from __future__ import annotations

import ast
import functools
import inspect
import itertools
import math
import operator
import textwrap
from collections.abc import Callable, Mapping
from types import FunctionType
from typing import Any

_ARITHMETIC: dict[type[ast.AST], Callable[..., float]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow, ast.Mod: operator.mod, ast.USub: operator.neg, ast.UAdd: operator.pos,
}  # fmt: skip
_FUNCTIONS: dict[str, Callable[..., float]] = {
    "abs": abs, "min": min, "max": max, "fabs": math.fabs, "sqrt": math.sqrt, "hypot": math.hypot,
    "radians": math.radians, "degrees": math.degrees,
}  # fmt: skip


def margin_of_helper(function: Any, arguments: tuple[Any, ...], named: Mapping[str, Any]) -> float | None:
    """How far the sides of the comparison are apart that a function returns; None for any other function."""
    if not isinstance(function, FunctionType) or len(arguments) > 10:
        return None
    test = _returned(function)
    if test is None:
        return None
    try:
        given = inspect.signature(function).bind(*arguments, **named)
        given.apply_defaults()
        if any(type(one) not in (int, float) for one in given.arguments.values()):
            return None
        return _margin(test, given.arguments)
    except (ArithmeticError, LookupError, TypeError, ValueError):
        return None


@functools.lru_cache(maxsize=256)
def _returned(function: FunctionType) -> ast.expr | None:
    """The comparison that a function returns, if it does nothing else."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    except (OSError, SyntaxError, TypeError):
        return None
    found = tree.body[0]
    if not isinstance(found, ast.FunctionDef) or found.decorator_list:
        return None
    body = found.body[1:] if ast.get_docstring(found) is not None else found.body
    is_one = len(body) == 1 and isinstance(body[0], ast.Return)
    value = body[0].value if is_one and isinstance(body[0], ast.Return) else None
    return value if isinstance(value, ast.Compare | ast.BoolOp) else None


def _margin(test: ast.expr, given: Mapping[str, Any]) -> float:
    """The least of all comparisons'. Raises LookupError for what is no matter of more or less."""
    if isinstance(test, ast.BoolOp):
        return min(_margin(value, given) for value in test.values)
    if not isinstance(test, ast.Compare):
        raise LookupError(type(test).__name__)
    if not all(isinstance(one, ast.Lt | ast.LtE | ast.Gt | ast.GtE) for one in test.ops):
        raise LookupError("equality")
    values = [_value(one, given) for one in (test.left, *test.comparators)]
    return min(abs(right - left) for left, right in itertools.pairwise(values))


def _value(node: ast.expr, given: Mapping[str, Any]) -> float:
    match node:
        case ast.Constant(value=int() | float() as value):
            return value
        case ast.Name(id=name):
            return float(given[name])
        case ast.BinOp(left=left, op=op, right=right):
            return _ARITHMETIC[type(op)](_value(left, given), _value(right, given))
        case ast.UnaryOp(op=op, operand=operand):
            return _ARITHMETIC[type(op)](_value(operand, given))
        case ast.Call(func=ast.Name(id="round"), args=[value, ast.Constant(value=int() as digits)]):
            return round(_value(value, given), digits)
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(value=ast.Name(id="math"), attr=name)):
            return _FUNCTIONS[name](*(_value(one, given) for one in node.args))
    raise LookupError(type(node).__name__)
