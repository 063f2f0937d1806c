"""Plain pytest and unittest: test functions, methods of classes, and methods of ``TestCase`` classes."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from mutabot.suggestion.project import Insertion, Project, imports_of
from mutabot.suggestion.readings import asked_for, at_start, fixture, helper, watcher
from mutabot.suggestion.style import (
    Addition,
    Function,
    Place,
    PlainAsserts,
    arguments_of,
    class_of,
    end_of,
    functions_of,
    put_at_end,
)


class _Functions(PlainAsserts):
    name = "pytest"

    def place(self, project: Project, node: str) -> Place | None:
        file, *path = node.split("::")
        module = project.module(file)
        function = functions_of(module, path) if module is not None and path else None
        if function is None or end_of(function, project.lines(file)) is None or len(path) > 2:
            return None
        return Place(self.name, file, node, _names(function))

    def at_end(self, project: Project, additions: Sequence[Addition]) -> list[Insertion]:
        return at_ends(project, additions)


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


def _names(function: Function) -> tuple[str, ...]:
    """Arguments, and what is assigned on the way."""
    assigned = [
        one.id
        for statement in function.body
        for one in ast.walk(statement)
        if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)
    ]
    return tuple(dict.fromkeys((*arguments_of(function), *assigned)))


PYTEST = _Functions()


class _TestCases:
    name = "unittest"

    def place(self, project: Project, node: str) -> Place | None:
        file, *path = node.split("::")
        module = project.module(file)
        if module is None or len(path) != 2 or not _is_test_case(module, path[0]):
            return None
        found = PYTEST.place(project, node)
        return Place(self.name, file, node, found.names) if found is not None else None

    def at_end(self, project: Project, additions: Sequence[Addition]) -> list[Insertion]:
        return at_ends(project, additions, fixtures=False)

    def within(self, text: str, value: str, tolerance: str) -> str:
        return f"self.assertAlmostEqual({text}, {value}, delta={tolerance})"

    def equal(self, text: str, value: str) -> str:
        plain = {
            "True": f"self.assertTrue({text})",
            "False": f"self.assertFalse({text})",
            "None": f"self.assertIsNone({text})",
        }
        return plain.get(value, f"self.assertEqual({text}, {value})")

    def needs(self, line: str) -> tuple[str, ...]:
        return ()


def _is_test_case(module: ast.Module, name: str, depth: int = 5) -> bool:
    owner = class_of(module, name)
    bases = [ast.unparse(one) for one in owner.bases] if owner is not None else []
    return any(
        base.endswith("TestCase") or (depth > 0 and _is_test_case(module, base, depth - 1)) for base in bases
    )


UNITTEST = _TestCases()
