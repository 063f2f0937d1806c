"""representation: an orientation or angle is taken in another notation."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable
from typing import ClassVar

from mutabot_source.extension import BUGS
from mutabot_source.operator import (
    ConventionalOperator,
    Draft,
    Surroundings,
    SyntaxNode,
    TextExample,
    TextParts,
)

from ._calls import call, last_name

#: keywords by which libraries choose between two notations
_CHOOSING = {
    "degrees", "deg", "in_degrees", "radians", "scalar_first", "scalar_last", "wxyz", "extrinsic",
    "intrinsic",
}  # fmt: skip
_OTHER_WAY = {
    "radians": "degrees", "degrees": "radians", "deg2rad": "rad2deg", "rad2deg": "deg2rad",
    "to_radians": "to_degrees", "to_degrees": "to_radians",
}  # fmt: skip
_KINDS = "quaternion|quat|euler|rpy|matrix|rotvec"
_CONVERTING = re.compile(rf"^({_KINDS})_from_({_KINDS})$|^({_KINDS})_?(to|2)_?({_KINDS})$", re.IGNORECASE)
_AXES = re.compile(r"[rs]?([xyz])(?!\1)([xyz])(?:(?!\2)[xyz])?|([XYZ])(?!\3)([XYZ])(?:(?!\4)[XYZ])?")


class Representation(ConventionalOperator):
    """An orientation or angle is taken in another notation than it has.

    The order and the kind of the axes of Euler angles, the scalar part of a quaternion at the other end,
    degrees for radians, Euler angles where a quaternion is wanted.

    Where: texts of axes, keywords and functions of the usual libraries that choose a notation or convert
    between two, and rows of w, x, y and z.

    Stands for: Notations of two libraries mixed: 1 of 253 silent bugs of public robot programs exactly, 0
    nearly.
    """

    name = "representation"
    family = BUGS
    rank = 310
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample(
            "r = from_euler('xyz', a)\n", ("r = from_euler('XYZ', a)\n", "r = from_euler('zyx', a)\n")
        ),
        TextExample(
            "m = euler_matrix(a, b, c, 'sxyz')\n",
            (
                "m = euler_matrix(a, b, c, 'rxyz')\n",
                "m = euler_matrix(a, b, c, 'szyx')\n",
            ),
        ),
        TextExample("r = f(a, degrees=True)\n", ("r = f(a, degrees=False)\n",)),
        TextExample("y = math.radians(x)\n", ("y = math.degrees(x)\n",)),
        TextExample("r = [q.w, q.x, q.y, q.z]\n", ("r = [q.x, q.y, q.z, q.w]\n",)),
        TextExample("send(x, quaternion_from_euler(a, b, c))\n", ("send(x, (a, b, c))\n",)),
        TextExample("y = radians(x)\n", note="whether the other function is there is not known"),
        TextExample("move('xy')\n", note="not named like Euler angles"),
        TextExample("r = [a, b, c, d]\n"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if isinstance(node, ast.Call):
            yield from _of_call(node)
        elif isinstance(node, ast.List | ast.Tuple):
            yield from _of_row(node)


def _of_call(node: ast.Call) -> Iterable[Draft]:
    name = last_name(node.func)
    if "euler" in name.lower() or name.lower().endswith("rpy"):
        for given in node.args:
            for variant, other in _other_axes(given):
                yield Draft(variant, _with_text(node, given, repr(other)))
    for keyword in node.keywords:
        value = keyword.value
        is_choice = (
            keyword.arg in _CHOOSING and isinstance(value, ast.Constant) and isinstance(value.value, bool)
        )
        if is_choice and isinstance(value, ast.Constant):
            yield Draft(str(keyword.arg), _with_text(node, value, repr(not value.value)))
    if (
        name in _OTHER_WAY
        and isinstance(node.func, ast.Attribute)
        and len(node.args) == 1
        and not node.keywords
    ):
        yield Draft(_OTHER_WAY[name], (node.func.value, f".{_OTHER_WAY[name]}(", node.args[0], ")"))
    if (
        _CONVERTING.match(name)
        and node.args
        and not any(isinstance(argument, ast.Starred) for argument in node.args)
    ):
        yield Draft("unconverted", _row(node.args))


def _other_axes(node: ast.expr) -> Iterable[tuple[str, str]]:
    """Yield other axes for a text: of the other kind (static or rotating), and in the reverse order."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str) and _AXES.fullmatch(node.value):
        text = node.value
        lead = text[0] if text[0] in "rs" else ""
        swapped = {"r": "s", "s": "r", "": ""}[lead]
        yield "axes", swapped + text[len(lead) :] if lead else text.swapcase()
        backwards = text[len(lead) :][::-1]
        if backwards != text[len(lead) :]:
            yield "order", lead + backwards


def _of_row(node: ast.List | ast.Tuple) -> Iterable[Draft]:
    names = [re.sub(r"^.*?([wxyz])$", r"\1", last_name(element)) for element in node.elts]
    if not isinstance(node.ctx, ast.Load) or "".join(names) not in ("wxyz", "xyzw"):
        return
    first, *rest = node.elts
    turned = [*rest, first] if names[0] == "w" else [node.elts[-1], *node.elts[:-1]]
    yield Draft("scalar", _row(turned, "[]" if isinstance(node, ast.List) else "()"))


def _row(values: list[ast.expr], brackets: str = "()") -> TextParts:
    if len(values) == 1:
        return (values[0],)
    parts: list[str | ast.expr] = [brackets[0]]
    for number, value in enumerate(values):
        parts += [", "] if number else []
        parts.append(value)
    return (*parts, brackets[1])


def _with_text(node: ast.Call, argument: ast.expr, text: str) -> TextParts:
    """Return the call with a text as one of its arguments."""
    return tuple(text if part is argument else part for part in call(node, node.keywords))
