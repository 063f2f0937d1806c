"""Nodes of the concrete syntax tree: where they stand, and alternatives to them as text.

Alternatives are text for the compiler with what is kept named, and for people as it would read.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping

import libcst as cst
from libcst.metadata import CodeRange

from mutabot.model.mutant import Extent, kept_name

from .operator import Surroundings

_LINE_ENDS = re.compile(r"\r\n|\r|\n")


class Extents:
    """Extents of nodes in one module.

    Columns of the concrete tree count characters, those of ``ast`` bytes of UTF-8; a tuple's parentheses
    belong to the tuple in ``ast``, other parentheses to nothing.
    """

    def __init__(self, text: str, ranges: Mapping[cst.CSTNode, CodeRange]) -> None:
        self._lines = _LINE_ENDS.split(text)
        self._ranges = ranges

    def of(self, node: cst.CSTNode) -> Extent:
        """Where a node stands."""
        first = last = node
        if isinstance(node, cst.Tuple | cst.GeneratorExp) and node.lpar:
            first, last = node.lpar[-1], node.rpar[0]
        start, end = self._ranges[first].start, self._ranges[last].end
        return (
            start.line,
            self._column(start.line, start.column),
            end.line,
            self._column(end.line, end.column),
        )

    def segment(self, extent: Extent) -> str:
        """The program text at an extent."""
        first, start, last, end = extent
        lines = [line.encode() for line in self._lines[first - 1 : last]]
        lines[-1] = lines[-1][:end]
        lines[0] = lines[0][start:]
        return b"\n".join(lines).decode()

    def _column(self, line: int, column: int) -> int:
        text = self._lines[line - 1]
        return column if text.isascii() else len(text[:column].encode())


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


#: longer texts are cut in ids and descriptions
TEXT_LIMIT = 60
Parts = tuple[str | cst.CSTNode, ...]


def template(parts: Parts, number_of: Callable[[cst.CSTNode], int]) -> str:
    """The parts with a name for each node that is kept."""
    return "".join(part if isinstance(part, str) else kept_name(number_of(part)) for part in parts)


def shown(parts: Parts, text_of: Callable[[cst.CSTNode], str]) -> str:
    """The parts as program text, with parentheses only where they are needed."""
    bare = _joined(parts, text_of)
    if len(parts) == 1:
        return bare
    wrapped = _joined(parts, lambda node: f"({text_of(node)})")
    return bare if same_program(bare, wrapped) else _joined(parts, lambda node: _wrapped(node, text_of))


def same_program(one: str, other: str) -> bool:
    """Whether two texts mean the same to the parser."""
    try:
        return ast.dump(ast.parse(one)) == ast.dump(ast.parse(other))
    except SyntaxError:
        return False


def shortened(text: str) -> str:
    """One line of limited length."""
    text = " ".join(text.split())
    return text if len(text) <= TEXT_LIMIT else text[: TEXT_LIMIT - 1] + "…"


def _joined(parts: Parts, text_of: Callable[[cst.CSTNode], str]) -> str:
    return "".join(part if isinstance(part, str) else text_of(part) for part in parts)


def _wrapped(node: cst.CSTNode, text_of: Callable[[cst.CSTNode], str]) -> str:
    atoms = cst.Name | cst.Attribute | cst.Subscript | cst.Call | cst.Integer | cst.Float | cst.SimpleString
    return text_of(node) if isinstance(node, atoms) else f"({text_of(node)})"
