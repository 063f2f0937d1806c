"""lost-argument: an argument is not handed on."""

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
    each,
)

from ._calls import call


class LostArgument(ConventionalOperator):
    """An argument that a call names is not handed on, so that its default acts.

    Where: calls with arguments by name.

    Stands for: An optional argument lost, such as blocking, a tolerance, a time-out or a joint bias: 5 of
    253 silent bugs of public robot programs exactly, 4 nearly.
    """

    name = "lost-argument"
    is_common = True
    family = BUGS
    rank = 200
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("arm.move(x, wait=True, *more)\n", ("arm.move(x, *more)\n",)),
        TextExample("move(x, speed=v, **given)\n", ("move(x, **given)\n",)),
        TextExample("move(speed=v, force=f)\n", each("move({})\n", "force=f, speed=v")),
        TextExample("move(x, 0.5)\n", note="what a call gives by position, it most often must give"),
        TextExample("f(x for x in y)\n"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, ast.Call) or any(
            isinstance(argument, ast.GeneratorExp) for argument in node.args
        ):
            return
        for lost in node.keywords:
            if lost.arg is not None:
                yield Draft(
                    lost.arg, call(node, [keyword for keyword in node.keywords if keyword is not lost])
                )
