"""COR: ``and`` becomes ``or``, and the other way round."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

import libcst as cst

from mutabot_source.operator import ClassicalOperator, Draft, Example, Surroundings


class ConditionalReplacement(ClassicalOperator):
    """Replaces ``and`` and ``or``; drops operands."""

    name = "COR"
    rank = 40
    summary = "A condition's and becomes or, xor, one of its operands, always true, or always false."
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            "z = x and y\n",
            (
                "z = x or y\n",
                "z = (not x) != (not y)\n",
                "z = x\n",
                "z = y\n",
                "z = False\n",
                "z = True\n",
            ),
        ),
        Example(
            "z = a or b or c\n",
            (
                "z = a and b or c\n",
                "z = a or b and c\n",
                "z = b or c\n",
                "z = a or c\n",
                "z = a or b\n",
                "z = False\n",
                "z = True\n",
            ),
            note="a longer condition: one operator after the other, one operand less",
        ),
        Example("z = x & y\n", note="bitwise operators are LOR's"),
    )

    def drafts(self, node: cst.CSTNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, cst.BooleanOperation):
            return
        values = operands(node)
        own, other = ("and", "or") if isinstance(node.operator, cst.And) else ("or", "and")
        if len(values) == 2:
            left, right = values
            yield Draft(other, (left, f" {other} ", right))
            shown = ("(not ", left, ") != (not ", right, ")")
            yield Draft("xor", shown)
            yield Draft("leftOp", (left,))
            yield Draft("rightOp", (right,))
        else:
            for index in range(len(values) - 1):
                words = [own] * (len(values) - 1)
                words[index] = other
                yield Draft(f"{other}{index + 1}", _joined(values, words))
            for index in range(len(values)):
                rest = values[:index] + values[index + 1 :]
                yield Draft(f"without{index + 1}", _joined(rest, [own] * (len(rest) - 1)))
        yield Draft("falseOp", ("False",))
        yield Draft("trueOp", ("True",))


def operands(node: cst.BooleanOperation) -> list[cst.BaseExpression]:
    """The values of ``a and b and c``, which is one expression although the tree has two."""
    left = node.left
    if not isinstance(left, cst.BooleanOperation) or left.lpar:
        return [left, node.right]
    same = type(left.operator) is type(node.operator)
    return [*operands(left), node.right] if same else [left, node.right]


def _joined(values: list[cst.BaseExpression], words: list[str]) -> tuple[str | cst.CSTNode, ...]:
    parts: list[str | cst.CSTNode] = [values[0]]
    for word, value in zip(words, values[1:], strict=True):
        parts += [f" {word} ", value]
    return tuple(parts)
