"""BSR: a statement is replaced by one that raises an error."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import ClassVar

from mutabot_source.operator import (
    HELPER,
    ConventionalOperator,
    Draft,
    Surroundings,
    SyntaxNode,
    TextExample,
    is_idle,
)

_STATEMENTS = (
    ast.Assign | ast.AnnAssign | ast.AugAssign | ast.Assert | ast.Break | ast.Continue | ast.Delete | ast.Expr
    | ast.Raise | ast.Return | ast.If | ast.For | ast.AsyncFor | ast.While | ast.Try | ast.TryStar | ast.With
    | ast.AsyncWith | ast.Match
)  # fmt: skip


class Bomb(ConventionalOperator):
    """A statement becomes one that raises `Bomb`: does any test get there, and would it notice?"""

    name = "BSR"
    rank = 110
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("move(x)\n", ("Bomb()\n",)),
        TextExample("while x:\n    move(x)\n", ("Bomb()\n", "while x:\n    Bomb()\n")),
        TextExample("def f():\n    return 1\n", ("def f():\n    Bomb()\n",)),
        TextExample('"""What it does."""\nfrom __future__ import annotations\nimport robot\n'),
        TextExample("def f():\n    global x\n    pass\n", note="nothing happens there"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, _STATEMENTS):
            return
        if isinstance(node, ast.AnnAssign) and node.value is None:
            return
        if isinstance(node, ast.Expr) and is_idle(node.value):
            return
        bomb = f"{HELPER}.fail('Bomb', 'the mutant\\'s bomb went off')"
        yield Draft("", (bomb,), shown=("Bomb()",), raises=True)
