"""Plain pytest: test functions, and methods of classes that are no ``TestCase``."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import TypeGuard

from mutabot.suggestion.sources.project import Project
from mutabot.suggestion.sources.texts import Insertion, changed_texts, imports_of

from .copying import imports_for, text_of
from .style import (
    Addition,
    Function,
    Place,
    PlainAsserts,
    Written,
    arguments_of,
    class_of,
    end_of,
    functions_of,
    put_at_end,
)
from .watching import asked_for, at_start, fixture, helper, watcher


class _Functions(PlainAsserts):
    name = "pytest"
    order = 30

    def place(self, project: Project, node: str) -> Place | None:
        file, *path = node.split("::")
        module = project.module(file)
        function = functions_of(module, path) if module is not None and path else None
        if function is None or end_of(function, project.lines(file)) is None or len(path) > 2:
            return None
        return Place(self.name, file, node, _names(function))

    def at_end(self, project: Project, additions: Sequence[Addition]) -> list[Insertion]:
        return at_ends(project, additions)

    def written(self, project: Project, file: str, additions: Sequence[Addition]) -> Written:
        return written(project, file, additions)


def at_ends(project: Project, additions: Sequence[Addition], *, fixtures: bool = True) -> list[Insertion]:
    """What puts statements at the ends of functions and methods, with all that they need.

    ``fixtures``: whether the tests can ask for fixtures; else they are methods of a ``TestCase``.
    """
    file = additions[0].place.file
    module, lines = project.module(file), project.lines(file)
    assert module is not None
    watches = list(dict.fromkeys(one.watch for one in additions if one.watch is not None))
    imports = [line for one in additions for line in one.imports]
    imports += ["import pytest" if fixtures else "from unittest import mock"] if watches else []
    found = imports_of(file, module, imports)
    for place in dict.fromkeys(one.place for one in additions):
        function = functions_of(module, place.node.split("::")[1:])
        assert function is not None, "a place has a function"
        here = [one for one in additions if one.place == place]
        names = list(dict.fromkeys(one.watch.name for one in here if one.watch is not None))
        if fixtures:
            found += asked_for(file, function, lines, names)
        else:
            found += at_start(file, function, lines, [f"{name} = {watcher(name)}(self)" for name in names])
        found += put_at_end(file, function, lines, [line for one in here for line in one.lines])
    for watch in watches:
        text = fixture(watch) if fixtures else helper(watch)
        found.append(Insertion(file, len(lines), ("", "", *text)))
    return found


def written(project: Project, file: str, additions: Sequence[Addition], *, fixtures: bool = True) -> Written:
    """The functions with their additions; methods in a subclass, whose other tests do not run again."""
    text = changed_texts(project.root, at_ends(project, additions, fixtures=fixtures))[file]
    module = ast.parse(text)
    imports: list[str] = []
    lines: list[str] = []
    names = [one.watch.name for one in additions if one.watch is not None]
    helpers = [name if fixtures else watcher(name) for name in dict.fromkeys(names)]
    paths = [[name] for name in helpers]
    paths += [
        list(path) for path in dict.fromkeys(tuple(one.place.node.split("::")[1:]) for one in additions)
    ]
    for path in paths:
        function = functions_of(module, path)
        assert function is not None, "it was put there, or is a place"
        used = arguments_of(function)
        imports += imports_for(project, file, module, [function], used, without=helpers)
        part = text_of(function, text.splitlines())
        if len(path) > 1:
            imports.append(f"import {project.import_name(file)}")
            part = [*_class_head(project, file, module, path), *part]
        lines += ["", "", *part]
    marks = [line for line in module.body if _is_marks(line)]
    if marks:
        imports += imports_for(project, file, module, [line.value for line in marks])
        lines = ["", *map(ast.unparse, marks), *lines]
    return Written(tuple(dict.fromkeys(imports)), tuple(lines))


def _class_head(project: Project, file: str, module: ast.Module, path: Sequence[str]) -> list[str]:
    owner = class_of(module, path[0])
    assert owner is not None, "a method has a class"
    others = [
        one.name
        for one in owner.body
        if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef)
        and one.name.startswith("test")
        and one.name != path[-1]
    ]
    head = [f"class {_class_name(path)}({project.import_name(file)}.{path[0]}):"]
    if others:
        head += [f"    {' = '.join(others)} = None  # these run where they are", ""]
    return head


def _class_name(path: Sequence[str]) -> str:
    test = "".join(part.capitalize() for part in path[-1].removeprefix("test").split("_"))
    return f"{path[0]}{test}" if path[0].startswith("Test") else f"Test{path[0]}{test}"


def _names(function: Function) -> tuple[str, ...]:
    """Arguments, and what is assigned on the way."""
    assigned = [
        one.id
        for statement in function.body
        for one in ast.walk(statement)
        if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)
    ]
    return tuple(dict.fromkeys((*arguments_of(function), *assigned)))


def _is_marks(node: ast.stmt) -> TypeGuard[ast.Assign]:
    return isinstance(node, ast.Assign) and any(
        isinstance(one, ast.Name) and one.id == "pytestmark" for one in node.targets
    )


STYLE = _Functions()
