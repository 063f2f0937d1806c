"""lost-reset: a state of the last run is left over."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import ClassVar

from mutabot_source.extension import BUGS
from mutabot_source.operator import ConventionalOperator, Draft, Surroundings, SyntaxNode, TextExample

from ._calls import last_name

_INITIAL = ("__init__", "__new__", "__post_init__", "__enter__", "setUp", "<module>")
_RESETTING = ("clear", "reset")
_EMPTY = {"list", "dict", "set", "deque"}


class LostReset(ConventionalOperator):
    """An attribute is not set back to nothing, so that what an earlier run left there acts on.

    Where: assignments of None, False, zero or something empty to attributes, outside of constructors, and
    clear and reset.

    Stands for: A flag, a sum or a request of the last run handed on: 1 of 253 silent bugs of public robot
    programs exactly, 1 nearly.
    """

    name = "lost-reset"
    family = BUGS
    rank = 280
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample(
            "def run(self):\n    self.failed = False\n    self.go()\n",
            ("def run(self):\n    pass\n    self.go()\n",),
        ),
        TextExample("def run(self):\n    self.path = []\n", ("def run(self):\n    pass\n",)),
        TextExample("def run(self):\n    self.path.clear()\n", ("def run(self):\n    pass\n",)),
        TextExample("def __init__(self):\n    self.failed = False\n", note="there it has no value yet"),
        TextExample("def run(self):\n    self.failed = True\n", note="not set back"),
        TextExample("def run(self):\n    failed = False\n", note="no other run knows it"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if around.function not in _INITIAL and (_resets(node) or _clears(node)):
            yield Draft("", ("pass",))


def _resets(node: SyntaxNode) -> bool:
    if isinstance(node, ast.Assign):
        return all(isinstance(target, ast.Attribute) for target in node.targets) and _is_nothing(node.value)
    return (
        isinstance(node, ast.AnnAssign)
        and isinstance(node.target, ast.Attribute)
        and (node.value is not None and _is_nothing(node.value))
    )


def _clears(node: SyntaxNode) -> bool:
    """Return whether a statement clears something that an object stores."""
    if not isinstance(node, ast.Expr) or not isinstance(node.value, ast.Call):
        return False
    function = node.value.func
    return (
        isinstance(function, ast.Attribute)
        and isinstance(function.value, ast.Attribute)
        and function.attr in _RESETTING
    )


def _is_nothing(node: ast.expr) -> bool:
    match node:
        case ast.Constant():
            return not node.value
        case ast.List() | ast.Tuple() | ast.Set():
            return all(_is_nothing(element) for element in node.elts)
        case ast.Dict():
            return not node.keys
        case ast.Call():
            return last_name(node.func) in _EMPTY and not node.args and not node.keywords
    return False
