"""Operators on single values: ABS, UOI and UOD."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import ClassVar

from mutabot_source.operator import (
    HELPER,
    ConventionalOperator,
    Draft,
    Surroundings,
    SyntaxNode,
    TextExample,
    is_scalar,
)


class Absolute(ConventionalOperator):
    """An arithmetic value becomes its absolute value, the negative of that, or raises if it is zero."""

    name = "ABS"
    rank = 10
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("y = x\n", ("y = abs(x)\n", "y = -abs(x)\n", "y = failOnZero(x)\n")),
        TextExample(
            "y = arm.x\n",
            ("y = abs(arm.x)\n", "y = -abs(arm.x)\n", "y = failOnZero(arm.x)\n"),
        ),
        TextExample("y = x\n", kinds={"x": "text"}, note="the baseline saw a text there"),
        TextExample("y = 0.2\n", note="a literal shows its sign: that is UOI's"),
        TextExample("f.g\n", kinds={"f.g": "module:Kind"}, note="its operand is not an arithmetic value"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if not is_scalar(node, around) or around.is_condition:
            return
        absolute = f"{HELPER}.absolute("
        yield Draft("abs", (absolute, node, ")"), "number", ("abs(", node, ")"))
        yield Draft("negAbs", (f"-{absolute}", node, ")"), "number", ("-abs(", node, ")"))
        not_zero = (f"{HELPER}.fail_if(", node, ", 0, 'ZeroValue', 'the value is zero')")
        yield Draft("failOnZero", not_zero, "number", ("failOnZero(", node, ")"))


_CONDITIONS = ast.Compare | ast.BoolOp


class UnaryInsertion(ConventionalOperator):
    """A value gets a minus, a bitwise or a logical not in front, whichever its type takes."""

    name = "UOI"
    is_common = True
    rank = 80
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("y = 0.2\n", ("y = -0.2\n",)),
        TextExample("y = x\n", ("y = -x\n",)),
        TextExample("y = x\n", ("y = -x\n", "y = ~x\n"), kinds={"x": "integer"}),
        TextExample("y = x\n", ("y = not x\n",), kinds={"x": "truth"}),
        TextExample("y = a + b\n", ("y = -(a + b)\n", "y = -a + b\n", "y = a + -b\n")),
        TextExample("while x: ...\n", ("while not x: ...\n",), kinds={"x": "text"}),
        TextExample("z = a < b\n", ("z = not a < b\n", "z = -a < b\n", "z = a < -b\n")),
        TextExample("y = True\n", ("y = not True\n",)),
        TextExample("y = -0.2\n", note="what has a sign is UOD's"),
        TextExample("y = 0\n", note="a zero has no other sign"),
        TextExample("y = 'red'\n", note="a text has no sign"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if around.is_operand_of_unary or not around.is_value:
            return
        if isinstance(node, _CONDITIONS):
            yield Draft("not", ("not ", node))
        elif isinstance(node, ast.Constant):
            if isinstance(node.value, bool):
                yield Draft("not", ("not ", node))
            elif isinstance(node.value, int | float | complex) and node.value:
                yield Draft("neg", ("-", node))
        elif is_scalar(node, around):
            if around.is_condition:
                yield Draft("not", ("not ", node))
                return
            yield Draft("neg", ("-", node), "number")
            yield Draft("invert", ("~", node), "integer")
            yield Draft("not", ("not ", node), "truth")


class UnaryDeletion(ConventionalOperator):
    """A unary minus, plus, bitwise or logical not is left out."""

    name = "UOD"
    rank = 90
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("y = -0.2\n", ("y = 0.2\n",)),
        TextExample("if not held: ...\n", ("if held: ...\n",)),
        TextExample("y = ~x\n", ("y = x\n",)),
        TextExample("y = a - b\n", note="that minus has two operands"),
        TextExample("z = x not in y\n", note="part of a comparison: ROR's"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if isinstance(node, ast.UnaryOp):
            yield Draft("", (node.operand,))
