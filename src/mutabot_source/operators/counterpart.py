"""counterpart: left is taken for right."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable
from typing import ClassVar

from mutabot_source.extension import BUGS
from mutabot_source.operator import ConventionalOperator, Draft, Surroundings, SyntaxNode, TextExample

_PAIRS = (
    "left right", "front back", "front rear", "upper lower", "first second", "leader follower",
    "master slave", "red blue", "start end", "pan tilt", "roll pitch", "width height", "x y", "source target",
)  # fmt: skip
_OTHERS = {first: second for pair in reversed(_PAIRS) for first, second in (pair.split(), pair.split()[::-1])}
_PART = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+|[^A-Za-z\d]+")


class Counterpart(ConventionalOperator):
    """A name or text that has a counterpart is taken for it: left for right, front for back, x for y.

    Where: names, attributes and texts with such a word in them; whether the other name is there is not known.

    Stands for: The other arm, gripper, wheel, channel or component: 6 of 253 silent bugs of public robot
    programs exactly, 5 nearly.
    """

    name = "counterpart"
    is_common = True
    family = BUGS
    rank = 260
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("left_gripper.close()\n", ("right_gripper.close()\n",)),
        TextExample("speed = twist.linear.x\n", ("speed = twist.linear.y\n",)),
        TextExample("move('front_left')\n", ("move('back_left')\n", "move('front_right')\n")),
        TextExample("go = moveLeft\n", ("go = moveRight\n",)),
        TextExample("left = 1\n", note="only where a name is read"),
        TextExample("move(leftover)\n", note="not a word by itself"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if isinstance(node, ast.Name):
            yield from (Draft(word, (other,)) for word, other in _counterparts(node.id))
        elif isinstance(node, ast.Attribute):
            yield from (Draft(word, (node.value, f".{other}")) for word, other in _counterparts(node.attr))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and len(node.value) <= 60:
            found = _counterparts(node.value)  # "x" alone may be any text
            yield from (Draft(word, (repr(other),)) for word, other in found if len(word) > 1)


def _counterparts(text: str) -> Iterable[tuple[str, str]]:
    """Yield each word of a text that has a counterpart, and the text with the counterpart instead."""
    parts = _PART.findall(text)
    if "".join(parts) != text or " " in text:
        return
    for number, part in enumerate(parts):
        other = _OTHERS.get(part.lower())
        if other is not None and (len(part) > 1 or part.islower()):
            like = other.upper() if part.isupper() else other.capitalize() if part[0].isupper() else other
            yield part.lower(), "".join([*parts[:number], like, *parts[number + 1 :]])
