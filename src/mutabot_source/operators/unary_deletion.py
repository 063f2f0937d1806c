"""UOD: a unary operator is left out."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

import libcst as cst

from mutabot_source.operator import ClassicalOperator, Draft, Example, Surroundings


class UnaryDeletion(ClassicalOperator):
    """Drops ``-``, ``+``, ``~`` and ``not``."""

    name = "UOD"
    rank = 90
    summary = "A unary minus, plus, bitwise or logical not is left out."
    examples: ClassVar[tuple[Example, ...]] = (
        Example("y = -0.2\n", ("y = 0.2\n",), note="a taught point"),
        Example("if not held: ...\n", ("if held: ...\n",)),
        Example("y = ~x\n", ("y = x\n",)),
        Example("y = a - b\n", note="that minus has two operands"),
        Example("z = x not in y\n", note="part of a comparison: ROR's"),
    )

    def drafts(self, node: cst.CSTNode, around: Surroundings) -> Iterable[Draft]:
        if isinstance(node, cst.UnaryOperation):
            yield Draft("", (node.expression,))
