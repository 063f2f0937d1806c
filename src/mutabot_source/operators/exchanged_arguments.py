"""exchanged-arguments: two neighbouring arguments of a call are exchanged."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from itertools import pairwise
from typing import ClassVar

from mutabot_source.extension import BUGS
from mutabot_source.operator import (
    ConventionalOperator,
    Draft,
    Surroundings,
    SyntaxNode,
    TextExample,
    is_named_constant,
    is_text,
)

from ._calls import call, last_name

#: calls whose arguments have no order, or whose first two are never alike
_WITHOUT_ORDER = {
    "min", "max", "print", "isinstance", "issubclass", "getattr", "setattr", "hasattr", "zip", "map",
    "filter", "hypot", "dist", "distance", "isclose", "allclose", "debug", "info", "warning", "error",
}  # fmt: skip
_OF_NO_KIND = ast.Lambda | ast.Starred | ast.GeneratorExp | ast.Dict | ast.Set | ast.Await


class ExchangedArguments(ConventionalOperator):
    """Two neighbouring arguments of a call, which may be of one kind, are exchanged.

    Where: calls with two or more arguments by position, and values of arguments by name.

    Stands for: Start for end, frame for offset: 3 of 253 silent bugs of public robot programs exactly, 2
    nearly.
    """

    name = "exchanged-arguments"
    is_common = True
    family = BUGS
    rank = 210
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("slerp(start, end, 0.5)\n", ("slerp(end, start, 0.5)\n", "slerp(start, 0.5, end)\n")),
        TextExample("move(x=a, y=b)\n", ("move(x=b, y=a)\n",)),
        TextExample("arm.move(dx, dy, *more, speed=v)\n", ("arm.move(dy, dx, *more, speed=v)\n",)),
        TextExample("move('left', dx)\n", note="a text is no number"),
        TextExample("min(a, b)\n", note="without an order"),
        TextExample("move(x, x)\n", note="they are the same"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, ast.Call) or last_name(node.func) in _WITHOUT_ORDER:
            return
        for number, (left, right) in enumerate(pairwise(node.args), start=1):
            if _may_be_alike(left, right):
                given = [*node.args]
                given[number - 1 : number + 1] = [right, left]
                yield Draft(f"{number}", call(node, node.keywords, given))
        named = [keyword for keyword in node.keywords if keyword.arg is not None]
        for first, second in pairwise(named):
            if _may_be_alike(first.value, second.value):
                other_way = {id(first): second.value, id(second): first.value}
                keywords = [
                    ast.keyword(keyword.arg, other_way.get(id(keyword), keyword.value))
                    for keyword in node.keywords
                ]
                yield Draft(f"{first.arg}", call(node, keywords))


def _may_be_alike(left: ast.expr, right: ast.expr) -> bool:
    """Return whether two expressions may have different values of the same kind, as far as the text shows."""
    if isinstance(left, _OF_NO_KIND) or isinstance(right, _OF_NO_KIND) or ast.dump(left) == ast.dump(right):
        return False
    return _kind(left) == _kind(right)


def _kind(node: ast.expr) -> str:
    """Return the kind of an expression's value, if the expression shows it."""
    if is_text(node):
        return "text"
    if is_named_constant(node):
        return "name"
    return "row" if isinstance(node, ast.List | ast.Tuple | ast.ListComp) else ""
