"""ASR: an augmented assignment does something else."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

import libcst as cst

from mutabot_source.operator import ClassicalOperator, Draft, Example, Surroundings

_Signs = dict[type[cst.CSTNode], tuple[str, str]]
_ARITHMETIC: _Signs = {
    cst.AddAssign: ("add", "+="),
    cst.SubtractAssign: ("sub", "-="),
    cst.MultiplyAssign: ("mul", "*="),
    cst.DivideAssign: ("div", "/="),
    cst.FloorDivideAssign: ("floordiv", "//="),
    cst.ModuloAssign: ("mod", "%="),
    cst.PowerAssign: ("pow", "**="),
}
_BITS: _Signs = {
    cst.BitAndAssign: ("and", "&="),
    cst.BitOrAssign: ("or", "|="),
    cst.BitXorAssign: ("xor", "^="),
}
_SHIFTS: _Signs = {cst.LeftShiftAssign: ("left", "<<="), cst.RightShiftAssign: ("right", ">>=")}


class AssignmentReplacement(ClassicalOperator):
    """Replaces ``+=`` and its like."""

    name = "ASR"
    rank = 70
    summary = "An augmented assignment becomes another one of its kind, or a plain assignment."
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            "x += y\n",
            (
                "x -= y\n",
                "x *= y\n",
                "x /= y\n",
                "x //= y\n",
                "x %= y\n",
                "x **= y\n",
                "x = y\n",
            ),
        ),
        Example("x <<= 1\n", ("x >>= 1\n", "x = 1\n"), kinds={"x <<= 1": "integer"}),
        Example("x &= y\n", ("x |= y\n", "x ^= y\n", "x = y\n"), kinds={"x &= y": "truth"}),
        Example("x += y\n", kinds={"x += y": "text"}, note="the baseline saw a text there"),
        Example("x = y\n", note="a name may not have a value before its plain assignment"),
    )

    def drafts(self, node: cst.CSTNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, cst.AugAssign):
            return
        kind = type(node.operator)
        for group, needs in ((_ARITHMETIC, "number"), (_BITS, "bits"), (_SHIFTS, "integer")):
            if kind not in group:
                continue
            for other, (variant, sign) in group.items():
                if other is not kind:
                    yield Draft(variant, (node.target, f" {sign} ", node.value), needs)
            yield Draft("assign", (node.target, " = ", node.value), needs)
