"""lost-copy: a live view is kept where a copy is meant."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import ClassVar

from mutabot_source.extension import BUGS
from mutabot_source.operator import ConventionalOperator, Draft, Surroundings, SyntaxNode, TextExample

from ._calls import last_name


class LostCopy(ConventionalOperator):
    """The object itself is kept, and changes on, where a copy is meant.

    Where: copy, deepcopy and slices of a whole row.

    Stands for: A live view of a state taken for what it was: 1 of 253 silent bugs of public robot
    programs exactly, 1 nearly.
    """

    name = "lost-copy"
    family = BUGS
    rank = 240
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("before = state.copy()\n", ("before = state\n",)),
        TextExample("before = deepcopy(state)\n", ("before = state\n",)),
        TextExample("before = path[:]\n", ("before = path\n",)),
        TextExample("first = path[0]\n"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if isinstance(node, ast.Subscript) and _is_whole(node.slice):
            yield Draft("", (node.value,))
        elif (
            isinstance(node, ast.Call) and last_name(node.func) in ("copy", "deepcopy") and not node.keywords
        ):
            if len(node.args) == 1 and not isinstance(node.args[0], ast.Starred):
                yield Draft("", (node.args[0],))
            elif not node.args and isinstance(node.func, ast.Attribute):
                yield Draft("", (node.func.value,))


def _is_whole(node: ast.expr) -> bool:
    return isinstance(node, ast.Slice) and node.lower is node.upper is node.step is None
