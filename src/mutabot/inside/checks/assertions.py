"""Assertions of the tests, as pytest rewrites them: what each compares is noted when it is compared.

Pytest works out each part of an assertion once and keeps it in a variable. After a comparison, and after a
call that decides, a line is put in that hands on these variables. Nothing of the assertion is worked out
again, and what pytest says of one that fails stays as it is.
"""

from __future__ import annotations

import ast
import os
import sys
from collections.abc import Callable, Iterator
from typing import Any

from .looks import Looks

#: names in pytest's module of rewriting, which rewritten files know as ``@pytest_ar``
_COMPARED, _CALLED = "_mutabot_compared", "_mutabot_called"
_REWRITING = "_pytest.assertion.rewrite"
_OPERATORS: dict[type[ast.cmpop], str] = {
    ast.Eq: "==", ast.NotEq: "!=", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=",
    ast.In: "in", ast.NotIn: "not in", ast.Is: "is", ast.IsNot: "is not",
}  # fmt: skip

#: where an expression stands: line and column, from and to
Position = tuple[int, int, int | None, int | None]


class Assertions:
    """Puts the noting of checks into test files.

    Args:
        root: absolute path of the project.
        wants: whether the assertions of a file are the tests' own.
        looks: where they are noted.
    """

    def __init__(self, root: str, wants: Callable[[str], bool], looks: Looks) -> None:
        self._root = os.path.realpath(root)
        self._wants = wants
        self._looks = looks
        self._told: list[tuple[str, str]] = []

    def install(self) -> None:
        """Look at all test files that are imported from now on."""
        rewriting: Any = sys.modules.get(_REWRITING)
        if rewriting is None:
            return
        rewrite, read = rewriting.rewrite_asserts, rewriting._read_pyc

        def rewrite_asserts(tree: ast.Module, source: bytes, path: str | None = None, *rest: Any) -> None:
            found = self._conditions(tree, source, path) if path is not None and self._wants(path) else {}
            rewrite(tree, source, path, *rest)
            if found:
                _Inserter(found).visit(tree)

        def read_pyc(source: Any, *rest: Any, **named: Any) -> Any:
            # what pytest compiled in earlier sessions tells nothing
            return None if self._wants(str(source)) else read(source, *rest, **named)

        rewriting.rewrite_asserts, rewriting._read_pyc = rewrite_asserts, read_pyc
        setattr(rewriting, _COMPARED, self._compared)
        setattr(rewriting, _CALLED, self._called)

    def _conditions(self, tree: ast.Module, source: bytes, path: str) -> dict[Position, int]:
        """Numbers of the comparisons and calls that decide about assertions, by where they stand."""
        text = source.decode("utf-8", "replace")
        place = os.path.relpath(os.path.realpath(path), self._root)
        found: dict[Position, int] = {}
        for node in ast.walk(tree):
            if isinstance(node, ast.Assert):
                for part in _deciding(node.test):
                    words = " ".join((ast.get_source_segment(text, part) or "").split())
                    found[_position(part)] = len(self._told)
                    self._told.append((f"{place}:{part.lineno}", words))
        return found

    def _compared(self, number: int, left: Any, operator: str, right: Any) -> None:
        self._looks.compared(*self._told[number], left, operator, right)

    def _called(self, number: int, function: Any, arguments: tuple[Any, ...], named: dict[str, Any]) -> None:
        self._looks.called(*self._told[number], function, arguments, named)


def _deciding(test: ast.expr) -> Iterator[ast.Compare | ast.Call]:
    """The comparisons and calls of which an assertion is made up."""
    if isinstance(test, ast.BoolOp):
        for value in test.values:
            yield from _deciding(value)
    elif isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        yield from _deciding(test.operand)
    elif isinstance(test, ast.Compare | ast.Call):
        yield test


def _position(node: ast.expr) -> Position:
    return node.lineno, node.col_offset, node.end_lineno, node.end_col_offset


class _Inserter(ast.NodeTransformer):
    """Puts lines after those that work out the conditions of assertions."""

    def __init__(self, found: dict[Position, int]) -> None:
        self._found = found

    def visit_Assign(self, node: ast.Assign) -> Any:  # the name that ast looks for
        value = node.value
        if not isinstance(value, ast.Compare | ast.Call) or not _is_pytests(node):
            return node
        number = self._found.get(_position(value))
        if number is None or not all(isinstance(one, ast.Name | ast.Constant) for one in _parts(value)):
            return node  # what is no variable would be worked out twice
        return [node, ast.fix_missing_locations(ast.copy_location(_line(number, value), node))]


def _parts(value: ast.Compare | ast.Call) -> list[ast.expr]:
    """What a comparison or call is made of."""
    if isinstance(value, ast.Compare):
        return [value.left, *value.comparators]
    given = [one.value if isinstance(one, ast.Starred) else one for one in value.args]
    return [value.func, *given, *(one.value for one in value.keywords)]


def _is_pytests(node: ast.Assign) -> bool:
    target = node.targets[0]
    return isinstance(target, ast.Name) and target.id.startswith("@py_")


def _line(number: int, value: ast.Compare | ast.Call) -> ast.Expr:
    index = ast.Constant(number)
    if isinstance(value, ast.Compare):
        operator = ast.Constant(_OPERATORS[type(value.ops[0])])
        return _call(_COMPARED, [index, value.left, operator, value.comparators[0]])
    named = ast.Dict(
        [None if one.arg is None else ast.Constant(one.arg) for one in value.keywords],
        [one.value for one in value.keywords],
    )
    return _call(_CALLED, [index, value.func, ast.Tuple(list(value.args), ast.Load()), named])


def _call(name: str, arguments: list[ast.expr]) -> ast.Expr:
    function = ast.Attribute(ast.Name("@pytest_ar", ast.Load()), name, ast.Load())
    return ast.Expr(ast.Call(function, arguments, []))
