"""lost-conversion: a value is used as it is, where it should have been converted."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable
from typing import ClassVar

from mutabot_source.extension import BUGS
from mutabot_source.operator import ConventionalOperator, Draft, Surroundings, SyntaxNode, TextExample, each

from ._calls import last_name

#: parts of the names of functions that make a value of one kind of another one of it
_CONVERTING = re.compile(
    r"(^|_)(radians|degrees|deg2rad|rad2deg|to_rad|to_deg|inv|inverse|inverted|transpose|normali[sz]e|wrap|fold|"
    r"unwrap|clip|clamp|limit|limited|clipped|saturate|copysign|sqrt|abs|fabs|mirror|mirrored|flip|transform|"
    r"transformed|rotate|rotated|convert|remap|scale|scaled|angle_diff|filtered)(_|\d|$)",
    re.IGNORECASE,
)
_ATTRIBUTES = {"T", "inv", "inverse"}


class LostConversion(ConventionalOperator):
    """A value is used as it is, where it should be converted, transformed, inverted, folded or limited.

    Where: calls of functions that are called like a conversion, the attribute T, and limits by min and max.

    Stands for: A transform or its inverse forgotten, an angle not folded, a limit gone: 7 of 253 silent
    bugs of public robot programs exactly, 3 nearly.
    """

    name = "lost-conversion"
    is_common = True
    family = BUGS
    rank = 230
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("goal = math.radians(angle)\n", ("goal = angle\n",)),
        TextExample("goal = frame.inv() @ pose\n", ("goal = frame @ pose\n",)),
        TextExample("goal = R.T\n", ("goal = R\n",)),
        TextExample("turn = wrap_angle(a - b, pi)\n", ("turn = a - b\n",)),
        TextExample("v = min(x, high)\n", each("v = {}\n", "x, high")),
        TextExample("go(x)\n", note="not called like a conversion"),
        TextExample("min(*values)\n"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if isinstance(node, ast.Attribute) and node.attr in _ATTRIBUTES and not around.is_callee:
            yield Draft("", (node.value,))
        if not isinstance(node, ast.Call) or any(isinstance(argument, ast.Starred) for argument in node.args):
            return
        name = last_name(node.func)
        if name in ("min", "max") and len(node.args) == 2 and not node.keywords:
            yield from (
                Draft(f"{number}", (expression,)) for number, expression in enumerate(node.args, start=1)
            )
        elif _CONVERTING.search(name) and node.args and not _is_idle_statement(around):
            yield Draft("", (node.args[0],))
        elif _CONVERTING.search(name) and isinstance(node.func, ast.Attribute) and around.is_value:
            yield Draft("", (node.func.value,))


def _is_idle_statement(around: Surroundings) -> bool:
    """Return whether the call's value is unused, so that it is called for its effect."""
    return not around.is_value
