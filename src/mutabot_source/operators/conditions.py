"""Operators on conditions: COR and ROR."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

import libcst as cst

from mutabot_source.operator import ConventionalOperator, Draft, Surroundings, TextExample, each


class ConditionalReplacement(ConventionalOperator):
    """Replaces ``and`` and ``or``; drops operands."""

    name = "COR"
    rank = 40
    summary = "A condition's and becomes or, xor, one of its operands, always true, or always false."
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("z = x and y\n", each("z = {}\n", "x or y, (not x) != (not y), x, y, False, True")),
        TextExample(
            "z = a or b or c\n",
            each("z = {}\n", "a and b or c, a or b and c, b or c, a or c, a or b, False, True"),
        ),
        TextExample("z = x & y\n", note="bitwise operators are LOR's"),
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


_Signs = dict[type[cst.CSTNode], tuple[str, str]]
_ORDERS: _Signs = {
    cst.LessThan: ("lt", "<"),
    cst.LessThanEqual: ("le", "<="),
    cst.GreaterThan: ("gt", ">"),
    cst.GreaterThanEqual: ("ge", ">="),
    cst.Equal: ("eq", "=="),
    cst.NotEqual: ("ne", "!="),
}
_EQUALITIES: _Signs = {kind: _ORDERS[kind] for kind in (cst.Equal, cst.NotEqual)}
_IDENTITIES: _Signs = {
    cst.Is: ("is", "is"),
    cst.IsNot: ("isNot", "is not"),
}
_MEMBERSHIPS: _Signs = {
    cst.In: ("in", "in"),
    cst.NotIn: ("notIn", "not in"),
}
_SIGNS = _ORDERS | _IDENTITIES | _MEMBERSHIPS
_WITHOUT_ORDER = ("None", "True", "False")


class RelationalReplacement(ConventionalOperator):
    """Replaces each operator of a comparison, and the comparison by a truth value."""

    name = "ROR"
    rank = 30
    summary = "A comparison becomes each of the others, or always true, or always false."
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("z = x < y\n", each("z = {}\n", "x <= y, x > y, x >= y, x == y, x != y, False, True")),
        TextExample(
            "z = a < b in c\n",
            each(
                "z = {}\n",
                "a <= b in c, a > b in c, a >= b in c, a == b in c, a != b in c, a < b not in c, False, True",
            ),
        ),
        TextExample("z = x is None\n", ("z = x is not None\n", "z = False\n", "z = True\n")),
        TextExample(
            "z = x == None\n", ("z = x != None\n", "z = False\n", "z = True\n"), note="None has no order"
        ),
        TextExample("if __name__ == '__main__': main()\n", note="what is not run by a test is no place"),
    )

    def drafts(self, node: cst.CSTNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, cst.Comparison):
            return
        values = [node.left, *(target.comparator for target in node.comparisons)]
        signs = [type(target.operator) for target in node.comparisons]
        for index, kind in enumerate(signs):
            group = _group(kind, values[index : index + 2])
            for other, (variant, _) in group.items():
                if other is not kind:
                    number = str(index + 1) if len(signs) > 1 else ""
                    changed = [*signs[:index], other, *signs[index + 1 :]]
                    yield Draft(f"{variant}{number}", _chain(values, changed))
        yield Draft("falseOp", ("False",))
        yield Draft("trueOp", ("True",))


def _group(kind: type[cst.CSTNode], operands: list[cst.BaseExpression]) -> _Signs:
    for group in (_IDENTITIES, _MEMBERSHIPS):
        if kind in group:
            return group
    return _EQUALITIES if any(_has_no_order(operand) for operand in operands) else _ORDERS


def _has_no_order(operand: cst.BaseExpression) -> bool:
    return isinstance(operand, cst.Dict) or (
        isinstance(operand, cst.Name) and operand.value in _WITHOUT_ORDER
    )


def _chain(values: list[cst.BaseExpression], signs: list[type[cst.CSTNode]]) -> tuple[str | cst.CSTNode, ...]:
    parts: list[str | cst.CSTNode] = [values[0]]
    for sign, value in zip(signs, values[1:], strict=True):
        parts += [f" {_SIGNS[sign][1]} ", value]
    return tuple(parts)
