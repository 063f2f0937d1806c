"""SVR: another variable of the same type.

Which variables there are, and of what type, is known from the baseline; so this operator is asked once more
after it, with what was seen (``with_variables``).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

from mutabot.api.faults import Alternative
from mutabot_source.operator import ConventionalOperator, Draft, Surroundings, SyntaxNode, TextExample


class VariableReplacement(ConventionalOperator):
    """A variable becomes another one in scope that had a value of the same type."""

    name = "SVR"
    is_common = True
    rank = 100
    asks_variables = True
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("move(x)\n", ("move(y)\n", "move(z)\n"), variables={"x": ("y", "z")}),
        TextExample(
            "box.lift()\n",
            ("lid.lift()\n",),
            variables={"box": ("lid",)},
            kinds={"box": "cell:Part"},
        ),
        TextExample("move(x)\n", note="no other variable had its type"),
        TextExample("x = 1\n", variables={"x": ("y",)}, note="only where a variable is read"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        return ()

    def with_variables(self, names: Iterable[str]) -> Iterable[Alternative]:
        return [Alternative(self.name, name, name, name) for name in names]
