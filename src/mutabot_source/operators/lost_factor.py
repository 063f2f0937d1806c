"""lost-factor: a value stays in its unit, or is converted the wrong way."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable
from typing import ClassVar

from mutabot_source.extension import BUGS
from mutabot_source.operator import ConventionalOperator, Draft, Surroundings, SyntaxNode, TextExample

from ._calls import last_name

#: between units of length, time and angle, percent, and the acceleration of gravity
_NUMBERS = {
    10, 100, 1000, 1_000_000, 1_000_000_000, 60, 3600, 180, 360, 0.1, 0.01, 0.001, 1e-6, 1e-9,
    25.4, 2.54, 0.0254, 9.81, 9.80665, 9.8,
}  # fmt: skip
_NAMED = re.compile(r"(^|_)(per|ratio|factor|scale|gain|gravity|tau|resolution)(_|\d|$)", re.IGNORECASE)


class LostFactor(ConventionalOperator):
    """A factor between two units is left out, or divides where it multiplies.

    Where: products and quotients with a power of ten, another number that converts units, π/180, or a name
    with a word such as per, ratio, factor or scale.

    Stands for: Milliseconds for seconds, counts for degrees, g for m/s², a gear ratio upside down: 8 of 253
    silent bugs of public robot programs exactly, 0 nearly.
    """

    name = "lost-factor"
    is_common = True
    family = BUGS
    rank = 290
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("wait = t * 1000\n", ("wait = t\n", "wait = t / 1000\n")),
        TextExample(
            "turn = counts / COUNTS_PER_TURN\n", ("turn = counts\n", "turn = counts * COUNTS_PER_TURN\n")
        ),
        TextExample("angle = a * math.pi / 180\n", ("angle = a\n", "angle = a * 180 / math.pi\n")),
        TextExample("area = width * height\n", note="no factor between units"),
        TextExample("x = 10 * 100\n", note="two numbers are no value in a unit"),
        TextExample("x = 1000 / t\n", note="the number is no factor of the value"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, ast.BinOp) or not isinstance(node.op, ast.Mult | ast.Div):
            return
        half = _of_half_turn(node)
        if half is not None:
            value, first, second = half
            sign = (" / ", " * ") if isinstance(node.op, ast.Mult) else (" * ", " / ")
            yield Draft("lost", (value,))
            yield Draft("turned", (value, sign[0], second, sign[1], first))
            return
        found = _value_and_factor(node)
        if found is not None:
            value, factor = found
            yield Draft("lost", (value,))
            yield Draft("turned", (value, " / " if isinstance(node.op, ast.Mult) else " * ", factor))


def _value_and_factor(node: ast.BinOp) -> tuple[ast.expr, ast.expr] | None:
    """Return the converted value and its factor; None if no operand is a factor, or both may be."""
    left, right = _is_factor(node.left), _is_factor(node.right)
    if right and not left and not isinstance(node.left, ast.Constant):
        return node.left, node.right
    if left and not right and isinstance(node.op, ast.Mult) and not isinstance(node.right, ast.Constant):
        return node.right, node.left
    return None


def _of_half_turn(node: ast.BinOp) -> tuple[ast.expr, ast.expr, ast.expr] | None:
    """Return value, multiplier and divisor of ``value * π / 180`` or ``value * 180 / π``; else None."""
    inner = node.left
    if (
        not isinstance(node.op, ast.Div)
        or not isinstance(inner, ast.BinOp)
        or not isinstance(inner.op, ast.Mult)
    ):
        return None
    is_pi, is_half = last_name(inner.right) == "pi", _is_number(inner.right, 180)
    if (is_pi and _is_number(node.right, 180)) or (is_half and last_name(node.right) == "pi"):
        return inner.left, inner.right, node.right
    return None


def _is_factor(node: ast.expr) -> bool:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
        names = {last_name(node.left), last_name(node.right)}
        return "pi" in names and (_is_number(node.left, 180) or _is_number(node.right, 180))
    if isinstance(node, ast.Constant):
        return type(node.value) in (int, float) and node.value in _NUMBERS
    return bool(_NAMED.search(last_name(node)))


def _is_number(node: ast.expr, number: int) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) in (int, float) and node.value == number
