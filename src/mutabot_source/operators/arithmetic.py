"""AOR: an arithmetic operator becomes another one."""

from __future__ import annotations

from typing import ClassVar

import libcst as cst

from mutabot_source.binary import BinaryOperator
from mutabot_source.operator import Example


class ArithmeticReplacement(BinaryOperator):
    """Replaces ``+ - * / // % **``."""

    name = "AOR"
    rank = 20
    summary = "An arithmetic operator becomes each of the others, or the operation one of its operands."
    signs: ClassVar = {
        cst.Add: ("add", "+"),
        cst.Subtract: ("sub", "-"),
        cst.Multiply: ("mul", "*"),
        cst.Divide: ("div", "/"),
        cst.FloorDivide: ("floordiv", "//"),
        cst.Modulo: ("mod", "%"),
        cst.Power: ("pow", "**"),
    }
    needs = "number"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            "z = x + y\n",
            (
                "z = x - y\n",
                "z = x * y\n",
                "z = x / y\n",
                "z = x // y\n",
                "z = x % y\n",
                "z = x ** y\n",
                "z = x\n",
                "z = y\n",
            ),
        ),
        Example(
            "z = a * b % c\n",
            (
                "z = a * b + c\n",
                "z = a * b - c\n",
                "z = a * b * c\n",
                "z = a * b / c\n",
                "z = a * b // c\n",
                "z = (a * b) ** c\n",
                "z = a * b\n",
                "z = c\n",
                "z = (a + b) % c\n",
                "z = (a - b) % c\n",
                "z = a / b % c\n",
                "z = a // b % c\n",
                "z = a % b % c\n",
                "z = a ** b % c\n",
                "z = a % c\n",
                "z = b % c\n",
            ),
            note="operands stay what they are",
        ),
        Example("z = 'lift/' + height\n", note="a text is no operand of arithmetic"),
        Example("z = a + b\n", kinds={"a + b": "text"}, note="the baseline saw a text there"),
        Example("z = a @ b\n", note="not arithmetic on numbers"),
    )
