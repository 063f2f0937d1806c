"""From spans to sites: the text of a call and its number, read from the source without importing it."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from pathlib import Path

from mutabot.border.lines import SiteSeen
from mutabot.model import Role, Site, Span

_TEXT_LIMIT = 60
Place = tuple[int, int, int, int]


@dataclass(slots=True)
class Sources:
    """The project's source files, parsed when first needed.

    Attributes:
        root: the project's root.
    """

    root: Path
    _files: dict[str, _File] = field(default_factory=dict)

    def site(self, seen: SiteSeen) -> Site:
        """The site at which something was seen."""
        span = seen.span
        file = self._files.get(span.file)
        if file is None:
            file = self._files[span.file] = _File.read(self.root / span.file)
        text, occurrence = file.name_of(span)
        return Site(span, text, occurrence, Role.ORACLE if seen.oracle else Role.PROGRAM)


@dataclass(slots=True)
class _File:
    """Texts of one file's expressions by place, and their numbers within their function."""

    names: dict[Place, tuple[str, int]]

    @classmethod
    def read(cls, path: Path) -> _File:
        try:
            source = path.read_text(encoding="utf-8")
            tree = ast.parse(source)
        except (OSError, SyntaxError, ValueError):
            return cls({})
        names: dict[Place, tuple[str, int]] = {}
        _number(tree, source.encode().splitlines(keepends=True), names)
        return cls(names)

    def name_of(self, span: Span) -> tuple[str, int]:
        place = (span.line, span.column, span.end_line, span.end_column)
        return self.names.get(place, (f"line {span.line}", 1))


def _number(tree: ast.Module, lines: list[bytes], names: dict[Place, tuple[str, int]]) -> None:
    for scope in _scopes(tree):
        # a call and its callee look alike but are different things to hit
        counts: dict[tuple[type, str], int] = {}
        for node in sorted(_expressions(scope), key=_place):
            text = _text(node, lines)
            count = counts[type(node), text] = counts.get((type(node), text), 0) + 1
            names[_place(node)] = (text, count)


def _scopes(tree: ast.Module) -> list[ast.AST]:
    kinds = (ast.Module, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    return [node for node in ast.walk(tree) if isinstance(node, kinds)]


def _expressions(scope: ast.AST) -> list[ast.expr]:
    """Expressions of a function, class or module, bar those of functions and classes inside it.

    Decorators and default arguments run in the scope around the function they belong to.
    """
    found: list[ast.expr] = []
    waiting: list[ast.AST] = list(_own(scope))
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            waiting.extend(_outer(node))
            continue
        if isinstance(node, ast.expr):
            found.append(node)
        waiting.extend(ast.iter_child_nodes(node))
    return found


def _own(scope: ast.AST) -> list[ast.AST]:
    outer = {id(node) for node in _outer(scope)}
    return [node for node in ast.iter_child_nodes(scope) if id(node) not in outer]


def _outer(node: ast.AST) -> list[ast.AST]:
    if isinstance(node, ast.ClassDef):
        return [*node.decorator_list, *node.bases, *(keyword.value for keyword in node.keywords)]
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        defaults = [
            default for default in (*node.args.defaults, *node.args.kw_defaults) if default is not None
        ]
        return [*node.decorator_list, *defaults]
    return []


def _place(node: ast.expr) -> Place:
    return (node.lineno, node.col_offset, node.end_lineno or node.lineno, node.end_col_offset or 0)


def _text(node: ast.expr, lines: list[bytes]) -> str:
    callee = node.func if isinstance(node, ast.Call) else node
    text = " ".join(_segment(callee, lines).split())
    return text if len(text) <= _TEXT_LIMIT else text[: _TEXT_LIMIT - 1] + "…"


def _segment(node: ast.expr, lines: list[bytes]) -> str:
    first, start, last, end = _place(node)
    if first == last:
        return lines[first - 1][start:end].decode()
    middle = b"".join(lines[first : last - 1])
    return (lines[first - 1][start:] + middle + lines[last - 1][:end]).decode()
