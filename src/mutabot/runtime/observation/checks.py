"""Note the checks of the running test: what each compared, and by how much it held.

Pytest works out each part of an assertion once and keeps it in a variable. After a comparison, or a call that
decides, an inserted line hands on these variables: nothing of the assertion is evaluated again, and pytest's
message about one that fails stays the same. A statement such as ``self.assertEqual(a, b)`` is noted when it
has returned. Checks that ran before the test reached the fault could not notice it: these are forgotten.
"""

from __future__ import annotations

import ast
import builtins
import math
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from importlib.util import decode_source
from typing import Any

from mutabot.model.data import is_of_numpy
from mutabot.model.outcome import Check
from mutabot.runtime.program_text import loading

#: checks of a test that are reported; of others only how many there are
MOST = 40
#: elements of containers beyond which they are not looked at
_MOST_ITEMS = 1000
_LONGEST, _LONGEST_VALUE = 160, 100
#: a blank where a line ended at a bracket
_AT_BRACKET = re.compile(r"(?<=[(\[{]) | (?=[)\]}])")
_PLAIN = (str, bytes, int, float, bool, complex, range, type(None))
#: the built-in name by which test files note their checks
CHECKED = "__mutabot_checked__"
_OPERATORS: dict[type[ast.cmpop], str] = {
    ast.Eq: "==", ast.NotEq: "!=", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=",
    ast.In: "in", ast.NotIn: "not in", ast.Is: "is", ast.IsNot: "is not",
}  # fmt: skip


class Looks:
    """The checks of the running test, with what they compared.

    It keeps texts and numbers alone, by place and text: a test may count the objects that the collector of
    garbage knows, between two of its checks.

    Args:
        is_reached: whether the running test has reached the fault.
    """

    def __init__(self, is_reached: Callable[[], bool] = lambda: False) -> None:
        self._is_reached = is_reached
        self._is_after = False
        self._seen: dict[str, str] = {}
        self._least: dict[str, float] = {}
        self._times: dict[str, int] = {}
        self._more: set[str] = set()

    def clear(self) -> None:
        """Begin another test."""
        self._is_after = False
        for kept in (self._seen, self._least, self._times, self._more):
            kept.clear()

    @property
    def noted(self) -> tuple[Check, ...]:
        """The checks."""
        self._forget_earlier()
        return tuple(map(self._check, self._seen))

    @property
    def more(self) -> int:
        """How many checks were made beyond those that are noted."""
        self._forget_earlier()
        return len(self._more)

    def _forget_earlier(self) -> None:
        """Forget what was checked before the fault was reached."""
        if not self._is_after and self._is_reached():
            self.clear()
            self._is_after = True

    def _check(self, key: str) -> Check:
        place, _, text = key.rpartition("\n")  # which no text of a check has in it
        return Check(place, text[:_LONGEST], self._seen[key], self._least.get(key), self._times[key])

    def checked(self, place: str, text: str, *compared: Any, **passed: Any) -> None:
        """Note a check that has held.

        Args:
            place: ``file:line`` of it.
            text: what the test says there.
            compared: left side, operator and right side of a comparison.
            passed: the arguments of a call; those without a keyword by their number, as ``_0``.
        """
        with suppress(Exception):  # whatever the user's values do when they are examined, the test goes on
            self._forget_earlier()
            if compared:
                self._note(place, text, margin(*compared), lambda: _words(*compared))
            else:
                self._note(place, text, None, lambda: _arguments_in_words(passed))

    def _note(self, place: str, text: str, spare: float | None, describe: Callable[[], str]) -> None:
        key = f"{place}\n{text}"
        is_new = key not in self._seen
        if is_new and len(self._seen) >= MOST:
            self._more.add(key)
            return
        if is_new or (spare is not None and spare < self._least.get(key, math.inf)):
            self._seen[key] = describe()
            if spare is not None:
                self._least[key] = spare
        self._times[key] = self._times.get(key, 0) + 1


def margin(left: Any, operator: str, right: Any) -> float | None:
    """Return how far the sides of ``left operator right`` are apart; None if they are no numbers.

    Arrays and sequences count by their element that is nearest to end otherwise.
    """
    if operator in ("==", "!="):
        for value, other in ((left, right), (right, left)):
            if _is_approximate(other):
                return _of_approximate(value, other)
        return None
    if operator not in ("<", "<=", ">", ">="):
        return None
    return _least(abs(other - value) for value, other in _pairs(left, right))


def _is_approximate(value: Any) -> bool:
    """Return whether ``pytest.approx`` made it; its module has moved between releases."""
    kind = type(value)
    return kind.__module__.startswith("_pytest.") and kind.__name__.startswith("Approx")


def _of_approximate(value: Any, approximate: Any) -> float | None:
    expected = approximate.expected
    if isinstance(expected, Mapping):
        if type(value) is not dict or value.keys() != expected.keys():
            return None
        value, expected = list(value.values()), [expected[key] for key in value]
    scalar_of = getattr(approximate, "_approx_scalar", lambda wanted: approximate)
    pairs = _pairs(value, expected)
    return _least(abs(scalar_of(wanted).tolerance - abs(number - wanted)) for number, wanted in pairs)


def _least(found: Iterator[float]) -> float | None:
    return min((spare for spare in found if math.isfinite(spare)), default=None)


def _pairs(left: Any, right: Any) -> list[tuple[float, float]]:
    """Return the pairs of compared numbers; none if there is anything else."""
    ones, others = _numbers(left), _numbers(right)
    if ones is None or others is None:
        return []
    size = max(len(ones), len(others))
    ones, others = (side * size if len(side) == 1 else side for side in (ones, others))
    return list(zip(ones, others, strict=True)) if len(ones) == len(others) else []


def _numbers(value: Any) -> list[float] | None:
    value = _without_numpy(value)
    if type(value) in (int, float, bool):
        return [float(value)]
    if type(value) not in (list, tuple) or len(value) > _MOST_ITEMS:
        return None
    parts = [_numbers(item) for item in value]
    return None if None in parts else [number for part in parts for number in part or ()]


def _without_numpy(value: Any) -> Any:
    """Convert an array of numbers to a list and a numpy number to a plain one, without importing numpy."""
    if not is_of_numpy(value):
        return value
    return value.tolist() if value.dtype.kind in "biuf" and value.size <= _MOST_ITEMS else value


def _in_words(value: Any) -> str | None:
    """Return a plain value as text; None for others, whose ``repr`` may have side effects."""
    value = _without_numpy(value)
    if _is_approximate(value):
        inner = _in_words(value.expected)
        return None if inner is None else f"approx({inner})"
    if not _is_plain(value):
        return None
    text = f"{value:.6g}" if type(value) is float else repr(_rounded(value))
    return text if len(text) <= _LONGEST_VALUE else f"{text[: _LONGEST_VALUE - 1]}…"


def _rounded(value: Any) -> Any:
    """Return plain data with six digits of each number."""
    if type(value) is float:
        return float(f"{value:.6g}")
    if type(value) is dict:
        return {key: _rounded(item) for key, item in value.items()}
    return type(value)(map(_rounded, value)) if type(value) in (list, tuple) else value


def _is_plain(value: Any) -> bool:
    kind = type(value)
    if kind in (list, tuple, dict) and len(value) <= _MOST_ITEMS:
        return all(map(_is_plain, value)) and (kind is not dict or all(map(_is_plain, value.values())))
    return kind in _PLAIN


def _words(left: Any, operator: str, right: Any) -> str:
    sides = _in_words(left), _in_words(right)
    return f"{sides[0]} {operator} {sides[1]}" if None not in sides else ""


def _arguments_in_words(passed: Mapping[str, Any]) -> str:
    """Return the arguments of a call, ``…`` for each that is no plain value; nothing if none is one."""
    found = {name: _in_words(value) for name, value in passed.items()}
    if not any(found.values()):
        return ""
    return ", ".join(
        (text or "…") if name[0] == "_" else f"{name}={text or '…'}" for name, text in found.items()
    )


class Checks:
    """Instruments test files so that checks are noted.

    Args:
        root: absolute path of the project.
        wants: whether the assertions of a file are the tests' own.
        looks: where they are noted.
    """

    def __init__(self, root: str, wants: Callable[[str], bool], looks: Looks) -> None:
        self._root = os.path.realpath(root)
        self._wants = wants
        self._looks = looks
        self._descriptions: list[tuple[str, str]] = []
        self._found: dict[_Location, int] = {}

    def install(self) -> None:
        """Instrument all test files that pytest rewrites from now on."""
        looks, descriptions = self._looks, self._descriptions
        setattr(
            builtins,
            CHECKED,
            lambda number, *compared, **passed: looks.checked(*descriptions[number], *compared, **passed),
        )
        loading.hook_pytest(self._wants, self._insert, self._look)

    def _look(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Number the comparisons and calls that decide about assertions, by their positions."""
        # columns count bytes of UTF-8, whatever the file is written in
        # and ``ast.get_source_segment`` splits all of it for each part
        lines = decode_source(source).encode().splitlines(keepends=True)
        name = os.path.relpath(os.path.realpath(path), self._root)
        self._found = {}
        for node in ast.walk(tree):
            for part in _deciding(_decides(node)):
                text = " ".join(_segment(lines, part).decode("utf-8", "replace").split())
                text = _AT_BRACKET.sub("", text)
                self._found[_position(part)] = len(self._descriptions)
                self._descriptions.append((f"{name}:{part.lineno}", text))

    def _insert(self, tree: ast.Module, source: bytes, path: str) -> None:
        if self._found:
            _Inserter(self._found).visit(tree)


#: where an expression stands: line and column, from and to
_Location = tuple[int, int, int | None, int | None]


def _decides(node: ast.AST) -> ast.expr | None:
    """Return what a statement checks: an assertion's condition, or a call whose name says that it asserts."""
    match node:
        case ast.Assert(test=test):
            return test
        case ast.Expr(value=ast.Call(func=ast.Attribute(attr=name) | ast.Name(id=name)) as call):
            return call if name.startswith("assert") else None
    return None


def _deciding(test: ast.expr | None) -> Iterator[ast.Compare | ast.Call]:
    """Yield the comparisons and calls that a condition consists of."""
    if isinstance(test, ast.BoolOp):
        for value in test.values:
            yield from _deciding(value)
    elif isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        yield from _deciding(test.operand)
    elif isinstance(test, ast.Compare | ast.Call):
        yield test


def _position(node: ast.expr) -> _Location:
    return node.lineno, node.col_offset, node.end_lineno, node.end_col_offset


def _segment(lines: Sequence[bytes], node: ast.expr) -> bytes:
    """Return the source text of an expression, given all lines with their ends."""
    last = node.end_lineno or node.lineno
    found = b"".join(lines[node.lineno - 1 : last])
    after = len(lines[last - 1]) - (node.end_col_offset or 0)
    return found[node.col_offset : len(found) - after]


def _is_variable(node: ast.expr) -> bool:
    return isinstance(node, ast.Name | ast.Constant)


class _Inserter(ast.NodeTransformer):
    """Inserts statements that note conditions of assertions and calls that assert."""

    def __init__(self, found: dict[_Location, int]) -> None:
        self._found = found

    def visit_Assign(self, node: ast.Assign) -> Any:  # the name that ast looks for
        target = node.targets[0]
        return self._noted(node) if isinstance(target, ast.Name) and target.id.startswith("@py_") else node

    def visit_Expr(self, node: ast.Expr) -> Any:  # as above
        return self._noted(node) if isinstance(node.value, ast.Call) else node

    def _noted(self, node: ast.Assign | ast.Expr) -> Any:
        value = node.value
        number = self._found.get(_position(value)) if isinstance(value, ast.Compare | ast.Call) else None
        if number is None:
            return node
        given: list[ast.expr] = [ast.Constant(number)]
        passed: list[ast.keyword] = []
        if isinstance(value, ast.Compare):
            sides = [value.left, *value.comparators]
            if not all(map(_is_variable, sides)):
                return node  # what is no variable would be evaluated twice
            given += [sides[0], ast.Constant(_OPERATORS[type(value.ops[0])]), sides[1]]
        elif isinstance(value, ast.Call):
            passed = [
                *(ast.keyword(f"_{index}", expression) for index, expression in enumerate(value.args)),
                *value.keywords,
            ]
            if not all(keyword.arg is not None and _is_variable(keyword.value) for keyword in passed):
                passed = []  # as above
        line = ast.Expr(ast.Call(ast.Name(CHECKED, ast.Load()), given, passed))
        return [node, ast.fix_missing_locations(ast.copy_location(line, node))]
