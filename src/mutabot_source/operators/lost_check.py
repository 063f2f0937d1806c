"""lost-check: a condition always holds, or never."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import ClassVar

from mutabot_source.extension import BUGS
from mutabot_source.operator import (
    ConventionalOperator,
    Draft,
    Surroundings,
    SyntaxNode,
    TextExample,
    is_named_constant,
)


class LostCheck(ConventionalOperator):
    """A condition, or a part of one, always holds, or never: a check that refuses nothing, or everything.

    Where: conditions of if, while and the like; that of a loop never holds.

    Stands for: Success taken for granted, a check that cannot fail, a command that is not for this case:
    17 of 253 silent bugs of public robot programs exactly, 1 nearly.
    """

    name = "lost-check"
    is_common = True
    family = BUGS
    rank = 250
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("if arm.arrived():\n    go()\n", ("if True:\n    go()\n", "if False:\n    go()\n")),
        TextExample(
            "while not done:\n    go()\n", ("while False:\n    go()\n", "while not True:\n    go()\n")
        ),
        TextExample("while True:\n    go()\n", note="it is one already"),
        TextExample("x = a < b\n", note="not a condition"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, ast.expr) or not around.is_condition or is_named_constant(node):
            return
        if isinstance(node, ast.NamedExpr) or any(
            isinstance(inner, ast.NamedExpr) for inner in ast.walk(node)
        ):
            return
        if not around.is_loop:
            yield Draft("always", ("True",))
            yield Draft("never", ("False",))
        elif around.is_operand_of_unary:
            yield Draft("never", ("True",))
        else:
            yield Draft("never", ("False",))
