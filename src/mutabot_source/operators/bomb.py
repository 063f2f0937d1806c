"""BSR: a statement becomes a bomb."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

import libcst as cst

from mutabot_source.operator import HELPER, ConventionalOperator, Draft, Surroundings, TextExample

_SIMPLE = (
    cst.Assign
    | cst.AnnAssign
    | cst.AugAssign
    | cst.Assert
    | cst.Break
    | cst.Continue
    | cst.Del
    | cst.Expr
    | cst.Raise
    | cst.Return
)
_COMPOUND = cst.If | cst.For | cst.While | cst.Try | cst.TryStar | cst.With | cst.Match


class Bomb(ConventionalOperator):
    """Replaces a statement by one that raises."""

    name = "BSR"
    rank = 110
    summary = "A statement raises as soon as it is reached: does any test get there, and would it notice?"
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("move(x)\n", ("Bomb()\n",)),
        TextExample("while x:\n    move(x)\n", ("Bomb()\n", "while x:\n    Bomb()\n")),
        TextExample("def f():\n    return 1\n", ("def f():\n    Bomb()\n",)),
        TextExample('"""What it does."""\nfrom __future__ import annotations\nimport robot\n'),
        TextExample("def f():\n    global x\n    pass\n", note="nothing happens there"),
    )

    def drafts(self, node: cst.CSTNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, _SIMPLE | _COMPOUND):
            return
        if isinstance(node, cst.AnnAssign) and node.value is None:
            return
        if isinstance(node, cst.Expr) and isinstance(
            node.value, cst.SimpleString | cst.ConcatenatedString | cst.Ellipsis
        ):
            return
        bomb = f"{HELPER}.fail('Bomb', 'the mutant\\'s bomb went off')"
        yield Draft("", (bomb,), shown=("Bomb()",), raises=True)
