"""Operators on binary operations and augmented assignments: AOR, LOR, SOR and ASR."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from typing import ClassVar

from mutabot_source.operator import (
    ConventionalOperator,
    Draft,
    Surroundings,
    SyntaxNode,
    TextExample,
    each,
    is_text,
)

_DISPLAYS = ast.List | ast.Tuple | ast.Dict | ast.Set | ast.ListComp | ast.SetComp | ast.DictComp

#: variant and sign of each operator of a group
_OperatorSigns = Mapping[type[ast.operator], tuple[str, str]]


class _BinaryOperator(ConventionalOperator):
    """Replaces a binary operator by each other of its group, and the operation by its operands.

    Class attributes:
        signs: the operators that stand for each other.
        needs: kind of value of the operation.
        keeps_right: whether the right operand may stand for the operation as the left one may.
    """

    signs: ClassVar[_OperatorSigns]
    needs: ClassVar[str]
    keeps_right: ClassVar[bool] = True

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, ast.BinOp) or type(node.op) not in self.signs:
            return
        if any(isinstance(operand, _DISPLAYS) or is_text(operand) for operand in (node.left, node.right)):
            return
        for kind, (variant, sign) in self.signs.items():
            if kind is not type(node.op):
                yield Draft(variant, (node.left, f" {sign} ", node.right), self.needs)
        yield Draft("leftOp", (node.left,), self.needs)
        if self.keeps_right:
            yield Draft("rightOp", (node.right,), self.needs)


class ArithmeticReplacement(_BinaryOperator):
    """An arithmetic operator becomes each of the others, or the operation one of its operands."""

    name = "AOR"
    is_common = True
    rank = 20
    signs: ClassVar = {
        ast.Add: ("add", "+"),
        ast.Sub: ("sub", "-"),
        ast.Mult: ("mul", "*"),
        ast.Div: ("div", "/"),
        ast.FloorDiv: ("floordiv", "//"),
        ast.Mod: ("mod", "%"),
        ast.Pow: ("pow", "**"),
    }
    needs = "number"
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("z = x + y\n", each("z = {}\n", "x - y, x * y, x / y, x // y, x % y, x ** y, x, y")),
        TextExample(
            "z = a * b % c\n",
            each(
                "z = {}\n",
                "a * b + c, a * b - c, a * b * c, a * b / c, a * b // c, (a * b) ** c, a * b, c, "
                "(a + b) % c, (a - b) % c, a / b % c, a // b % c, a % b % c, a ** b % c, a % c, b % c",
            ),
        ),
        TextExample("z = 'lift/' + height\n", note="a text is not an operand of arithmetic"),
        TextExample("z = a + b\n", kinds={"a + b": "text"}, note="the baseline saw a text there"),
        TextExample("z = a @ b\n", note="not arithmetic on numbers"),
    )


class LogicalReplacement(_BinaryOperator):
    """A bitwise operator becomes each of the others, or the operation one of its operands."""

    name = "LOR"
    rank = 60
    signs: ClassVar = {ast.BitAnd: ("and", "&"), ast.BitOr: ("or", "|"), ast.BitXor: ("xor", "^")}
    needs = "bits"
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample(
            "z = x & y\n",
            each("z = {}\n", "x | y, x ^ y, x, y"),
            kinds={"x & y": "integer"},
        ),
        TextExample(
            "z = x ^ y\n",
            each("z = {}\n", "x & y, x | y, x, y"),
            kinds={"x ^ y": "set"},
        ),
        TextExample(
            "Speed = int | float\n", kinds={"int | float": "types:UnionType"}, note="a type is not a value"
        ),
        TextExample("def f(speed: A | B): ...\n", note="nor is an annotation"),
    )


class ShiftReplacement(_BinaryOperator):
    """A shift goes the other way, or is left out."""

    name = "SOR"
    rank = 50
    signs: ClassVar = {ast.LShift: ("left", "<<"), ast.RShift: ("right", ">>")}
    needs = "integer"
    keeps_right = False
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("z = x << 2\n", ("z = x >> 2\n", "z = x\n"), kinds={"x << 2": "integer"}),
        TextExample("z = x >> y\n", ("z = x << y\n", "z = x\n"), kinds={"x >> y": "integer"}),
        TextExample("stream << 2\n", kinds={"stream << 2": "module:Stream"}, note="not a shift of numbers"),
    )


class AssignmentReplacement(ConventionalOperator):
    """An augmented assignment becomes another one of its kind, or a plain assignment."""

    name = "ASR"
    rank = 70
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("x += y\n", each("x {}\n", "-= y, *= y, /= y, //= y, %= y, **= y, = y")),
        TextExample("x <<= 1\n", ("x >>= 1\n", "x = 1\n"), kinds={"x <<= 1": "integer"}),
        TextExample("x &= y\n", ("x |= y\n", "x ^= y\n", "x = y\n"), kinds={"x &= y": "truth"}),
        TextExample("x += y\n", kinds={"x += y": "text"}, note="the baseline saw a text there"),
        TextExample("x = y\n", note="a name may not have a value before its plain assignment"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, ast.AugAssign):
            return
        for group in (ArithmeticReplacement, LogicalReplacement, ShiftReplacement):
            if type(node.op) not in group.signs:
                continue
            for kind, (variant, sign) in group.signs.items():
                if kind is not type(node.op):
                    yield Draft(variant, (node.target, f" {sign}= ", node.value), group.needs)
            yield Draft("assign", (node.target, " = ", node.value), group.needs)
