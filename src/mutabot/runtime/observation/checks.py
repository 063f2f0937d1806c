"""The checks of the running test, as they are made, and by how much each of them held."""

from __future__ import annotations

import ast
import functools
import inspect
import itertools
import math
import operator
import sys
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import FunctionType
from typing import Any

from mutabot.model.outcome import Check

#: arrays with more elements than this are not looked at
_MOST = 1000
_LONGEST_VALUE = 100
_PLAIN = (str, bytes, int, float, bool, complex, range, type(None))
_ARITHMETIC: dict[type[ast.AST], Callable[..., float]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow, ast.Mod: operator.mod, ast.USub: operator.neg, ast.UAdd: operator.pos,
}  # fmt: skip
_FUNCTIONS: dict[str, Callable[..., float]] = {
    "abs": abs, "min": min, "max": max, "fabs": math.fabs, "sqrt": math.sqrt, "hypot": math.hypot,
    "radians": math.radians, "degrees": math.degrees,
}  # fmt: skip


def margin(left: Any, operator: str, right: Any) -> float | None:
    """How far the sides of ``left operator right`` are apart; None if it is no matter of more or less.

    Arrays and sequences count by their element that is nearest to end otherwise.
    """
    if operator in ("==", "!="):
        for value, other in ((left, right), (right, left)):
            if is_approximate(other):
                return _of_approximate(value, other)
        return None
    if operator not in ("<", "<=", ">", ">="):
        return None
    pairs = _pairs(left, right)
    found = [abs(other - value) for value, other in pairs] if pairs else []
    return _least(found)


def of_tolerance(value: Any, expected: Any, absolute: float, relative: float) -> float | None:
    """How far the sides of ``|value - expected| <= absolute + relative * |expected|`` are apart."""
    pairs = _pairs(value, expected) or ()
    return _least([abs(absolute + relative * abs(wanted) - abs(one - wanted)) for one, wanted in pairs])


def is_approximate(value: Any) -> bool:
    """Whether it is what ``pytest.approx`` makes."""
    kind = type(value)  # its module has moved between releases of pytest
    return kind.__module__.startswith("_pytest.") and kind.__name__.startswith("Approx")


def in_words(value: Any) -> str | None:
    """A plain value as people read it; None for others."""
    if is_approximate(value):
        expected = in_words(value.expected)
        return f"approx({expected})" if expected is not None else None
    number = _number(value)
    if number is not None and not isinstance(value, bool | int):
        return f"{number:.6g}"
    if type(value) in _PLAIN:
        return _short(repr(value))
    if type(value) in (list, tuple) and len(value) <= _MOST:
        return _gathered("[]" if type(value) is list else "()", [("", one) for one in value])
    if type(value) is dict and len(value) <= _MOST and all(type(key) in _PLAIN for key in value):
        return _gathered("{}", [(f"{key!r}: ", one) for key, one in value.items()])
    if _is_array(value) and value.size <= _MOST:
        return in_words(value.tolist())
    parts = _fields_of(value)
    return _gathered(f"{type(value).__name__}()", parts) if parts is not None else None


def _fields_of(value: Any) -> list[tuple[str, Any]] | None:
    """The fields of a dataclass or named tuple that are plainly kept; None for all else."""
    kind: Any = type(value)
    if isinstance(value, tuple) and kind.__bases__ == (tuple,) and hasattr(kind, "_fields"):
        return [(f"{name}=", one) for name, one in zip(kind._fields, tuple.__iter__(value), strict=True)]
    names = getattr(kind, "__dataclass_fields__", None)
    if names is None or kind.__getattribute__ is not object.__getattribute__:
        return None
    kept = vars(value) if hasattr(value, "__dict__") else {}
    return [(f"{name}=", kept[name]) for name in names] if kept.keys() >= names.keys() else None


def _gathered(brackets: str, parts: list[tuple[str, Any]]) -> str | None:
    texts = [(name, in_words(one)) for name, one in parts]
    if any(text is None for _, text in texts):
        return None
    return _short(f"{brackets[:-1]}{', '.join(f'{name}{text}' for name, text in texts)}{brackets[-1]}")


def _short(text: str) -> str:
    return text if len(text) <= _LONGEST_VALUE else f"{text[: _LONGEST - 1]}…"


def _of_approximate(value: Any, approximate: Any) -> float | None:
    pairs = _approximate_pairs(value, approximate.expected)
    found: list[float] = []
    for one, wanted in pairs or ():
        scalar = approximate._approx_scalar(wanted) if hasattr(approximate, "_approx_scalar") else approximate
        found.append(abs(scalar.tolerance - abs(one - wanted)))
    return _least(found)


def _approximate_pairs(value: Any, expected: Any) -> list[tuple[float, float]] | None:
    if isinstance(expected, Mapping):
        if type(value) is not dict or value.keys() != expected.keys():
            return None
        return _pairs(list(value.values()), [expected[key] for key in value])
    return _pairs(value, expected)


def _least(found: list[float]) -> float | None:
    finite = [one for one in found if math.isfinite(one)]
    return min(finite) if finite else None


def _pairs(left: Any, right: Any) -> list[tuple[float, float]] | None:
    """Numbers that stand against each other; None if there is anything else."""
    ones, others = _numbers(left), _numbers(right)
    if ones is None or others is None:
        return None
    if len(ones) == 1 != len(others):
        ones *= len(others)
    elif len(others) == 1 != len(ones):
        others *= len(ones)
    return list(zip(ones, others, strict=True)) if len(ones) == len(others) else None


def _numbers(value: Any) -> list[float] | None:
    number = _number(value)
    if number is not None:
        return [number]
    if _is_array(value):
        value = value.ravel().tolist() if value.size <= _MOST else None
    if type(value) not in (list, tuple) or len(value) > _MOST:
        return None
    found: list[float] = []
    for one in value:
        numbers = _numbers(one)
        if numbers is None:
            return None
        found += numbers
    return found


def _number(value: Any) -> float | None:
    if type(value) in (int, float, bool):
        return float(value)
    numpy = sys.modules.get("numpy")
    if numpy is not None and isinstance(value, numpy.number) and not numpy.iscomplexobj(value):
        return float(value)
    return None


def _is_array(value: Any) -> bool:
    numpy = sys.modules.get("numpy")
    return numpy is not None and type(value) is numpy.ndarray and value.dtype.kind in "biuf"


def margin_of_helper(function: Any, arguments: tuple[Any, ...], named: Mapping[str, Any]) -> float | None:
    """How far the sides of the comparison are apart that a function returns; None for any other function."""
    if not isinstance(function, FunctionType) or len(arguments) > 10:
        return None
    test = _returned(function)
    if test is None:
        return None
    try:
        given = inspect.signature(function).bind(*arguments, **named)
        given.apply_defaults()
        if any(type(one) not in (int, float) for one in given.arguments.values()):
            return None
        return _margin(test, given.arguments)
    except (ArithmeticError, LookupError, TypeError, ValueError):
        return None


@functools.lru_cache(maxsize=256)
def _returned(function: FunctionType) -> ast.expr | None:
    """The comparison that a function returns, if it does nothing else."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    except (OSError, SyntaxError, TypeError):
        return None
    found = tree.body[0]
    if not isinstance(found, ast.FunctionDef) or found.decorator_list:
        return None
    body = found.body[1:] if ast.get_docstring(found) is not None else found.body
    is_one = len(body) == 1 and isinstance(body[0], ast.Return)
    value = body[0].value if is_one and isinstance(body[0], ast.Return) else None
    return value if isinstance(value, ast.Compare | ast.BoolOp) else None


def _margin(test: ast.expr, given: Mapping[str, Any]) -> float:
    """The least of all comparisons'. Raises LookupError for what is no matter of more or less."""
    if isinstance(test, ast.BoolOp):
        return min(_margin(value, given) for value in test.values)
    if not isinstance(test, ast.Compare):
        raise LookupError(type(test).__name__)
    if not all(isinstance(one, ast.Lt | ast.LtE | ast.Gt | ast.GtE) for one in test.ops):
        raise LookupError("equality")
    values = [_value(one, given) for one in (test.left, *test.comparators)]
    return min(abs(right - left) for left, right in itertools.pairwise(values))


def _value(node: ast.expr, given: Mapping[str, Any]) -> float:
    match node:
        case ast.Constant(value=int() | float() as value):
            return value
        case ast.Name(id=name):
            return float(given[name])
        case ast.BinOp(left=left, op=op, right=right):
            return _ARITHMETIC[type(op)](_value(left, given), _value(right, given))
        case ast.UnaryOp(op=op, operand=operand):
            return _ARITHMETIC[type(op)](_value(operand, given))
        case ast.Call(func=ast.Name(id="round"), args=[value, ast.Constant(value=int() as digits)]):
            return round(_value(value, given), digits)
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(value=ast.Name(id="math"), attr=name)):
            return _FUNCTIONS[name](*(_value(one, given) for one in node.args))
    raise LookupError(type(node).__name__)


#: checks of a test that are told; of others only how many there are
MOST = 40
_LONGEST = 160


@dataclass(slots=True)
class _Noted:
    text: str
    times: int = 0
    seen: str = ""
    spare: float | None = None


class Looks:
    """What the checks of the running test compared."""

    def __init__(self) -> None:
        self._noted: dict[tuple[str, str], _Noted] = {}
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
        return tuple(
            Check(place, one.text, one.seen, one.spare, one.times) for (place, _), one in self._noted.items()
        )

    def compared(self, place: str, text: str, left: Any, operator: str, right: Any) -> None:
        """``left operator right`` was worked out."""
        self._note(place, text, margin(left, operator, right), lambda: _compared(left, operator, right))

    def near(
        self, place: str, text: str, value: Any, expected: Any, absolute: float, relative: float = 0.0
    ) -> None:
        """``value`` was compared with ``expected`` by a tolerance."""
        spare = of_tolerance(value, expected, absolute, relative)
        self._note(place, text, spare, lambda: _compared(value, "≈", expected))

    def called(
        self, place: str, text: str, function: Any, arguments: tuple[Any, ...], named: Mapping[str, Any]
    ) -> None:
        """A function was asked whether something is so."""
        name = getattr(function, "__name__", "")
        tolerances = _TOLERANCES.get((getattr(function, "__module__", None), name))
        if tolerances is not None and len(arguments) == 2 and named.keys() <= tolerances.keys():
            given = [named.get(key, usual) for key, usual in tolerances.items()]
            if all(type(one) in (int, float) for one in given):
                relative, absolute = given
                self.near(place, text, arguments[0], arguments[1], absolute, relative)
                return
        spare = margin_of_helper(function, arguments, named)
        self._note(place, text, spare, lambda: _called(name, arguments, named))

    def _note(self, place: str, text: str, spare: float | None, words: Callable[[], str]) -> None:
        key = place, text
        noted = self._noted.get(key)
        if noted is None:
            if len(self._noted) >= MOST:
                self._more.add(key)
                return
            noted = self._noted[key] = _Noted(text[:_LONGEST], 0, words(), spare)
        elif _is_nearer(spare, noted.spare):
            noted.seen, noted.spare = words(), spare
        noted.times += 1


#: functions of two values and their tolerances: names and usual values, the relative one first
_TOLERANCES: Mapping[tuple[str | None, str], Mapping[str, float]] = {
    ("math", "isclose"): {"rel_tol": 1e-9, "abs_tol": 0.0},
    ("numpy", "isclose"): {"rtol": 1e-5, "atol": 1e-8},
    ("numpy", "allclose"): {"rtol": 1e-5, "atol": 1e-8},
}


def _is_nearer(spare: float | None, before: float | None) -> bool:
    return spare is not None and spare < (math.inf if before is None else before)


def _compared(left: Any, operator: str, right: Any) -> str:
    sides = in_words(left), in_words(right)
    return f"{sides[0]} {operator} {sides[1]}" if None not in sides else ""


def _called(name: str, arguments: tuple[Any, ...], named: Mapping[str, Any]) -> str:
    parts = [("", in_words(one)) for one in arguments]
    parts += [(f"{key}=", in_words(one)) for key, one in named.items()]
    if not name or any(text is None for _, text in parts):
        return ""
    return f"{name}({', '.join(f'{key}{text}' for key, text in parts)})"
