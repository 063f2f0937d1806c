"""Plain pytest: test functions, and methods of classes that are no ``TestCase``."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from itertools import groupby
from typing import TypeGuard

from mutabot.suggestion.sources.project import Project
from mutabot.suggestion.sources.texts import Insertion, imports_of

from .copying import imports_for, text_with
from .style import (
    Addition,
    Function,
    Place,
    Written,
    arguments_of,
    class_of,
    end_of,
    functions_of,
    plain_assertion_equal,
    plain_assertion_within,
    put_at_end,
)


class _Functions:
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

    def within(self, text: str, value: str, tolerance: str) -> str:
        return plain_assertion_within(text, value, tolerance)

    def equal(self, text: str, value: str) -> str:
        return plain_assertion_equal(text, value)

    def needs(self, line: str) -> tuple[str, ...]:
        return ("import pytest",) if "pytest.approx" in line else ()

    def written(self, project: Project, file: str, additions: Sequence[Addition]) -> Written:
        return written(project, file, additions)


def at_ends(project: Project, additions: Sequence[Addition]) -> list[Insertion]:
    """What puts statements at the ends of functions and methods, with the imports they need."""
    file = additions[0].place.file
    module = project.module(file)
    assert module is not None
    found = imports_of(file, module, (line for one in additions for line in one.imports))
    for one in additions:
        function = functions_of(module, one.place.node.split("::")[1:])
        assert function is not None, "a place has a function"
        found += put_at_end(file, function, project.lines(file), one.lines)
    return found


def written(project: Project, file: str, additions: Sequence[Addition]) -> Written:
    """The functions with their additions; methods in a subclass, whose other tests do not run again."""
    module = project.module(file)
    assert module is not None
    imports = [line for one in additions for line in one.imports]
    lines: list[str] = []
    for node, same in groupby(additions, key=lambda one: one.place.node):
        path, added = node.split("::")[1:], [line for one in same for line in one.lines]
        function = functions_of(module, path)
        assert function is not None, "a place has a function"
        imports += imports_for(project, file, [function], _names(function))
        text = text_with(project, file, function, added)
        if len(path) > 1:
            imports.append(f"import {project.import_name(file)}")
            text = [*_class_head(project, file, module, path), *text]
        lines += ["", "", *text]
    marks = [line for line in module.body if _is_marks(line)]
    if marks:
        imports += imports_for(project, file, [line.value for line in marks])
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
