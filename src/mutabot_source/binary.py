"""What the operators on binary operations share."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

import libcst as cst

from .operator import ClassicalOperator, Draft, Surroundings

_TEXTS = cst.SimpleString | cst.FormattedString | cst.ConcatenatedString
_DISPLAYS = cst.List | cst.Tuple | cst.Dict | cst.Set | cst.ListComp | cst.SetComp | cst.DictComp


class BinaryOperator(ClassicalOperator):
    """Replaces a binary operator by each other of its group, and the operation by its operands.

    Class attributes:
        signs: variant and sign by class of the node.
        needs: kind of value of the operation.
        keeps_right: whether the right operand may stand for the operation as the left one may.
    """

    signs: ClassVar[Mapping[type[cst.CSTNode], tuple[str, str]]]
    needs: ClassVar[str]
    keeps_right: ClassVar[bool] = True

    def drafts(self, node: cst.CSTNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, cst.BinaryOperation) or type(node.operator) not in self.signs:
            return
        if any(isinstance(operand, _TEXTS | _DISPLAYS) for operand in (node.left, node.right)):
            return
        for kind, (variant, sign) in self.signs.items():
            if kind is not type(node.operator):
                yield Draft(variant, (node.left, f" {sign} ", node.right), self.needs)
        yield Draft("leftOp", (node.left,), self.needs)
        if self.keeps_right:
            yield Draft("rightOp", (node.right,), self.needs)
