"""Operators on conditions: COR and ROR."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping, Sequence
from typing import ClassVar

from mutabot_source.operator import (
    ConventionalOperator,
    Draft,
    Surroundings,
    SyntaxNode,
    TextExample,
    TextParts,
    each,
    is_named_constant,
)


class ConditionalReplacement(ConventionalOperator):
    """A condition's `and` becomes `or`, exclusive or, one of its operands, always true, or always false."""

    name = "COR"
    is_common = True
    rank = 40
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("z = x and y\n", each("z = {}\n", "x or y, (not x) != (not y), x, y, False, True")),
        TextExample(
            "z = a or b or c\n",
            each("z = {}\n", "a and b or c, a or b and c, b or c, a or c, a or b, False, True"),
        ),
        TextExample("z = x & y\n", note="bitwise operators are LOR's"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, ast.BoolOp):
            return
        values = node.values
        own, other = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
        if len(values) == 2:
            left, right = values
            yield Draft(other, (left, f" {other} ", right))
            shown = ("(not ", left, ") != (not ", right, ")")
            yield Draft("xor", shown)
            yield Draft("leftOp", (left,))
            yield Draft("rightOp", (right,))
        else:
            for index in range(len(values) - 1):
                operators = [own] * (len(values) - 1)
                operators[index] = other
                yield Draft(f"{other}{index + 1}", _joined(values, operators))
            for index in range(len(values)):
                rest = values[:index] + values[index + 1 :]
                yield Draft(f"without{index + 1}", _joined(rest, [own] * (len(rest) - 1)))
        yield Draft("falseOp", ("False",))
        yield Draft("trueOp", ("True",))


def _joined(values: Sequence[ast.expr], operators: Iterable[str]) -> TextParts:
    parts: list[str | ast.expr] = [values[0]]
    for word, value in zip(operators, values[1:], strict=True):
        parts += [f" {word} ", value]
    return tuple(parts)


_ComparisonSigns = Mapping[type[ast.cmpop], tuple[str, str]]
_ORDERS: _ComparisonSigns = {
    ast.Lt: ("lt", "<"),
    ast.LtE: ("le", "<="),
    ast.Gt: ("gt", ">"),
    ast.GtE: ("ge", ">="),
    ast.Eq: ("eq", "=="),
    ast.NotEq: ("ne", "!="),
}
_EQUALITIES: _ComparisonSigns = {kind: _ORDERS[kind] for kind in (ast.Eq, ast.NotEq)}
_IDENTITIES: _ComparisonSigns = {
    ast.Is: ("is", "is"),
    ast.IsNot: ("isNot", "is not"),
}
_MEMBERSHIPS: _ComparisonSigns = {
    ast.In: ("in", "in"),
    ast.NotIn: ("notIn", "not in"),
}
_SIGNS = {**_ORDERS, **_IDENTITIES, **_MEMBERSHIPS}


class RelationalReplacement(ConventionalOperator):
    """A comparison becomes each of the others, or always true, or always false."""

    name = "ROR"
    is_common = True
    rank = 30
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
        TextExample(
            "if __name__ == '__main__': main()\n", note="a block that no test can run has no mutants"
        ),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, ast.Compare):
            return
        values = [node.left, *node.comparators]
        signs = [type(sign) for sign in node.ops]
        for index, kind in enumerate(signs):
            group = _group(kind, values[index : index + 2])
            for other, (variant, _) in group.items():
                if other is not kind:
                    number = str(index + 1) if len(signs) > 1 else ""
                    changed = [*signs[:index], other, *signs[index + 1 :]]
                    yield Draft(
                        f"{variant}{number}", _joined(values, [_SIGNS[operator][1] for operator in changed])
                    )
        yield Draft("falseOp", ("False",))
        yield Draft("trueOp", ("True",))


def _group(kind: type[ast.cmpop], operands: Iterable[ast.expr]) -> _ComparisonSigns:
    for group in (_IDENTITIES, _MEMBERSHIPS):
        if kind in group:
            return group
    return _EQUALITIES if any(_has_no_order(operand) for operand in operands) else _ORDERS


def _has_no_order(operand: ast.expr) -> bool:
    return isinstance(operand, ast.Dict) or is_named_constant(operand)
