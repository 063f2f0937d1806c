"""Assertions of the tests, as pytest rewrites them: what each compares is noted when it is compared.

Pytest works out each part of an assertion once and keeps it in a variable. After a comparison, and after a
call that decides, a line is put in that hands on these variables. Nothing of the assertion is worked out
again, and what pytest says of one that fails stays as it is.

Comparisons of unittest and numpy.testing: what each compared is noted when it has held.
"""

from __future__ import annotations

import ast
import functools
import linecache
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from types import ModuleType
from typing import Any

import wrapt

from mutabot.runtime.observation.checks import Looks

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


#: this file, which is nobody's in tracebacks
FILE = __file__
_ORDERS = {
    "assertGreater": ">", "assertGreaterEqual": ">=", "assertLess": "<", "assertLessEqual": "<=",
    "assertEqual": "==", "assertNotEqual": "!=", "assertIn": "in", "assertNotIn": "not in",
    "assert_equal": "==", "assert_array_equal": "==", "assert_array_less": "<",
}  # fmt: skip
#: these run what they are given
_RUNS_SOMETHING = ("raises", "warn", "logs", "gc_cycles")


class Comparisons:
    """Notes what these functions compare.

    Args:
        root: absolute path of the project.
        looks: where it is noted.
    """

    def __init__(self, root: str, looks: Looks) -> None:
        self._root = os.path.realpath(root)
        self._looks = looks
        self._is_inside = False
        self._relative: dict[str, str] = {}

    def install(self) -> None:
        """Look at them, whenever their modules are imported."""
        wrapt.register_post_import_hook(lambda module: self._wrap(module.TestCase, 1), "unittest.case")
        wrapt.register_post_import_hook(self._wrap_module, "numpy.testing")

    def _wrap_module(self, module: ModuleType) -> None:
        self._wrap(module, 0)

    def _wrap(self, owner: Any, first: int) -> None:
        """Stand around the comparisons of a module or class; ``first``: where what is compared begins."""
        for name in dir(owner):
            function = getattr(owner, name)
            if (
                name.startswith("assert")
                and callable(function)
                and not any(one in name.lower() for one in _RUNS_SOMETHING)
            ):
                setattr(owner, name, self._noting(name, function, first))

    def _noting(self, name: str, function: Callable[..., Any], first: int) -> Callable[..., Any]:
        @functools.wraps(function)
        def compare(*arguments: Any, **named: Any) -> Any:
            if self._is_inside:  # they use each other
                return function(*arguments, **named)
            self._is_inside = True
            try:
                result = function(*arguments, **named)
            finally:
                self._is_inside = False
            frame = sys._getframe(1)
            self._note(frame.f_code.co_filename, frame.f_lineno, name, arguments[first:], named)
            return result

        return compare

    def _note(
        self, file: str, line: int, name: str, arguments: tuple[Any, ...], named: Mapping[str, Any]
    ) -> None:
        if file not in self._relative:
            self._relative[file] = os.path.relpath(os.path.realpath(file), self._root)
        place = f"{self._relative[file]}:{line}"
        text = " ".join(linecache.getline(file, line).split()) or name
        tolerance = _tolerance(name, arguments, named)
        if len(arguments) >= 2 and tolerance is not None:
            self._looks.near(place, text, arguments[0], arguments[1], *tolerance)
        elif len(arguments) >= 2 and name in _ORDERS:
            self._looks.compared(place, text, arguments[0], _ORDERS[name], arguments[1])
        else:
            self._looks.called(place, text, _Named(name), arguments, {})


class _Named:
    """Stands for a function."""

    def __init__(self, name: str) -> None:
        self.__name__ = name


def _tolerance(name: str, arguments: tuple[Any, ...], named: Mapping[str, Any]) -> tuple[float, float] | None:
    """Absolute and relative tolerance, as the functions are documented; None for other functions."""
    if name == "assertAlmostEqual":
        # assertAlmostEqual(first, second, places=None, msg=None, delta=None)
        delta = arguments[4] if len(arguments) > 4 else named.get("delta")
        places = arguments[2] if len(arguments) > 2 else named.get("places")
        if delta is not None:
            return (delta, 0.0) if type(delta) in (int, float) else None
        return 0.5 * 10.0 ** -(7 if places is None else places), 0.0
    if name == "assert_allclose":
        # assert_allclose(actual, desired, rtol=1e-07, atol=0, …)
        relative = arguments[2] if len(arguments) > 2 else named.get("rtol", 1e-7)
        absolute = arguments[3] if len(arguments) > 3 else named.get("atol", 0.0)
        is_plain = type(relative) in (int, float) and type(absolute) in (int, float)
        return (absolute, relative) if is_plain else None
    if name in ("assert_almost_equal", "assert_array_almost_equal"):
        # |desired - actual| < 1.5 * 10**(-decimal)
        decimal = arguments[2] if len(arguments) > 2 else named.get("decimal", None)
        usual = 7 if name == "assert_almost_equal" else 6
        return 1.5 * 10.0 ** -(usual if decimal is None else decimal), 0.0
    return None
