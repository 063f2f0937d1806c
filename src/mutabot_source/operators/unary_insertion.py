"""UOI: a unary operator too much."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

import libcst as cst

from mutabot_source.operator import ClassicalOperator, Draft, Example, Surroundings, is_scalar

_CONDITIONS = cst.Comparison | cst.BooleanOperation


class UnaryInsertion(ClassicalOperator):
    """Puts ``-``, ``~`` or ``not`` in front of a value of the right type."""

    name = "UOI"
    rank = 80
    summary = "A value gets a minus, a bitwise or a logical not in front, whichever its type takes."
    examples: ClassVar[tuple[Example, ...]] = (
        Example("y = 0.2\n", ("y = -0.2\n",), note="a taught point"),
        Example("y = x\n", ("y = -x\n",)),
        Example("y = x\n", ("y = -x\n", "y = ~x\n"), kinds={"x": "integer"}),
        Example("y = x\n", ("y = not x\n",), kinds={"x": "truth"}),
        Example("y = a + b\n", ("y = -(a + b)\n", "y = -a + b\n", "y = a + -b\n")),
        Example("while x: ...\n", ("while not x: ...\n",), kinds={"x": "text"}, note="any condition"),
        Example("z = a < b\n", ("z = not a < b\n", "z = -a < b\n", "z = a < -b\n")),
        Example("y = True\n", ("y = not True\n",)),
        Example("y = -0.2\n", note="what has a sign is UOD's"),
        Example("y = 0\n", note="a zero has no other sign"),
        Example("y = 'red'\n", note="a text has no sign"),
    )

    def drafts(self, node: cst.CSTNode, around: Surroundings) -> Iterable[Draft]:
        if around.is_operand_of_unary or not around.is_value:
            return
        if isinstance(node, _CONDITIONS):
            yield Draft("not", ("not ", node))
        elif isinstance(node, cst.Integer | cst.Float | cst.Imaginary):
            if float(abs(node.evaluated_value)) != 0.0:
                yield Draft("neg", ("-", node))
        elif isinstance(node, cst.Name) and node.value in ("True", "False"):
            yield Draft("not", ("not ", node))
        elif is_scalar(node, around):
            if around.is_condition:
                yield Draft("not", ("not ", node))
                return
            yield Draft("neg", ("-", node), "number")
            yield Draft("invert", ("~", node), "integer")
            yield Draft("not", ("not ", node), "truth")
