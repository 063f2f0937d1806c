"""neighbour-value: a waypoint is taken for its neighbour."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import ClassVar

from mutabot_source.extension import BUGS
from mutabot_source.operator import ConventionalOperator, Draft, Surroundings, SyntaxNode, TextExample


class NeighbourValue(ConventionalOperator):
    """A fixed value that a call gets is the one that the next call of the same function in the file gets.

    Where: numbers, texts, rows and named constants as arguments and keys, where the file has another one at
    the same argument of a function of the same name.

    Stands for: A waypoint, named pose, label or limit taken for another: 2 of 253 silent bugs of public robot
    programs exactly, 1 nearly.
    """

    name = "neighbour-value"
    is_common = True
    family = BUGS
    rank = 270
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample(
            "move('pick')\nmove('place')\n",
            ("move('place')\nmove('place')\n", "move('pick')\nmove('pick')\n"),
        ),
        TextExample("go(HOME)\ngo(BIN)\n", ("go(BIN)\ngo(BIN)\n", "go(HOME)\ngo(HOME)\n")),
        TextExample(
            "a = poses['home'] + poses['bin']\n",
            (
                "a = poses['bin'] + poses['bin']\n",
                "a = poses['home'] + poses['home']\n",
            ),
        ),
        TextExample("move('pick')\nmove(2)\n", note="a text is no number"),
        TextExample("move(x)\nmove(y)\n", note="variables may not be known there"),
        TextExample("print('one')\nprint('two')\n", note="for people alone"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if around.neighbour is not None:
            yield Draft("", (ast.unparse(around.neighbour),))
