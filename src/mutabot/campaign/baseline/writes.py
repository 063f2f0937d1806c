"""Find the expressions of a file through which something is written.

What a name stands for is taken from all assignments of its function, whichever comes first; of an attribute,
from those of the file. So more may be found than is written, never less of what stands in one file.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import TYPE_CHECKING

from mutabot.languages.python import extent_of
from mutabot.model.source_units import FunctionNode

if TYPE_CHECKING:
    from mutabot.model.mutant import Extent


#: methods of arrays and containers that change them
_CHANGING = frozenset(
    {
        "add", "append", "clear", "discard", "extend", "fill", "insert", "itemset", "partition", "pop",
        "popitem", "put", "remove", "resize", "reverse", "setdefault", "setfield", "sort", "update",
    }
)  # fmt: skip
#: functions that change their first argument
_CHANGING_FIRST = frozenset(
    {"copyto", "fill_diagonal", "place", "put", "put_along_axis", "putmask", "shuffle", "setattr", "setitem"}
)
#: functions and methods that return another view of the same memory
_VIEWS = frozenset(
    {
        "asarray", "asanyarray", "ascontiguousarray", "atleast_1d", "atleast_2d", "diagonal", "ravel",
        "reshape", "squeeze", "swapaxes", "transpose", "view",
    }
)  # fmt: skip


def written_through(source: str) -> frozenset[Extent]:
    """Return the extents of all expressions through which something is written. Raises SyntaxError."""
    writes = _Writes()
    writes.visit(ast.parse(source))
    for scope, node in writes.writes:
        writes.follow(scope, node)
    return frozenset(writes.found)


class _Writes(ast.NodeVisitor):
    """A visitor that collects, function by function, what is assigned and what is written to.

    Attributes:
        found: what is written through.
        writes: what stands before the ``[…]``, the ``.name`` or the method by which it is changed.
    """

    def __init__(self) -> None:
        self.found: set[Extent] = set()
        self.writes: list[tuple[int, ast.expr]] = []
        #: what a name of a function, an attribute or a call of a function may stand for
        self._values: dict[tuple[int, str], list[tuple[int, ast.expr]]] = {}
        self._scope, self._function = 0, ""

    def visit(self, node: ast.AST) -> None:
        """Visit a node and all below it."""
        before = self._scope, self._function
        if isinstance(node, FunctionNode):
            self._scope, self._function = id(node), node.name
        match node:
            case ast.Return(value=ast.expr() as value):
                self._add(0, f"{self._function}()", value)
            case ast.Call():
                self._write(*_changed_by(node))
            case ast.Assign() | ast.Delete():
                for target in node.targets:
                    self._assign(target, node.value if isinstance(node, ast.Assign) else None)
            case ast.AnnAssign(value=ast.expr() as value) | ast.NamedExpr(value=value):
                self._assign(node.target, value)
            case ast.For() | ast.AsyncFor() | ast.comprehension():
                self._assign(node.target, node.iter)  # an item may be a part of the same memory
            case ast.withitem(optional_vars=ast.expr() as target):
                self._assign(target, node.context_expr)
            case ast.AugAssign():
                if isinstance(node.target, ast.Name):  # in place, where it can be
                    self._write(node.target)
                self._assign(node.target, None)
        self.generic_visit(node)
        self._scope, self._function = before

    def _add(self, scope: int, name: str, value: ast.expr) -> None:
        self._values.setdefault((scope, name), []).append((self._scope, value))

    def _write(self, *nodes: ast.expr) -> None:
        self.writes += [(self._scope, node) for node in nodes]

    def _assign(self, target: ast.expr, value: ast.expr | None) -> None:
        if isinstance(target, ast.Tuple | ast.List):
            for part in target.elts:
                self._assign(part, value)
        elif isinstance(target, ast.Starred):
            self._assign(target.value, value)
        elif isinstance(target, ast.Subscript | ast.Attribute):
            self._write(target.value)
        if value is not None and isinstance(target, ast.Name | ast.Attribute):
            scope = self._scope if isinstance(target, ast.Name) else 0
            self._add(scope, ast.unparse(target), value)

    def follow(self, scope: int, node: ast.expr) -> None:
        """Mark an expression as written through, and all expressions that it is a part or an alias of."""
        if extent_of(node) in self.found:
            return
        self.found.add(extent_of(node))
        parts: list[ast.expr] = []
        names = [(0, ast.unparse(node))]
        match node:
            case ast.Subscript() | ast.Attribute() | ast.Starred() | ast.Await() | ast.NamedExpr():
                parts = [node.value]
            case ast.Name():
                names = [(scope, node.id)]
            case ast.IfExp():
                parts = [node.body, node.orelse]
            case ast.BoolOp():
                parts = node.values
            case ast.Tuple() | ast.List():
                parts = node.elts
            case ast.Call():
                name = _name_of(node.func)
                names = [(0, f"{name}()")]
                if name in _VIEWS:
                    seen = [node.func.value] if isinstance(node.func, ast.Attribute) else []
                    parts = [*seen, *node.args[:1]]
        for part in parts:
            self.follow(scope, part)
        for where, value in (pair for name in names for pair in self._values.get(name, ())):
            self.follow(where, value)


def _changed_by(node: ast.Call) -> Iterator[ast.expr]:
    """Yield the expressions that a call changes, by the name and arguments of the call."""
    name = _name_of(node.func)
    if name in _CHANGING and isinstance(node.func, ast.Attribute):
        yield node.func.value
    if name in _CHANGING_FIRST and node.args:
        yield node.args[0]
    yield from (keyword.value for keyword in node.keywords if keyword.arg == "out")


def _name_of(function: ast.expr) -> str:
    if isinstance(function, ast.Attribute):
        return function.attr
    return function.id if isinstance(function, ast.Name) else ""
