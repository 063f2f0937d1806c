"""From spans to sites: the text of a call and its number, as the file's language has them; what is written.

What a name stands for is taken from all assignments of its function, whichever comes first; of an attribute,
from those of the file. So more may be found than is written, never less of what stands in one file.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mutabot.languages.front_end import Name, front_end_of
from mutabot.languages.python import FRONT_END as PYTHON
from mutabot.languages.python import extent_of, unused_calls
from mutabot.model import Role, Site, Span
from mutabot.model.events import SiteSeen
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
_Function = ast.FunctionDef | ast.AsyncFunctionDef


def written_through(source: str) -> frozenset[Extent]:
    """Where all expressions of a file stand through which something is written. Raises SyntaxError."""
    tree = ast.parse(source)
    file = _File()
    scopes = [_Scope(file), *(_Scope(file) for node in ast.walk(tree) if isinstance(node, _Function))]
    functions = [node for node in ast.walk(tree) if isinstance(node, _Function)]
    for scope, root in zip(scopes, [tree, *functions], strict=True):
        scope.read(root)
    for scope in scopes:
        for written in scope.writes:
            scope.follow(written)
    return frozenset(file.found)


@dataclass(slots=True)
class _File:
    """What is known of a whole file.

    Attributes:
        found: what is written through.
        attributes: what is assigned to an attribute, by its text, and in which function.
        returned: what functions return, by their names.
    """

    found: set[Extent] = field(default_factory=set)
    attributes: dict[str, list[tuple[_Scope, ast.expr]]] = field(default_factory=dict)
    returned: dict[str, list[tuple[_Scope, ast.expr]]] = field(default_factory=dict)


@dataclass(slots=True)
class _Scope:
    """A function, or the module.

    Attributes:
        writes: what stands before the ``[…]``, the ``.name`` or the method by which it is changed.
    """

    file: _File
    names: dict[str, list[ast.expr]] = field(default_factory=dict)
    writes: list[ast.expr] = field(default_factory=list)

    def read(self, root: ast.AST) -> None:
        """Look at all that stands in it."""
        name = root.name if isinstance(root, _Function) else ""
        for node in _within(root):
            if isinstance(node, ast.Return) and node.value is not None:
                self.file.returned.setdefault(name, []).append((self, node.value))
            elif isinstance(node, ast.Call):
                self.writes += _changed_by(node)
            else:
                self._assignment(node)

    def _assignment(self, node: ast.AST) -> None:
        if isinstance(node, ast.Assign):
            for target in node.targets:
                self._assigned(target, node.value)
        elif isinstance(node, ast.AnnAssign | ast.NamedExpr) and node.value is not None:
            self._assigned(node.target, node.value)
        elif isinstance(node, ast.For | ast.AsyncFor | ast.comprehension):
            self._assigned(node.target, node.iter)  # an item may be a part of the same memory
        elif isinstance(node, ast.withitem) and node.optional_vars is not None:
            self._assigned(node.optional_vars, node.context_expr)
        elif isinstance(node, ast.AugAssign):
            if isinstance(node.target, ast.Name):  # in place, where it can be
                self.writes.append(node.target)
            self._assigned(node.target, None)
        elif isinstance(node, ast.Delete):
            for target in node.targets:
                self._assigned(target, None)

    def _assigned(self, target: ast.expr, value: ast.expr | None) -> None:
        if isinstance(target, ast.Tuple | ast.List):
            for part in target.elts:
                self._assigned(part, value)
        elif isinstance(target, ast.Starred):
            self._assigned(target.value, value)
        elif isinstance(target, ast.Subscript | ast.Attribute):
            self.writes.append(target.value)
            if isinstance(target, ast.Attribute) and value is not None:
                self.file.attributes.setdefault(ast.unparse(target), []).append((self, value))
        elif isinstance(target, ast.Name) and value is not None:
            self.names.setdefault(target.id, []).append(value)

    def follow(self, node: ast.expr) -> None:
        """What is written through this is written through all that it is a part of, or another name of."""
        known = set(self.file.found)
        self.file.found.add(extent_of(node))
        if extent_of(node) in known:
            return
        match node:
            case ast.Subscript() | ast.Attribute() | ast.Starred() | ast.Await() | ast.NamedExpr():
                self.follow(node.value)
                for scope, value in self.file.attributes.get(ast.unparse(node), ()):
                    scope.follow(value)
            case ast.Name():
                for value in self.names.get(node.id, ()):
                    self.follow(value)
            case ast.IfExp():
                self.follow(node.body)
                self.follow(node.orelse)
            case ast.BoolOp() | ast.Tuple() | ast.List():
                for part in node.values if isinstance(node, ast.BoolOp) else node.elts:
                    self.follow(part)
            case ast.Call():
                self._follow_call(node)

    def _follow_call(self, node: ast.Call) -> None:
        name = _name_of(node.func)
        for scope, value in self.file.returned.get(name, ()):
            scope.follow(value)
        if name in _VIEWS:
            seen = [node.func.value] if isinstance(node.func, ast.Attribute) else []
            for one in [*seen, *node.args[:1]]:
                self.follow(one)


def _within(root: ast.AST) -> Iterator[ast.AST]:
    """All nodes of a function or module but those of functions inside it."""
    waiting = list(ast.iter_child_nodes(root))
    while waiting:
        node = waiting.pop()
        yield node
        if not isinstance(node, _Function):
            waiting.extend(ast.iter_child_nodes(node))


def _changed_by(node: ast.Call) -> Iterator[ast.expr]:
    """What a call changes, by its name and arguments."""
    name = _name_of(node.func)
    if name in _CHANGING and isinstance(node.func, ast.Attribute):
        yield node.func.value
    if name in _CHANGING_FIRST and node.args:
        yield node.args[0]
    yield from (one.value for one in node.keywords if one.arg == "out")


def _name_of(function: ast.expr) -> str:
    if isinstance(function, ast.Attribute):
        return function.attr
    return function.id if isinstance(function, ast.Name) else ""


@dataclass(slots=True)
class Sources:
    """The project's source files, read when first needed.

    Attributes:
        root: the project's root.
    """

    root: Path
    _read: dict[tuple[str, Callable[[str], Any]], Any] = field(default_factory=dict)

    def site(self, seen: SiteSeen) -> Site:
        """The site at which something was seen."""
        span = seen.span
        names: Mapping[Extent, Name] = self._in(span.file, front_end_of(span.file).names) or {}
        text, occurrence = names.get(_extent(span), Name(f"line {span.line}", 1))
        return Site(span, text, occurrence, Role.ORACLE if seen.oracle else Role.PROGRAM)

    def is_written_through(self, span: Span) -> bool:
        """Whether the file writes to what an expression of it gives, as far as its text says."""
        return self._is_among(span, written_through)

    def is_unused(self, seen: SiteSeen) -> bool:
        """Whether nobody uses what the call returns: it is a statement by itself."""
        return seen.direct and self._is_among(seen.span, unused_calls)

    def _is_among(self, span: Span, find: Callable[[str], frozenset[Extent]]) -> bool:
        """Whether an expression is one of those that are found in the text of its file, if that is Python."""
        is_python = front_end_of(span.file) is PYTHON
        return is_python and _extent(span) in (self._in(span.file, find) or ())

    def _in(self, file: str, find: Callable[[str], Any]) -> Any:
        """What is found in the text of a file; None for one that cannot be read."""
        if (file, find) not in self._read:
            try:
                found = find((self.root / file).read_text(encoding="utf-8"))
            except (OSError, SyntaxError, ValueError):
                found = None
            self._read[file, find] = found
        return self._read[file, find]


def _extent(span: Span) -> Extent:
    return (span.line, span.column, span.end_line, span.end_column)
