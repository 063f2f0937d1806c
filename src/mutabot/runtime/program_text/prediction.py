"""Predict the value of an expression without side effects.

The fork parent looks ahead with it: a mutant of the program text needs no process of its own as long as its
value is the original's. And a mutant gets from it what the original would have given. Operators on plain
numbers and texts are computed, and a few functions; what they work on are constants, names, and stored
attributes and items. All else is left to a real evaluation.
"""

from __future__ import annotations

import ast
import math
import struct
import sys
import types
from collections.abc import Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext, suppress
from typing import Any, NamedTuple

from mutabot.frozen import frozen
from mutabot.model.data import is_scalar_of_numpy, is_textual
from mutabot.model.program_text import RUNTIME

#: integers of more bits are left to a real evaluation
_LARGEST = 256
_NUMBERS = frozenset((bool, int, float))
_PLAIN_TYPES = _NUMBERS | {str, type(None)}
#: expressions that are computed: those that may take long for anything but numbers, and all others
_CALCULATING = (ast.Call, ast.UnaryOp, ast.BinOp)
_KNOWN = (*_CALCULATING, ast.Name, ast.Constant, ast.BoolOp, ast.IfExp, ast.Compare)
#: they may take long or warn; and whether equal values are one object is up to the compiler
_LEFT_OUT = (ast.Pow, ast.LShift, ast.Invert, ast.Is, ast.IsNot)
_CALLABLE = (
    abs, bool, float, int, max, min, round, math.acos, math.asin, math.atan, math.atan2, math.ceil,
    math.copysign, math.cos, math.degrees, math.dist, math.exp, math.fabs, math.floor, math.fmod, math.hypot,
    math.isclose, math.log, math.pow, math.radians, math.sin, math.sqrt, math.tan, math.trunc,
)  # fmt: skip
#: ``inspect.CO_OPTIMIZED``: the flag of code whose local names are its own
_OPTIMIZED = 1
#: functions that hand out the local names
_LOOKING = frozenset(("locals", "vars", "dir", "eval", "exec", "f_locals"))
#: descriptors that only hand out what is stored in the object
_STORED = (types.MemberDescriptorType, type(vars(NamedTuple("_Sample", [("item", int)]))["item"]))
_PLAIN_LOOK_UPS: list[Any] = [kind.__getattribute__ for kind in (object, tuple, types.ModuleType)]


class UnpredictableError(Exception):
    """The value of an expression cannot be known without evaluating it."""


def _fail_if(value: Any, wrong: Any, *values: str) -> Any:
    if value == wrong:
        raise ZeroDivisionError
    return value


#: what templates call (``Alternatives``)
_HELPERS = types.SimpleNamespace(absolute=abs, fail_if=_fail_if)
_HELPER_NAMES = frozenset(f"{RUNTIME}[0].{name}" for name in vars(_HELPERS))


class PredictedForm:
    """An expression whose value follows from those of its leaves.

    The value of one that does more than to calculate and to compare is never known. The tree is changed.
    """

    def __init__(self, tree: ast.expr) -> None:
        leaves = _Leaves()
        self._code: types.CodeType | None = None
        with suppress(UnpredictableError):
            tree = leaves.visit(tree)
            self._kinds = _NUMBERS if leaves.calculates else _PLAIN_TYPES
            self._check(leaves.constants)
            self._code = compile(ast.Expression(tree), "<predicted>", "eval")
        self._leaves, self._functions = leaves.found, leaves.functions

    def value(self, frame: types.FrameType) -> Any:
        """Return the expression's value in a frame.

        Raises UnpredictableError if that cannot be known; and whatever the evaluation itself would raise.
        """
        if self._code is None:
            raise UnpredictableError
        values = {name: _read(leaf, frame) for name, leaf in self._leaves.items()}
        has_numpy = self._check(values.values())
        functions = {name: _read(leaf, frame) for name, leaf in self._functions.items()}
        if not all(any(function is known for known in _CALLABLE) for function in functions.values()):
            raise UnpredictableError
        with _silent() if has_numpy else nullcontext():
            found = eval(self._code, {"__builtins__": {}, RUNTIME: [_HELPERS]}, values | functions)
        if type(found) is tuple:  # as ``max((a, b), (c, d))`` gives
            raise UnpredictableError
        return found

    def _check(self, values: Iterable[Any]) -> bool:
        """Refuse values that are not plain, and return whether any is of numpy."""
        has_numpy = False
        for value in values:
            if type(value) in self._kinds:
                if type(value) is int and value.bit_length() > _LARGEST:
                    raise UnpredictableError
            elif is_number_of_numpy(value):
                has_numpy = True
            else:
                raise UnpredictableError
        return has_numpy


class _Leaves(ast.NodeTransformer):
    """Replaces everything that is read from a frame by names, and refuses unpredictable expressions.

    Attributes:
        found: what is read, by the name that stands for it.
        functions: the same for what is called.
        constants: all constants.
        calculates: whether anything in it works with numbers only.
    """

    def __init__(self) -> None:
        self.found: dict[str, ast.expr] = {}
        self.functions: dict[str, ast.expr] = {}
        self.constants: list[object] = []
        self.calculates = False

    def visit(self, node: ast.AST) -> Any:
        if isinstance(node, ast.Name | ast.Attribute | ast.Subscript):
            return self._stand_in(node, self.found)
        if isinstance(node, _LEFT_OUT) or (isinstance(node, ast.expr) and not isinstance(node, _KNOWN)):
            raise UnpredictableError
        self.calculates |= isinstance(node, _CALCULATING)
        if isinstance(node, ast.Constant):
            self.constants.append(node.value)
        return super().visit(node)

    def visit_Call(self, node: ast.Call) -> ast.expr:  # the name that ast looks for
        if node.keywords:
            raise UnpredictableError
        texts: list[ast.expr] = []
        if ast.unparse(node.func) in _HELPER_NAMES:
            texts = [argument for argument in node.args if isinstance(getattr(argument, "value", None), str)]
        else:
            node.func = self._stand_in(node.func, self.functions)
        node.args = [argument if argument in texts else self._argument(argument) for argument in node.args]
        return node

    def _argument(self, node: ast.expr) -> Any:
        """Visit an argument; only arguments may be tuples of values, such as points."""
        if isinstance(node, ast.Tuple):
            node.elts = [self.visit(item) for item in node.elts]
            return node
        return self.visit(node)

    def _stand_in(self, node: ast.expr, among: dict[str, ast.expr]) -> ast.expr:
        name = f"leaf_{len(self.found) + len(self.functions)}"
        among[name] = node
        return ast.copy_location(ast.Name(name, ast.Load()), node)


@frozen
class Forms:
    """The original at a place as an expression, with its alternatives."""

    original: PredictedForm
    alternatives: tuple[PredictedForm, ...]

    def differing(self, indexes: frozenset[int], frame: types.FrameType) -> frozenset[int]:
        """Return the alternatives whose value in a frame may differ from the original's."""
        try:
            given = self.original.value(frame)
        except Exception:  # whatever it is: a real evaluation will show it
            return indexes
        return frozenset(index for index in indexes if not self._gives(index, given, frame))

    def _gives(self, index: int, given: Any, frame: types.FrameType) -> bool:
        try:
            return is_identical(given, self.alternatives[index].value(frame))
        except Exception:  # as above; what raises differs from what did not
            return False


def is_identical(first: Any, second: Any) -> bool:
    """Return whether a program cannot distinguish two values, except by the identity of plain ones.

    Of two objects that are not plain, the answer is False: to compare them would run code of the program,
    and one that can be changed is not the other.
    """
    kind = type(first)
    if first is second or kind is not type(second):
        return first is second
    if kind is float:
        return struct.pack("d", first) == struct.pack("d", second)
    if is_number_of_numpy(first):
        return bool(first.tobytes() == second.tobytes())
    if kind is complex or (is_textual(first) and not hasattr(first, "tzinfo")):
        return repr(first) == repr(second)
    return kind in _PLAIN_TYPES and bool(first == second)


def is_number_of_numpy(value: Any) -> bool:
    """Return whether a value is a number or truth value of numpy that is no longer than 64 bits."""
    is_number = is_scalar_of_numpy(value) and value.dtype.kind in "biuf"
    return is_number and value.dtype.itemsize <= struct.calcsize("d")


def _silent() -> AbstractContextManager[Any]:
    """Return a context in which numpy does not warn of overflows and divisions by zero."""
    silent: AbstractContextManager[Any] = sys.modules["numpy"].errstate(all="ignore")
    return silent


def locals_of(frame: types.FrameType) -> Mapping[str, Any]:
    """Return the local names of a frame.

    Up to Python 3.12 a function keeps what it has shown of them until it ends. That is emptied, or an object
    would outlive its ``del``.

    Raises UnpredictableError in a function that calls ``locals`` itself: to look would bring up to date what
    it may have kept.
    """
    code = frame.f_code
    if not code.co_flags & _OPTIMIZED:
        return frame.f_locals
    if not _LOOKING.isdisjoint(code.co_names):
        raise UnpredictableError
    shown: Any = frame.f_locals
    found = dict(shown)
    if type(shown) is dict:
        shown.clear()
    return found


def plain_attribute(owner: Any, name: str) -> Any:
    """Return an attribute that is merely stored: on an object, in a slot, named tuple or module.

    Raises UnpredictableError for all others: to read a property may be to read a robot.
    """
    kind = type(owner)
    # ``isinstance`` would ask an object for its ``__class__``
    if issubclass(kind, type) or kind.__getattribute__ not in _PLAIN_LOOK_UPS or _is_mangled(name):
        raise UnpredictableError
    found: Any = next((vars(base)[name] for base in kind.__mro__ if name in vars(base)), None)
    if type(found) in _STORED:
        return found.__get__(owner, kind)
    if found is not None and hasattr(type(found), "__get__"):
        raise UnpredictableError
    stored = getattr(owner, "__dict__", None)
    if type(stored) is dict and name in stored:
        return stored[name]
    if found is None:
        raise UnpredictableError
    return found


def _read(leaf: ast.expr, frame: types.FrameType) -> Any:
    if isinstance(leaf, ast.Name):
        return _named(leaf.id, frame)
    if isinstance(leaf, ast.Attribute):
        return plain_attribute(_read(leaf.value, frame), leaf.attr)
    if isinstance(leaf, ast.Subscript):
        container, key = _read(leaf.value, frame), _read(leaf.slice, frame)
        if type(container) in (tuple, list, dict, str) and type(key) in _PLAIN_TYPES:
            return container[key]
    if isinstance(leaf, ast.Constant):
        return leaf.value
    raise UnpredictableError


def _named(name: str, frame: types.FrameType) -> Any:
    """Return what a name denotes in a frame; an unbound local name does not denote a global."""
    local, code = locals_of(frame), frame.f_code
    if name in local:
        return local[name]
    is_own = name in code.co_varnames or name in code.co_cellvars or name in code.co_freevars
    for names in (frame.f_globals, frame.f_builtins):
        if name in names and not is_own and not _is_mangled(name):
            return names[name]
    raise UnpredictableError


def _is_mangled(name: str) -> bool:
    """Return whether a class body mangles this name."""
    return name.startswith("__") and not name.endswith("__")
