"""wrong-side: a transform is multiplied from the wrong side."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import ClassVar

from mutabot_source.extension import BUGS
from mutabot_source.operator import ConventionalOperator, Draft, Surroundings, SyntaxNode, TextExample


class WrongSide(ConventionalOperator):
    """The factors of a product of matrices are exchanged, as where a transform comes from the wrong side.

    Where: the operator @, and * between transforms by their names: a rotation, pose, transform or quaternion.

    Stands for: Tool for base, one frame for the other: 2 of 253 silent bugs of public robot programs
    exactly, 0 nearly.
    """

    name = "wrong-side"
    family = BUGS
    rank = 220
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("pose = base @ tool\n", ("pose = tool @ base\n",)),
        TextExample("turned = rotation * pose\n", ("turned = pose * rotation\n",)),
        TextExample("x = a * b\n", note="numbers have no sides"),
        TextExample("x = a @ a\n", note="they are the same"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, ast.BinOp) or ast.dump(node.left) == ast.dump(node.right):
            return
        is_product = isinstance(node.op, ast.Mult) and _is_transform(node.left) and _is_transform(node.right)
        if isinstance(node.op, ast.MatMult) or is_product:
            yield Draft("", (node.right, " @ " if isinstance(node.op, ast.MatMult) else " * ", node.left))


def _is_transform(node: ast.expr) -> bool:
    names = " ".join(getattr(inner, "attr", getattr(inner, "id", "")) for inner in ast.walk(node)).lower()
    return any(part in names for part in ("rotation", "pose", "transform", "quaternion", "frame", "rot_"))
