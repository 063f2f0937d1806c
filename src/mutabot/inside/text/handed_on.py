"""Which expressions of the text hand on what they read, and to which call.

An operation need not be called where it is read: ``go = arm.move``, ``Thread(target=arm.move)``,
``{"home": arm.home}``. What is compared, or only looked at, is not handed on.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from .instrument import is_ours

_PLACE = "handed_to"


def note_parts(node: ast.AST) -> None:
    """Note of the parts of a node, before these are visited, where they are handed over."""
    for part in _parts(node):
        setattr(part, _PLACE, _place(node))


def is_handed_on(node: ast.expr) -> bool:
    """Whether the value of an expression is handed on."""
    return isinstance(getattr(node, "ctx", None), ast.Load) and hasattr(node, _PLACE)


def place_of(node: ast.expr) -> ast.expr:
    """The call that it is given to; the expression itself if it is given to none."""
    place: ast.expr | None = getattr(node, _PLACE, None)
    return node if place is None else place


def _place(node: ast.AST) -> ast.expr | None:
    if isinstance(node, ast.Call) and not is_ours(node.func):
        return node
    return getattr(node, _PLACE, None)


def _parts(node: ast.AST) -> Iterator[ast.expr]:
    match node:
        case ast.Call():
            if hasattr(node, _PLACE) or not is_ours(node.func):
                yield from (*node.args, *(one.value for one in node.keywords))
        case ast.Assign(targets=[ast.Name(id=name), *_]) if name.startswith("@"):  # pytest's own
            return
        case ast.Assign() | ast.NamedExpr():
            yield node.value
        case ast.AnnAssign() | ast.Return() | ast.Yield():
            if node.value is not None:
                yield node.value
        case ast.Lambda():
            yield node.body
        case ast.arguments():
            yield from (*node.defaults, *(one for one in node.kw_defaults if one is not None))
        case ast.Dict() | ast.BoolOp():
            yield from node.values
        case ast.List() | ast.Tuple() | ast.Set():
            yield from node.elts
        case ast.IfExp() if hasattr(node, _PLACE):
            yield from (node.body, node.orelse)
