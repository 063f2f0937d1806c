"""ABS: an arithmetic value loses its sign, or must not be zero."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

import libcst as cst

from mutabot_source.operator import HELPER, ClassicalOperator, Draft, Example, Surroundings, is_scalar


class Absolute(ClassicalOperator):
    """abs, negAbs and failOnZero around arithmetic values."""

    name = "ABS"
    rank = 10
    summary = "An arithmetic value becomes its absolute value, the negative of that, or raises if it is zero."
    examples: ClassVar[tuple[Example, ...]] = (
        Example("y = x\n", ("y = abs(x)\n", "y = -abs(x)\n", "y = failOnZero(x)\n")),
        Example(
            "y = arm.x\n",
            ("y = abs(arm.x)\n", "y = -abs(arm.x)\n", "y = failOnZero(arm.x)\n"),
            note="attributes, items, calls and sums as well",
        ),
        Example("y = x\n", kinds={"x": "text"}, note="the baseline saw a text there"),
        Example("y = 0.2\n", note="a literal shows its sign: that is UOI's"),
        Example("f.g\n", kinds={"f.g": "module:Kind"}, note="what it is taken from is no arithmetic value"),
    )

    def drafts(self, node: cst.CSTNode, around: Surroundings) -> Iterable[Draft]:
        if not is_scalar(node, around) or around.is_condition:
            return
        absolute = f"{HELPER}.absolute("
        yield Draft("abs", (absolute, node, ")"), "number", ("abs(", node, ")"))
        yield Draft("negAbs", (f"-{absolute}", node, ")"), "number", ("-abs(", node, ")"))
        not_zero = (f"{HELPER}.fail_if(", node, ", 0, 'ZeroValue', 'the value is zero')")
        yield Draft("failOnZero", not_zero, "number", ("failOnZero(", node, ")"))
