"""What an expression would give, found out without letting anything happen.

The trunk looks ahead with it: a mutant of the program text needs no process of its own as long as its value
is the original's. Only what is known to have no effect is computed: names, constants, plain attributes and
items, operators on plain values, and a few functions of mathematics. All else is left to a real evaluation.
"""

from __future__ import annotations

import ast
import inspect
import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import FrameType, MemberDescriptorType, ModuleType
from typing import Any, NamedTuple

from mutabot.model.alternative import RUNTIME

#: beyond this many bits, or this exponent, numbers are left to a real evaluation
_LARGEST_BITS, _LARGEST_EXPONENT = 256, 64
#: descriptors that only hand out what is stored in the object
_STORED = (MemberDescriptorType, type(vars(NamedTuple("_Sample", [("item", int)]))["item"]))
_PLAIN_LOOK_UPS: tuple[Any, ...] = (
    object.__getattribute__,
    tuple.__getattribute__,
    ModuleType.__getattribute__,
)

#: functions that hand out the local names
_LOOKING = frozenset(("locals", "vars", "dir", "eval", "exec", "f_locals"))
_NUMBERS = frozenset((bool, int, float))
_PLAIN = _NUMBERS | {str, bytes, type(None)}
_CALLABLE: tuple[Callable[..., Any], ...] = (
    abs, min, max, round, len, float, int, bool,
    *(
        getattr(math, name)
        for name in (
            "acos", "asin", "atan", "atan2", "ceil", "copysign", "cos", "degrees", "dist", "exp", "fabs",
            "floor", "fmod", "hypot", "isclose", "isfinite", "isinf", "isnan", "log", "pow", "radians",
            "sin", "sqrt", "tan", "trunc",
        )
    ),
)  # fmt: skip
_CALLABLE_BY_ID = {id(function): function for function in _CALLABLE}
_ARITHMETIC: dict[type[ast.AST], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
    ast.LShift: operator.lshift,
    ast.RShift: operator.rshift,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
}
_UNARY: dict[type[ast.AST], Callable[[Any], Any]] = {
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Invert: operator.invert,
}
_COMPARISONS: dict[type[ast.AST], Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda item, among: item in among,
    ast.NotIn: lambda item, among: item not in among,
}


class UnforeseenError(Exception):
    """What an expression gives cannot be known without evaluating it."""


@dataclass(frozen=True, slots=True)
class Forms:
    """A place as an expression, and what it could read instead, as trees without any instrumentation."""

    original: ast.expr
    alternatives: tuple[ast.expr, ...]


def differing(forms: Forms, indexes: frozenset[int], frame: FrameType) -> frozenset[int]:
    """Of these alternatives, those that would not give what the original gives now, or may not.

    Args:
        frame: where the expression is about to be evaluated.
    """
    try:
        original = value_of(forms.original, frame)
    except Exception:  # whatever it is: a real evaluation will tell
        return indexes
    return frozenset(index for index in indexes if not _gives(forms.alternatives[index], original, frame))


def _gives(other: ast.expr, original: Any, frame: FrameType) -> bool:
    try:
        return is_identical(original, value_of(other, frame))
    except Exception:  # as above; what raises differs from what did not
        return False


def is_identical(one: Any, other: Any) -> bool:
    """Whether no program could tell two values apart, but for the identity of equal plain values."""
    if one is other:
        return True
    kind = type(one)
    if kind is not type(other):
        return False
    if kind is float:
        return bool(one == other) and math.copysign(1.0, one) == math.copysign(1.0, other)
    if kind is tuple:
        return len(one) == len(other) and all(map(is_identical, one, other))
    return kind in _PLAIN and bool(one == other)


def value_of(node: ast.expr, frame: FrameType) -> Any:
    """What an expression gives in a frame.

    Raises UnforeseenError if that cannot be known; and whatever the evaluation itself would raise.
    """
    return _Reader(frame).read(node)


def locals_of(frame: FrameType) -> Mapping[str, Any]:
    """The local names of a frame.

    Raises UnforeseenError in a function that calls ``locals`` itself: to look would bring up to date what it
    may have kept.
    """
    code = frame.f_code
    if code.co_flags & inspect.CO_OPTIMIZED and not _LOOKING.isdisjoint(code.co_names):
        raise UnforeseenError
    return frame.f_locals


class _Reader:
    """Reads expressions in one frame."""

    def __init__(self, frame: FrameType) -> None:
        self._locals = locals_of(frame)
        self._elsewhere = (frame.f_globals, frame.f_builtins)
        code = frame.f_code
        self._own = {*code.co_varnames, *code.co_cellvars, *code.co_freevars}

    def read(self, node: ast.expr) -> Any:
        reader = getattr(self, f"_read_{type(node).__name__.lower()}", None)
        if reader is None:
            raise UnforeseenError
        return reader(node)

    def _read_constant(self, node: ast.Constant) -> Any:
        return node.value

    def _read_name(self, node: ast.Name) -> Any:
        if node.id in self._locals:
            return self._locals[node.id]
        if node.id not in self._own and not _is_mangled(node.id):  # else it has no value yet
            for names in self._elsewhere:
                if node.id in names:
                    return names[node.id]
        raise UnforeseenError

    def _read_tuple(self, node: ast.Tuple) -> Any:
        return tuple(self.read(item) for item in node.elts)

    def _read_attribute(self, node: ast.Attribute) -> Any:
        return plain_attribute(self.read(node.value), node.attr)

    def _read_subscript(self, node: ast.Subscript) -> Any:
        container, key = self.read(node.value), self.read(node.slice)
        if type(container) not in (tuple, list, dict, str) or not _is_plain(key):
            raise UnforeseenError
        return container[key]

    def _read_unaryop(self, node: ast.UnaryOp) -> Any:
        value = self.read(node.operand)
        if isinstance(node.op, ast.Not):
            return not _truth(value)
        if type(value) not in _NUMBERS or (isinstance(node.op, ast.Invert) and type(value) is not int):
            raise UnforeseenError
        return _UNARY[type(node.op)](value)

    def _read_binop(self, node: ast.BinOp) -> Any:
        left, right = self.read(node.left), self.read(node.right)
        texts = type(left) is type(right) is str and isinstance(node.op, ast.Add)
        if type(node.op) not in _ARITHMETIC or not (texts or (_is_small(left) and _is_small(right))):
            raise UnforeseenError
        exponential = isinstance(node.op, ast.Pow | ast.LShift)
        if exponential and type(left) is not float and abs(right) > _LARGEST_EXPONENT:
            raise UnforeseenError
        return _ARITHMETIC[type(node.op)](left, right)

    def _read_boolop(self, node: ast.BoolOp) -> Any:
        wanted = isinstance(node.op, ast.Or)
        value: Any = None
        for operand in node.values:
            value = self.read(operand)
            if _truth(value) is wanted:
                break
        return value

    def _read_ifexp(self, node: ast.IfExp) -> Any:
        return self.read(node.body if _truth(self.read(node.test)) else node.orelse)

    def _read_compare(self, node: ast.Compare) -> Any:
        left = self.read(node.left)
        result: Any = True
        for sign, comparator in zip(node.ops, node.comparators, strict=True):
            right = self.read(comparator)
            result = _compared(sign, left, right)
            if not result:
                break
            left = right
        return result

    def _read_call(self, node: ast.Call) -> Any:
        if node.keywords:
            raise UnforeseenError
        function = _HELPERS.get(_helper_name(node.func)) or self._known_function(node.func)
        arguments = [self.read(argument) for argument in node.args]
        if not all(_is_plain(argument) for argument in arguments):
            raise UnforeseenError
        return function(*arguments)

    def _known_function(self, node: ast.expr) -> Callable[..., Any]:
        known = _CALLABLE_BY_ID.get(id(self.read(node)))
        if known is None:
            raise UnforeseenError
        return known


def _fail_if(value: Any, wrong: Any, *told: str) -> Any:
    if value == wrong:
        raise ZeroDivisionError
    return value


#: what templates call (``Alternatives``)
_HELPERS: dict[str, Callable[..., Any]] = {"absolute": abs, "fail_if": _fail_if}


def _helper_name(function: ast.expr) -> str:
    """The name after ``__mutabot__[0].``; empty for all other functions."""
    if not isinstance(function, ast.Attribute) or not isinstance(function.value, ast.Subscript):
        return ""
    switches = function.value.value
    return function.attr if isinstance(switches, ast.Name) and switches.id == RUNTIME else ""


def _compared(sign: ast.cmpop, left: Any, right: Any) -> Any:
    if isinstance(sign, ast.Is | ast.IsNot):
        if type(left) is type(right) and left is not None and not isinstance(left, bool) and _is_plain(left):
            raise UnforeseenError  # whether equal constants are one object is up to the compiler
        return (left is right) == isinstance(sign, ast.Is)
    among = isinstance(sign, ast.In | ast.NotIn) and type(right) in (list, dict, set, frozenset)
    if not _is_plain(left) or not (_is_plain(right) or (among and all(map(_is_plain, right)))):
        raise UnforeseenError
    return _COMPARISONS[type(sign)](left, right)


def _truth(value: Any) -> bool:
    if not _is_plain(value) and type(value) not in (list, dict, set):
        raise UnforeseenError
    return bool(value)


def _is_plain(value: Any) -> bool:
    """Whether a value is of a built-in type whose operators have no effects."""
    return type(value) in _PLAIN or (type(value) is tuple and all(map(_is_plain, value)))


def _is_mangled(name: str) -> bool:
    """Whether a class body changes this name into another one."""
    return name.startswith("__") and not name.endswith("__")


def _is_small(value: Any) -> bool:
    kind = type(value)
    return kind in (float, bool) or (kind is int and value.bit_length() <= _LARGEST_BITS)


def plain_attribute(owner: Any, name: str) -> Any:
    """An attribute that is merely stored: on the object, in a slot, in a named tuple, or in a module.

    Raises UnforeseenError for all others: to read a property may be to read a robot.
    """
    kind = type(owner)
    if isinstance(owner, type) or kind.__getattribute__ not in _PLAIN_LOOK_UPS or _is_mangled(name):
        raise UnforeseenError
    found = next((vars(base)[name] for base in kind.__mro__ if name in vars(base)), None)
    if isinstance(found, _STORED):
        return found.__get__(owner, kind)
    if found is not None and hasattr(type(found), "__get__"):
        raise UnforeseenError
    stored = getattr(owner, "__dict__", None)
    if type(stored) is dict and name in stored:
        return stored[name]
    if found is None:
        raise UnforeseenError
    return found
