"""Where a node stands, as far as operators want to know."""

from __future__ import annotations

from collections.abc import Callable

import libcst as cst

from .operator import Surroundings

Parent = Callable[[cst.CSTNode], cst.CSTNode | None]


def surroundings(node: cst.CSTNode, parent_of: Parent) -> Surroundings:
    """Where a node stands."""
    parent = parent_of(node)
    if parent is None:
        return Surroundings()
    return Surroundings(
        is_value=not _is_looked_into(node, parent),
        is_condition=_is_condition(node, parent_of),
        is_operand_of_unary=isinstance(parent, cst.UnaryOperation),
        is_callee=isinstance(parent, cst.Decorator) or (isinstance(parent, cst.Call) and node is parent.func),
        is_argument=isinstance(parent, cst.Arg) and isinstance(parent_of(parent), cst.Call),
    )


def is_variable(node: cst.CSTNode, around: Surroundings) -> bool:
    """Whether a node is a name that stands for a value, rather than for what is called."""
    return isinstance(node, cst.Name) and not around.is_callee and node.value not in ("None", "True", "False")


def _is_looked_into(node: cst.CSTNode, parent: cst.CSTNode) -> bool:
    if isinstance(parent, cst.Call):
        return node is parent.func
    if isinstance(parent, cst.Attribute | cst.Subscript):
        return node is parent.value
    return isinstance(parent, cst.Decorator | cst.Expr)


def _is_condition(node: cst.CSTNode, parent_of: Parent) -> bool:
    """Whether only the truth of a value matters."""
    parent = parent_of(node)
    if isinstance(parent, cst.If | cst.While | cst.IfExp | cst.Assert | cst.CompIf):
        return node is parent.test
    if isinstance(parent, cst.MatchCase):
        return node is parent.guard
    if isinstance(parent, cst.UnaryOperation):
        return isinstance(parent.operator, cst.Not)
    return isinstance(parent, cst.BooleanOperation) and _is_condition(parent, parent_of)
