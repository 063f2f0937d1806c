"""A test's text with additions, for another file: what it needs of its own file is imported from there."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Sequence

from mutabot.suggestion.sources.project import Project

from .style import Function


def text_of(function: Function, lines: Sequence[str]) -> list[str]:
    """The lines of a function, with its decorators."""
    start = min([function.lineno, *(one.lineno for one in function.decorator_list)]) - 1
    return list(lines[start : function.end_lineno or function.lineno])


def imports_for(
    project: Project,
    file: str,
    module: ast.Module,
    nodes: Iterable[ast.AST],
    more: Iterable[str] = (),
    without: Iterable[str] = (),
) -> list[str]:
    """The imports that give these pieces of a file's text, and ``more`` names, their meaning elsewhere.

    What the file imports is imported likewise; what it defines is imported from it, but for ``without``.
    """
    used = {one.id for node in nodes for one in ast.walk(node) if isinstance(one, ast.Name)} | set(more)
    used = _with_fixtures(module, used) - set(without)
    own: list[str] = []
    found: list[str] = []
    for node in module.body:
        if isinstance(node, ast.ImportFrom) and node.module == "__future__":
            found.append(ast.unparse(node))
        elif isinstance(node, ast.Import | ast.ImportFrom):
            found += [_one_import(node, alias) for alias in node.names if _bound(node, alias) in used]
        else:
            own += [name for name in _defined(node) if name in used and not name.startswith("test")]
    if own:
        found.append(f"from {project.import_name(file)} import {', '.join(sorted(set(own)))}")
    return found


def _one_import(node: ast.Import | ast.ImportFrom, alias: ast.alias) -> str:
    what = alias.name + (f" as {alias.asname}" if alias.asname else "")
    if isinstance(node, ast.Import):
        return f"import {what}"
    return f"from {'.' * node.level}{node.module or ''} import {what}"


def _bound(node: ast.Import | ast.ImportFrom, alias: ast.alias) -> str:
    return alias.asname or (alias.name.partition(".")[0] if isinstance(node, ast.Import) else alias.name)


def _defined(node: ast.stmt) -> list[str]:
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        return [node.name]
    if isinstance(node, ast.Assign):
        return [one.id for target in node.targets for one in ast.walk(target) if isinstance(one, ast.Name)]
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        return [node.target.id]
    return []


def _with_fixtures(module: ast.Module, used: set[str]) -> set[str]:
    """With the fixtures of the file that are asked for by name, and those that nobody has to ask for."""
    fixtures = {
        node.name: node
        for node in module.body
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and _is_fixture(node)
    }
    found = set(used)
    waiting = [name for name, node in fixtures.items() if name in used or "autouse" in _decorators(node)]
    while waiting:
        name = waiting.pop()
        found.add(name)
        asked = [one.arg for one in fixtures[name].args.args]
        waiting += [one for one in asked if one in fixtures and one not in found]
    return found


def _is_fixture(node: Function) -> bool:
    return "fixture" in _decorators(node)


def _decorators(node: Function) -> str:
    return " ".join(ast.unparse(one) for one in node.decorator_list)
