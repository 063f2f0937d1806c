"""Recognises the forms of the suite's checks: the value checked, the expected value, and the tolerance."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeGuard

from .project import text_of

_NAME = re.compile(r"[^\W\d]\w*")
_CLOCK = re.compile(
    r"(?:^|_)(?:time|clock|elapsed|duration|seconds|secs|now|timestamp|ticks?|cycle)(?:_|$)", re.I
)
#: how the names of arguments and constants read that say how far something may be off
_TOLERANCES = ("tol", "thresh", "within", "eps", "delta", "margin", "accuracy", "limit")
#: keywords that are one
_KEYWORDS = ("abs", "delta", "atol", "abs_tol")
#: what stands for the parts of a check in its form
ACTUAL, EXPECTED, TOLERANCE = "_actual", "_expected", "_tolerance"


@dataclass(frozen=True, slots=True)
class SuiteCheck:
    """A check that a value is near another one.

    Attributes:
        key: under which its values are noted.
        file: of the tests.
        actual, expected: expressions: what it looks at, and what that must be near to; of several values one
            each.
        tolerance: how far these may be apart.
        form: the statement, with names for its parts.
        nodes: of the whole expressions in the file: what it looks at, what it expects, the tolerance.
        function: the name of the function that it stands in.
    """

    key: str
    file: str
    actual: tuple[str, ...]
    expected: tuple[str, ...]
    tolerance: str
    form: str
    nodes: tuple[ast.expr, ast.expr, ast.expr]
    function: str = ""

    def names(self, number: int) -> tuple[str, str]:
        """Return the expressions of one of several values: the value checked, and the expected one."""
        return _item(self.actual, number), _item(self.expected, number)

    def parts_in(self, read: Mapping[str, Any]) -> Iterator[tuple[int, float, float, float]]:
        """Yield each recorded value's index, the value, the expected value and the tolerance."""
        tolerance = read.get(f"{self.key}.tolerance")
        if not is_number(tolerance):
            return
        for number in range(-1, 8):
            item = "" if number < 0 else f"[{number}]"
            actual, expected = (read.get(f"{self.key}.{role}{item}") for role in ("actual", "expected"))
            if is_number(actual) and is_number(expected):
                yield number, actual, expected, tolerance

    def statement(self, actual: str, expected: str, tolerance: str) -> str:
        """Return a check of the same form with other expressions."""
        parts = {ACTUAL: actual, EXPECTED: expected, TOLERANCE: tolerance}
        tree = _Renaming(parts).visit(ast.parse(self.form))
        return text_of(tree)


def _item(texts: tuple[str, ...], number: int) -> str:
    if number < 0 or len(texts) > 1:
        return texts[max(number, 0)] if number < len(texts) else ""
    return f"{texts[0]}[{number}]"


def is_number(value: Any) -> TypeGuard[float]:
    """Return whether a value is a number that can be compared with a tolerance."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def is_clock(text: str) -> bool:
    """Return whether a reading is a time, by its name; a difference in it may only mean a delay."""
    return _CLOCK.search(last_name(text)) is not None


def last_name(text: str) -> str:
    """Return the last name in an expression, without indices: ``places`` for ``places[0][2]``."""
    return str([text, *_NAME.findall(text)][-1])


class _Renaming(ast.NodeTransformer):
    def __init__(self, parts: Mapping[str, str]) -> None:
        self._parts = parts

    def visit_Name(self, node: ast.Name) -> ast.expr:  # ast asks for this name
        text = self._parts.get(node.id)
        return node if text is None else ast.parse(text, mode="eval").body


def rename(statement: str, name: str, text: str) -> str:
    """Return a statement in which an expression replaces a name."""
    return text_of(_Renaming({name: text}).visit(ast.parse(statement)))


def check_of(
    key: str, file: str, node: ast.stmt, found: tuple[ast.expr, ast.expr, ast.expr], function: str
) -> SuiteCheck:
    actual, expected, tolerance = found
    names = {id(actual): ACTUAL, id(expected): EXPECTED, id(tolerance): TOLERANCE}
    form = text_of(ast.fix_missing_locations(_FormMaker(names).visit(node)))
    pair = _parts_of(actual), _parts_of(expected)
    return SuiteCheck(key, file, *pair, text_of(tolerance), form, found, function)


class _FormMaker(ast.NodeTransformer):
    def __init__(self, names: Mapping[int, str]) -> None:
        self._names = names

    def visit(self, node: ast.AST) -> ast.AST:
        name = self._names.get(id(node))
        return self.generic_copy(node) if name is None else ast.Name(name, ast.Load())

    def generic_copy(self, node: ast.AST) -> ast.AST:
        """Return a copy with other parts, since the file's own tree must not change."""
        parts: dict[str, Any] = {}
        for key, value in ast.iter_fields(node):
            if isinstance(value, list):
                parts[key] = [
                    self.visit(element) if isinstance(element, ast.AST) else element for element in value
                ]
            else:
                parts[key] = self.visit(value) if isinstance(value, ast.AST) else value
        return type(node)(**parts)


def _parts_of(node: ast.expr) -> tuple[str, ...]:
    if isinstance(node, ast.Tuple | ast.List) and node.elts:
        return tuple(text_of(element) for element in node.elts)
    return (text_of(node),)


def near_of(node: ast.stmt) -> tuple[ast.expr, ast.expr, ast.expr] | None:
    """Return what a statement checks, the expected value and the tolerance; None for other statements."""
    test = node.test if isinstance(node, ast.Assert) else node.value if isinstance(node, ast.Expr) else None
    match test:
        case ast.Compare(left=actual, ops=[ast.Eq()], comparators=[ast.Call() as call]) if _is_approx(call):
            return _with_keyword(call, actual)
        case ast.Compare(left=ast.Call() as call, ops=[ast.Eq()], comparators=[actual]) if _is_approx(call):
            return _with_keyword(call, actual)
        case ast.Compare(
            left=ast.Call(
                func=ast.Name(id="abs"), args=[ast.BinOp(left=actual, op=ast.Sub(), right=expected)]
            ),
            ops=[ast.Lt() | ast.LtE()],
            comparators=[tolerance],
        ):
            return _ordered(actual, expected, tolerance)
        case ast.Call(args=[*args], keywords=keywords):
            named = [keyword.value for keyword in keywords if keyword.arg and _is_tolerance(keyword.arg)]
            if (
                len(args) == 2
                and len(named) == 1
                and not any(isinstance(argument, ast.Starred) for argument in args)
            ):
                return _ordered(args[0], args[1], named[0])
            if len(args) == 3 and not keywords and isinstance(node, ast.Assert) and _says_tolerance(args[2]):
                return _ordered(args[0], args[1], args[2])
    return None


def _is_approx(call: ast.Call) -> bool:
    return ast.unparse(call.func) in ("approx", "pytest.approx")


def _with_keyword(call: ast.Call, actual: ast.expr) -> tuple[ast.expr, ast.expr, ast.expr] | None:
    sizes = [keyword.value for keyword in call.keywords if keyword.arg == "abs"]
    return (actual, call.args[0], sizes[0]) if sizes and call.args else None


def _ordered(first: ast.expr, second: ast.expr, tolerance: ast.expr) -> tuple[ast.expr, ast.expr, ast.expr]:
    """Return the operands as value checked and expected value: the one that reads something comes first."""
    return (second, first, tolerance) if _reads(second) > _reads(first) else (first, second, tolerance)


def _reads(node: ast.expr) -> int:
    """Return 2 for an expression with calls, 1 for one with names other than constants, 0 for constants."""
    if any(isinstance(inner, ast.Call) for inner in ast.walk(node)):
        return 2
    names = [inner.id for inner in ast.walk(node) if isinstance(inner, ast.Name)]
    return int(not all(name.isupper() for name in names))


def _is_tolerance(name: str) -> bool:
    return name in _KEYWORDS or any(part in name.lower() for part in _TOLERANCES)


def _says_tolerance(node: ast.expr) -> bool:
    if isinstance(node, ast.Constant):
        return isinstance(node.value, float)
    return isinstance(node, ast.Name | ast.Attribute) and _is_tolerance(text_of(node).rpartition(".")[2])
