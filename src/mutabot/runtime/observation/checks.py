"""Note the checks of the running test: what each compared, and by how much it held.

Pytest works out each part of an assertion once and keeps it in a variable. After a comparison, and after a
call that decides, an inserted line hands on these variables: nothing of the assertion is evaluated again, and
pytest's message about one that fails stays the same. The comparisons of unittest and numpy.testing are
wrapped, and noted when they have held.
"""

from __future__ import annotations

import ast
import functools
import inspect
import linecache
import math
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from types import ModuleType
from typing import Any

import wrapt

from mutabot.model.outcome import Check

#: this file, which is nobody's in tracebacks
FILE = __file__
#: checks of a test that are told; of others only how many there are
MOST = 40
#: elements of containers beyond which they are not looked at
_MOST_ITEMS = 1000
_LONGEST, _LONGEST_VALUE = 160, 100
_PLAIN = (str, bytes, int, float, bool, complex, range, type(None))
#: names in pytest's module of rewriting, which rewritten files know as ``@pytest_ar``
_COMPARED, _CALLED = "_mutabot_compared", "_mutabot_called"
_REWRITING = "_pytest.assertion.rewrite"
_OPERATORS: dict[type[ast.cmpop], str] = {
    ast.Eq: "==", ast.NotEq: "!=", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=",
    ast.In: "in", ast.NotIn: "not in", ast.Is: "is", ast.IsNot: "is not",
}  # fmt: skip
#: functions that compare their first two arguments, and how
_COMPARING = {
    "assertGreater": ">", "assertGreaterEqual": ">=", "assertLess": "<", "assertLessEqual": "<=",
    "assertEqual": "==", "assertNotEqual": "!=", "assertIn": "in", "assertNotIn": "not in",
    "assert_equal": "==", "assert_array_equal": "==", "assert_array_less": "<",
    "assertAlmostEqual": "≈", "assert_allclose": "≈", "assert_almost_equal": "≈",
    "assert_array_almost_equal": "≈", "isclose": "≈", "allclose": "≈",
}  # fmt: skip
_LIBRARIES = frozenset({"math", "numpy", "unittest"})
#: assertions with these words in their names run what they are given
_RUNS_SOMETHING = ("raises", "warn", "logs", "gc_cycles")


class Looks:
    """What the checks of the running test compared."""

    def __init__(self) -> None:
        self._noted: dict[tuple[str, str], Check] = {}
        self._more: set[tuple[str, str]] = set()

    def clear(self) -> None:
        """Another test begins."""
        self._noted.clear()
        self._more.clear()

    @property
    def more(self) -> int:
        """How many further checks the test made."""
        return len(self._more)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Those of the test until now."""
        return tuple(self._noted.values())

    def compared(self, place: str, text: str, left: Any, operator: str, right: Any) -> None:
        """``left operator right`` was evaluated."""
        with suppress(Exception):  # whatever the user's values do when they are examined, the test goes on
            self._note(place, text, margin(left, operator, right), lambda: _words(left, operator, right))

    def called(
        self, place: str, text: str, function: Any, args: tuple[Any, ...], named: Any, first: int = 0
    ) -> None:
        """A function that decides about a check has returned; ``first``: how many arguments are ``self``."""
        with suppress(Exception):  # as above
            self._called(place, text, function, args, named, first)

    def _called(
        self, place: str, text: str, function: Any, args: tuple[Any, ...], named: Any, first: int
    ) -> None:
        name = getattr(function, "__name__", "")
        library = (getattr(function, "__module__", None) or "").partition(".")[0]
        operator = _COMPARING.get(name) if library in _LIBRARIES else None
        given = _given(function, args, named) if operator is not None else {}
        if operator is None or len(given) < 2:
            self._note(place, text, None, lambda: _call_words(name, args[first:], named))
            return
        left, right = list(given.values())[:2]
        spare = within(left, right, *_tolerance(given)) if operator == "≈" else margin(left, operator, right)
        self._note(place, text, spare, lambda: _words(left, operator, right))

    def _note(self, place: str, text: str, spare: float | None, words: Callable[[], str]) -> None:
        key = place, text
        before = self._noted.get(key)
        if before is None and len(self._noted) >= MOST:
            self._more.add(key)
        elif before is None:
            self._noted[key] = Check(place, text[:_LONGEST], words(), spare)
        else:
            is_nearer = spare is not None and (before.spare is None or spare < before.spare)
            seen, least = (words(), spare) if is_nearer else (before.seen, before.spare)
            self._noted[key] = Check(place, before.text, seen, least, before.times + 1)


#: few functions are asked for theirs, and those often
_signature = functools.lru_cache(maxsize=256)(inspect.signature)


def _given(function: Any, args: tuple[Any, ...], named: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of a call by name, defaults included; none if they cannot be told."""
    try:
        bound = _signature(function).bind(*args, **named)
    except (TypeError, ValueError):
        return {}
    bound.apply_defaults()
    return {name: value for name, value in bound.arguments.items() if name != "self"}


def _tolerance(given: Mapping[str, Any]) -> tuple[Any, Any]:
    """The absolute and relative tolerance of a comparison, as the libraries document it."""
    if given.get("delta") is not None:
        return given["delta"], 0.0
    if "places" in given:  # |first - second| rounds to 0
        return 0.5 * 10.0 ** -(7 if given["places"] is None else given["places"]), 0.0
    if "decimal" in given:  # |actual - desired| < 1.5 * 10**(-decimal)
        return 1.5 * 10.0 ** -given["decimal"], 0.0
    absolute, relative = given.get("atol", given.get("abs_tol")), given.get("rtol", given.get("rel_tol"))
    return absolute or 0.0, relative or 0.0


def margin(left: Any, operator: str, right: Any) -> float | None:
    """Return how far the sides of ``left operator right`` are apart; None if that is no matter of degree.

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


def within(value: Any, expected: Any, absolute: Any, relative: Any) -> float | None:
    """How far the sides of ``|value - expected| <= absolute + relative * |expected|`` are apart."""
    if not {type(absolute), type(relative)} <= {int, float}:
        return None
    pairs = _pairs(value, expected)
    return _least(abs(absolute + relative * abs(wanted) - abs(one - wanted)) for one, wanted in pairs)


def _is_approximate(value: Any) -> bool:
    """Whether ``pytest.approx`` made it; its module has moved between releases."""
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
    return _least(abs(scalar_of(wanted).tolerance - abs(one - wanted)) for one, wanted in pairs)


def _least(found: Iterator[float]) -> float | None:
    return min((one for one in found if math.isfinite(one)), default=None)


def _pairs(left: Any, right: Any) -> list[tuple[float, float]]:
    """Numbers that stand against each other; none if there is anything else."""
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
    parts = [_numbers(one) for one in value]
    return None if None in parts else [number for part in parts for number in part or ()]


def _without_numpy(value: Any) -> Any:
    """An array of numbers as a list, a number of numpy's as a plain one; numpy is not imported for this."""
    numpy = sys.modules.get("numpy")
    if numpy is None or not isinstance(value, numpy.ndarray | numpy.generic):
        return value
    return value.tolist() if value.dtype.kind in "biuf" and value.size <= _MOST_ITEMS else value


def in_words(value: Any) -> str | None:
    """Return a plain value as people read it; None for others, whose ``repr`` may have effects."""
    value = _without_numpy(value)
    kind = type(value)
    text = None
    if _is_approximate(value):
        inner = in_words(value.expected)
        text = None if inner is None else f"approx({inner})"
    elif kind is float:
        text = f"{value:.6g}"
    elif kind in _PLAIN:
        text = repr(value)
    elif kind in (list, tuple) and len(value) <= _MOST_ITEMS:
        text = _joined("[]" if kind is list else "()", [("", one) for one in value])
    elif kind is dict and len(value) <= _MOST_ITEMS and all(type(key) in _PLAIN for key in value):
        text = _joined("{}", [(f"{key!r}: ", one) for key, one in value.items()])
    return text if text is None or len(text) <= _LONGEST_VALUE else f"{text[: _LONGEST_VALUE - 1]}…"


def _joined(brackets: str, parts: list[tuple[str, Any]]) -> str | None:
    texts = [(name, in_words(one)) for name, one in parts]
    if any(text is None for _, text in texts):
        return None
    return f"{brackets[:-1]}{', '.join(f'{name}{text}' for name, text in texts)}{brackets[-1]}"


def _words(left: Any, operator: str, right: Any) -> str:
    sides = in_words(left), in_words(right)
    return f"{sides[0]} {operator} {sides[1]}" if None not in sides else ""


def _call_words(name: str, args: tuple[Any, ...], named: Mapping[str, Any]) -> str:
    parts = [("", one) for one in args] + [(f"{key}=", one) for key, one in named.items()]
    return (_joined(f"{name}()", parts) or "") if name else ""


class Checks:
    """Puts the noting of checks into test files, and around comparisons of unittest and numpy.testing.

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
        self._names: dict[str, str] = {}
        self._is_inside = False

    def install(self) -> None:
        """Look at all test files, and the two libraries, that are imported from now on."""
        wrapt.register_post_import_hook(lambda module: self._wrap(module.TestCase, 1), "unittest.case")
        wrapt.register_post_import_hook(self._wrap_module, "numpy.testing")
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
        looks, told = self._looks, self._told
        setattr(rewriting, _COMPARED, lambda number, *parts: looks.compared(*told[number], *parts))
        setattr(rewriting, _CALLED, lambda number, *parts: looks.called(*told[number], *parts))

    def _conditions(self, tree: ast.Module, source: bytes, path: str) -> dict[_Position, int]:
        """Numbers of the comparisons and calls that decide about assertions, by where they stand."""
        lines = source.splitlines(keepends=True)  # ``ast.get_source_segment`` splits all of it for each part
        found: dict[_Position, int] = {}
        for node in ast.walk(tree):
            for part in _deciding(node.test) if isinstance(node, ast.Assert) else ():
                words = " ".join(_segment(lines, part).decode("utf-8", "replace").split())
                found[_position(part)] = len(self._told)
                self._told.append((self._place(path, part.lineno), words))
        return found

    def _place(self, file: str, line: int) -> str:
        name = self._names.get(file)
        if name is None:
            name = self._names[file] = os.path.relpath(os.path.realpath(file), self._root)
        return f"{name}:{line}"

    def _wrap_module(self, module: ModuleType) -> None:
        self._wrap(module, 0)

    def _wrap(self, owner: Any, first: int) -> None:
        """Wrap the comparisons of a module or class; ``first``: how many arguments are none of them."""
        for name in dir(owner):
            function = getattr(owner, name)
            runs = any(one in name.lower() for one in _RUNS_SOMETHING)
            if name.startswith("assert") and callable(function) and not runs:
                setattr(owner, name, self._noting(function, first))

    def _noting(self, function: Callable[..., Any], first: int) -> Callable[..., Any]:
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
            file, line = frame.f_code.co_filename, frame.f_lineno
            text = " ".join(linecache.getline(file, line).split()) or function.__name__
            self._looks.called(self._place(file, line), text, function, arguments, named, first)
            return result

        return compare


#: where an expression stands: line and column, from and to
_Position = tuple[int, int, int | None, int | None]


def _deciding(test: ast.expr) -> Iterator[ast.Compare | ast.Call]:
    """The comparisons and calls of which an assertion is made up."""
    if isinstance(test, ast.BoolOp):
        for value in test.values:
            yield from _deciding(value)
    elif isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        yield from _deciding(test.operand)
    elif isinstance(test, ast.Compare | ast.Call):
        yield test


def _position(node: ast.expr) -> _Position:
    return node.lineno, node.col_offset, node.end_lineno, node.end_col_offset


def _segment(lines: Sequence[bytes], node: ast.expr) -> bytes:
    """The source text of an expression, given all lines with their ends."""
    last = node.end_lineno or node.lineno
    found = b"".join(lines[node.lineno - 1 : last])
    after = len(lines[last - 1]) - (node.end_col_offset or 0)
    return found[node.col_offset : len(found) - after]


class _Inserter(ast.NodeTransformer):
    """Puts lines after those that work out the conditions of assertions."""

    def __init__(self, found: dict[_Position, int]) -> None:
        self._found = found

    def visit_Assign(self, node: ast.Assign) -> Any:  # the name that ast looks for
        value, target = node.value, node.targets[0]
        is_pytests = isinstance(target, ast.Name) and target.id.startswith("@py_")
        if not isinstance(value, ast.Compare | ast.Call) or not is_pytests:
            return node
        number = self._found.get(_position(value))
        if number is None or not all(isinstance(one, ast.Name | ast.Constant) for one in _parts(value)):
            return node  # what is no variable would be evaluated twice
        return [node, ast.fix_missing_locations(ast.copy_location(_line(number, value), node))]


def _parts(value: ast.Compare | ast.Call) -> list[ast.expr]:
    """What a comparison or call is made of."""
    if isinstance(value, ast.Compare):
        return [value.left, *value.comparators]
    given = [one.value if isinstance(one, ast.Starred) else one for one in value.args]
    return [value.func, *given, *(one.value for one in value.keywords)]


def _line(number: int, value: ast.Compare | ast.Call) -> ast.Expr:
    """The inserted line, which hands on the variables."""
    if isinstance(value, ast.Compare):
        operator = ast.Constant(_OPERATORS[type(value.ops[0])])
        name, parts = _COMPARED, [value.left, operator, value.comparators[0]]
    else:
        keys: list[ast.expr | None] = [
            None if one.arg is None else ast.Constant(one.arg) for one in value.keywords
        ]
        named = ast.Dict(keys, [one.value for one in value.keywords])
        name, parts = _CALLED, [value.func, ast.Tuple(list(value.args), ast.Load()), named]
    function = ast.Attribute(ast.Name("@pytest_ar", ast.Load()), name, ast.Load())
    return ast.Expr(ast.Call(function, [ast.Constant(number), *parts], []))
