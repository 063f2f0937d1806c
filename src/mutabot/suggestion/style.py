"""The contract of a style of tests, and what all styles share."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import Protocol

from mutabot.frozen import frozen
from mutabot.suggestion.project import Insertion, Project

Function = ast.FunctionDef | ast.AsyncFunctionDef


@frozen
class Place:
    """A test at whose end something can be looked at; all parameters of it are one place.

    Attributes:
        style: name of its style.
        file: its module, relative to the project.
        node: its node id without parameters.
        names: what it is given: fixtures and parameters.
        title: of a scenario; empty otherwise.
        feature: file of the scenario, relative to the project; empty otherwise.
    """

    style: str
    file: str
    node: str
    names: tuple[str, ...] = ()
    title: str = ""
    feature: str = ""


@frozen
class Watch:
    """What looks after every command on the way of a test.

    Attributes:
        name: of the list in which it is kept.
        look: expression that is looked at; ``args[0]`` in it is the object that was commanded.
        commands: each an expression of its owner and its name there.
    """

    name: str
    look: str
    commands: tuple[tuple[str, str], ...]


@frozen
class Addition:
    """What is added to the end of a test.

    Attributes:
        place: the test.
        lines: statements.
        says: what they look at, in words that can be a step of a scenario.
        uses: names of the place that the statements use.
        imports: what they need.
        watch: what they need to be there on the way of the test, or None.
    """

    place: Place
    lines: tuple[str, ...]
    says: str
    uses: tuple[str, ...] = ()
    imports: tuple[str, ...] = ()
    watch: Watch | None = None


class Style(Protocol):
    """Knows one way in which tests are written.

    Attributes:
        name: as people call it.
    """

    name: str

    def place(self, project: Project, node: str) -> Place | None:
        """The place of a test by its node id without parameters; None if it is not of this style."""

    def at_end(self, project: Project, additions: Sequence[Addition]) -> list[Insertion]:
        """What puts these additions, all of one file, into the tests where they are."""

    def within(self, text: str, value: str, tolerance: str) -> str:
        """The statement that ``text`` reads ``value`` within ``tolerance``."""

    def equal(self, text: str, value: str) -> str:
        """The statement that ``text`` reads ``value`` exactly."""

    def needs(self, line: str) -> tuple[str, ...]:
        """The imports that such a statement needs."""


def functions_of(module: ast.Module, path: Sequence[str]) -> Function | None:
    """The function with this qualified name, split at its dots."""
    body: Sequence[ast.stmt] = module.body
    for name in path[:-1]:
        owner = next((one for one in body if isinstance(one, ast.ClassDef) and one.name == name), None)
        if owner is None:
            return None
        body = owner.body
    functions = [one for one in body if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef)]
    return next((one for one in reversed(functions) if one.name == path[-1]), None)


def class_of(module: ast.Module, name: str) -> ast.ClassDef | None:
    """The class with this name at the top of a file."""
    return next((one for one in module.body if isinstance(one, ast.ClassDef) and one.name == name), None)


def arguments_of(function: Function) -> tuple[str, ...]:
    """The names of its arguments."""
    given = function.args
    return tuple(one.arg for one in (*given.posonlyargs, *given.args, *given.kwonlyargs))


class PlainAsserts:
    """The statements of a style that asserts with the assert statement."""

    def within(self, text: str, value: str, tolerance: str) -> str:
        """With ``pytest.approx``."""
        return f"assert {text} == pytest.approx({value}, abs={tolerance})"

    def equal(self, text: str, value: str) -> str:
        """With the statement alone."""
        plain = {"True": f"assert {text}", "False": f"assert not {text}", "None": f"assert {text} is None"}
        return plain.get(value, f"assert {text} == {value}")

    def needs(self, line: str) -> tuple[str, ...]:
        """What a statement with a tolerance names."""
        return ("import pytest",) if "pytest.approx" in line else ()


def end_of(function: Function, lines: Sequence[str]) -> tuple[int, str] | None:
    """After which line something comes at the end of a function, and how it is indented.

    None where the end cannot be had: a body on the line of its ``def``, or one that does not get there.
    """
    first, last = function.body[0], function.body[-1]
    if first.lineno == function.lineno or isinstance(last, ast.Raise):
        return None
    indent = lines[first.lineno - 1][: first.col_offset]
    if isinstance(last, ast.Return):
        return last.lineno - 1, indent
    return last.end_lineno or last.lineno, indent


def put_at_end(
    file: str, function: Function, lines: Sequence[str], addition: Sequence[str]
) -> list[Insertion]:
    """What puts statements at the end of a function."""
    found = end_of(function, lines)
    if found is None:
        return []
    after, indent = found
    return [Insertion(file, after, tuple(indent + line for line in addition))]
