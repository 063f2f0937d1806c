"""An index of the nodes that a module evaluates, and of their scopes, in which places are found.

Annotations, patterns of ``match``, docstrings and what is not run by a test (``if TYPE_CHECKING``,
``if __name__ == "__main__"``) are not in it, so nothing there can become a place.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

#: first line (1-based), first column, last line, last column (0-based, in UTF-8 bytes)
TextExtent = tuple[int, int, int, int]
_CallableNode = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda
Start = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Scope:
    """The function and class to which a node belongs.

    Attributes:
        name: qualified name, as in ``code.co_qualname``; ``<module>`` at the top level.
        at_import: whether its code runs while the module is imported.
        is_class: whether it is the body of a class.
    """

    name: str = "<module>"
    at_import: bool = True
    is_class: bool = False

    def function(self, name: str) -> Scope:
        """Return the scope of a function that is defined in this scope."""
        return Scope(self._inner(name), at_import=False)

    def klass(self, name: str) -> Scope:
        """Return the scope of a class that is defined in this scope; its body runs in place."""
        return Scope(self._inner(name), self.at_import, is_class=True)

    def _inner(self, name: str) -> str:
        if self.name == "<module>":
            return name
        return f"{self.name}.{name}" if self.is_class else f"{self.name}.<locals>.{name}"


@dataclass(frozen=True, slots=True)
class ScopedNode:
    """A node and its scope."""

    node: ast.expr | ast.stmt
    scope: Scope


@dataclass(slots=True)
class Index:
    """The nodes of a module that are evaluated.

    Attributes:
        expressions: by extent; None where several stand at the same place, as inside old f-strings.
        statements: by where they start.
        declared: names declared ``global`` or ``nonlocal``, by function.
    """

    expressions: dict[TextExtent, ScopedNode | None] = field(default_factory=dict)
    statements: dict[Start, ScopedNode] = field(default_factory=dict)
    declared: dict[str, tuple[str, ...]] = field(default_factory=dict)

    @classmethod
    def of(cls, tree: ast.Module) -> Index:
        """Return the index of a module."""
        index = cls()
        index._walk_all(tree.body, Scope())
        return index

    def read(self) -> Iterator[ScopedNode]:
        """Yield the expressions that are read."""
        for found in self.expressions.values():
            if found is not None and not isinstance(getattr(found.node, "ctx", None), ast.Store | ast.Del):
                yield found

    def _walk_all(self, nodes: list[ast.stmt] | list[ast.expr] | list[ast.AST], scope: Scope) -> None:
        for node in nodes:
            self._walk(node, scope)

    def _walk(self, node: ast.AST, scope: Scope) -> None:
        if is_docstring(node):
            return
        self._note(node, scope)
        if isinstance(node, _CallableNode):
            self._walk_all(_outer_of_function(node), scope)
            name = "<lambda>" if isinstance(node, ast.Lambda) else node.name
            body = [node.body] if isinstance(node, ast.Lambda) else node.body
            self._walk_all([*body], scope.function(name))
        elif isinstance(node, ast.ClassDef):
            keywords = [keyword.value for keyword in node.keywords]
            self._walk_all([*node.decorator_list, *node.bases, *keywords], scope)
            self._walk_all(node.body, scope.klass(node.name))
        else:
            self._walk_all(list(_evaluated(node)), scope)

    def _note(self, node: ast.AST, scope: Scope) -> None:
        if isinstance(node, ast.stmt):
            self.statements[node.lineno, node.col_offset] = ScopedNode(node, scope)
            if isinstance(node, ast.Global | ast.Nonlocal):
                self.declared[scope.name] = (*self.declared.get(scope.name, ()), *node.names)
        elif isinstance(node, ast.expr):
            extent = extent_of(node)
            self.expressions[extent] = None if extent in self.expressions else ScopedNode(node, scope)


def extent_of(node: ast.expr | ast.stmt) -> TextExtent:
    """Return the extent of a node in the text."""
    return (node.lineno, node.col_offset, node.end_lineno or node.lineno, node.end_col_offset or 0)


def segment_of(lines: Sequence[bytes], extent: TextExtent) -> str:
    """Return the program text at an extent, from its lines in UTF-8 without their ends."""
    first, start, last, end = extent
    found = [*lines[first - 1 : last]]
    found[-1] = found[-1][:end]
    found[0] = found[0][start:]
    return b"\n".join(found).decode()


def is_docstring(node: ast.AST) -> bool:
    """Return whether a statement consists of a string."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _outer_of_function(node: _CallableNode) -> list[ast.AST]:
    """Return the nodes that are evaluated where a function is defined."""
    defaults = [default for default in (*node.args.defaults, *node.args.kw_defaults) if default is not None]
    decorators = [] if isinstance(node, ast.Lambda) else node.decorator_list
    return [*decorators, *defaults]


def _evaluated(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the parts of a node that are evaluated in its own scope."""
    if isinstance(node, ast.AnnAssign):
        yield from (node.target, *([node.value] if node.value is not None else []))
    elif isinstance(node, ast.match_case):
        yield from (*([node.guard] if node.guard is not None else []), *node.body)
    elif isinstance(node, ast.JoinedStr):
        yield from (value for value in node.values if isinstance(value, ast.FormattedValue))
    elif isinstance(node, ast.If) and _is_never_run_by_tests(node.test):
        yield from node.orelse
    elif not type(node).__name__.startswith("TypeAlias"):
        yield from ast.iter_child_nodes(node)


def _is_never_run_by_tests(test: ast.expr) -> bool:
    if isinstance(test, ast.Compare):
        return isinstance(test.left, ast.Name) and test.left.id == "__name__"
    name = test.attr if isinstance(test, ast.Attribute) else getattr(test, "id", None)
    return name == "TYPE_CHECKING"
