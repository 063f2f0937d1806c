"""Nodes of a syntax tree: their extents and surroundings, and alternatives to them as text.

Alternatives are text for the compiler with what is kept named, and for people as it would read.
"""

from __future__ import annotations

import ast
from collections.abc import Callable

from mutabot.api.faults import Alternative

from .index import Scope, TextExtent, extent_of, segment_of
from .neighbours import Neighbours
from .operator import Surroundings, SyntaxNode, TextParts

_DefinitionNode = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


class ModuleTree:
    """The syntax tree of a module, with its text.

    Args:
        text: the program text, with ``\n`` at the ends of lines.
        tree: its tree.
    """

    def __init__(self, text: str, tree: ast.Module) -> None:
        self._lines = [line.encode() for line in text.split("\n")]
        self._neighbours = Neighbours(tree)
        self._parents: dict[ast.AST, ast.AST] = {}
        self._formatted: set[ast.AST] = set()
        for node in ast.walk(tree):  # from the outside in
            is_formatted = isinstance(node, ast.JoinedStr) or node in self._formatted
            for child in ast.iter_child_nodes(node):
                self._parents[child] = node
                if is_formatted:
                    self._formatted.add(child)

    def segment(self, extent: TextExtent) -> str:
        """Return the program text at an extent; columns count bytes of UTF-8."""
        return segment_of(self._lines, extent)

    def has_valid_extent(self, node: SyntaxNode) -> bool:
        """Return whether a node's extent is right; before Python 3.12 it may be wrong within f-strings."""
        if node not in self._formatted:
            return True
        try:
            there = ast.parse(f"({self.segment(extent_of(node))})", mode="eval").body
        except (SyntaxError, UnicodeDecodeError, IndexError):
            return False
        return ast.dump(there) == ast.dump(node)

    def is_elif(self, node: SyntaxNode) -> bool:
        """Return whether a statement begins with ``elif``."""
        return isinstance(node, ast.If) and self._lines[node.lineno - 1][node.col_offset :].startswith(b"el")

    def surroundings(self, node: SyntaxNode, scope: Scope) -> Surroundings:
        """Return the surroundings of a node in this scope."""
        parent = self._parents[node]
        is_callee = _is_decorator(node, parent) or (isinstance(parent, ast.Call) and node is parent.func)
        return Surroundings(
            is_value=not is_callee and not _is_looked_into(node, parent),
            is_condition=self._is_condition(node),
            is_operand_of_unary=isinstance(parent, ast.UnaryOp),
            is_callee=is_callee,
            is_argument=self._is_argument(node),
            is_loop=self._is_loop(node),
            function=scope.name.rpartition(".")[2],
            neighbour=self._neighbours.next_of(node),
        )

    def _is_argument(self, node: ast.AST) -> bool:
        parent = self._parents[node]
        if isinstance(parent, ast.keyword | ast.Starred):
            return self._is_argument(parent)
        return isinstance(parent, ast.Call) and node is not parent.func

    def _is_loop(self, node: ast.AST) -> bool:
        parent = self._parents[node]
        if isinstance(parent, ast.BoolOp | ast.UnaryOp):
            return self._is_loop(parent)
        return isinstance(parent, ast.While) and node is parent.test

    def _is_condition(self, node: SyntaxNode) -> bool:
        """Return whether only the truth of a node's value matters."""
        match self._parents[node]:
            case ast.If() | ast.While() | ast.IfExp() | ast.Assert() as parent:
                return node is parent.test
            case ast.comprehension() as parent:
                return node in parent.ifs
            case ast.match_case() as parent:
                return node is parent.guard
            case ast.UnaryOp() as parent:
                return isinstance(parent.op, ast.Not)
            case ast.BoolOp() as parent:
                return self._is_condition(parent)
        return False


def is_variable(node: SyntaxNode, around: Surroundings) -> bool:
    """Return whether a node is a name of a value, rather than of what is called."""
    return isinstance(node, ast.Name) and not around.is_callee


def _is_decorator(node: SyntaxNode, parent: ast.AST) -> bool:
    return isinstance(parent, _DefinitionNode) and node in parent.decorator_list


def _is_looked_into(node: SyntaxNode, parent: ast.AST) -> bool:
    if isinstance(parent, ast.Attribute | ast.Subscript):
        return node is parent.value
    return isinstance(parent, ast.Expr)


#: longer texts are cut in ids and descriptions
TEXT_LIMIT = 60
#: what needs no parentheses wherever it stands
_ATOMS = ast.Name | ast.Attribute | ast.Subscript | ast.Call | ast.Constant


def template(parts: TextParts, number_of: Callable[[ast.expr], int]) -> str:
    """Return the parts as text, with a name for each node that is kept."""
    return _joined(parts, lambda node: Alternative.kept_name(number_of(node)))


def to_source(parts: TextParts, text_of: Callable[[ast.expr], str]) -> str:
    """Return the parts as program text, with parentheses only where they are needed."""
    bare = _joined(parts, text_of)
    if len(parts) == 1 or all(isinstance(part, str | _ATOMS) for part in parts):
        return bare
    wrapped = _joined(parts, lambda node: f"({text_of(node)})")
    if same_program(bare, wrapped):
        return bare
    return _joined(parts, lambda node: text_of(node) if isinstance(node, _ATOMS) else f"({text_of(node)})")


def same_program(first: str, second: str) -> bool:
    """Return whether two texts parse to the same program."""
    try:
        return ast.dump(ast.parse(first)) == ast.dump(ast.parse(second))
    except SyntaxError:
        return False


def shortened(text: str) -> str:
    """Return a text as one line of limited length."""
    text = " ".join(text.split())
    return text if len(text) <= TEXT_LIMIT else text[: TEXT_LIMIT - 1] + "…"


def _joined(parts: TextParts, text_of: Callable[[ast.expr], str]) -> str:
    return "".join(part if isinstance(part, str) else text_of(part) for part in parts)
