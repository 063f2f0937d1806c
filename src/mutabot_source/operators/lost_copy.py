"""lost-copy: a live view is kept where a copy is meant."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import ClassVar

from mutabot_source.extension import BUGS
from mutabot_source.operator import ConventionalOperator, Draft, Surroundings, SyntaxNode, TextExample

from ._calls import last_name

_MAKING = ("list", "dict", "array")


class LostCopy(ConventionalOperator):
    """The object itself is kept, and changes on, where a copy is meant.

    Where: copy, deepcopy and slices of a whole row; list, dict and array of a name or of what a method gives.

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
        TextExample("before = list(arm.where())\n", ("before = arm.where()\n",)),
        TextExample("first = path[0]\n"),
        TextExample("steps = list(range(3))\n", note="no row yet"),
        TextExample("names = list(poses.keys())\n", note="no row yet"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if isinstance(node, ast.Subscript) and _is_whole(node.slice):
            yield Draft("", (node.value,))
        elif isinstance(node, ast.Call) and not node.keywords:
            copied = _copied(node)
            if copied is not None:
                yield Draft("", (copied,))


def _copied(node: ast.Call) -> ast.expr | None:
    """Return the expression that a call copies; None if the call is no copy."""
    name = last_name(node.func)
    if len(node.args) == 1 and not isinstance(node.args[0], ast.Starred):
        is_copy = name in ("copy", "deepcopy") or (name in _MAKING and _is_kept(node.args[0]))
        return node.args[0] if is_copy else None
    is_method = name == "copy" and not node.args and isinstance(node.func, ast.Attribute)
    return node.func.value if is_method and isinstance(node.func, ast.Attribute) else None


def _is_kept(node: ast.expr) -> bool:
    """Return whether an expression may be an object stored elsewhere, rather than one that is made here."""
    if isinstance(node, ast.Call):
        is_method = isinstance(node.func, ast.Attribute) and not node.args and not node.keywords
        return is_method and last_name(node.func) not in ("keys", "values", "items", "split", "readlines")
    return isinstance(node, ast.Name | ast.Attribute)


def _is_whole(node: ast.expr) -> bool:
    return isinstance(node, ast.Slice) and node.lower is node.upper is node.step is None
