"""Determines whether a function only computes, so that its calls change nothing on a robot."""

from __future__ import annotations

import ast
import inspect
import re
import sys
import textwrap
from functools import cached_property
from types import FunctionType, MappingProxyType, ModuleType
from typing import Any, TypeGuard

#: functions that are followed from one
_DEPTH = 6
#: modules by which a program reaches what is outside it
_OUTSIDE = frozenset(
    {
        "asyncio", "ctypes", "http", "io", "multiprocessing", "os", "requests", "select", "serial", "shutil",
        "signal", "socket", "subprocess", "threading", "time", "urllib", "usb", "websocket", "zmq",
    }
)  # fmt: skip
#: expressions that make an object
_MAKING = (
    ast.BinOp, ast.Dict, ast.DictComp, ast.JoinedStr, ast.List, ast.ListComp, ast.Set, ast.SetComp, ast.Tuple,
)  # fmt: skip
_EFFECTS = (
    ast.Await,
    ast.Yield,
    ast.YieldFrom,
    ast.Global,
    ast.Nonlocal,
    ast.Delete,
    ast.AsyncFor,
    ast.AsyncWith,
)


def only_computes(function: Any, owner: type | None = None) -> bool:
    """Return whether the text of a function shows that it only computes its result.

    A function whose text is not there, that returns no computed value, that writes to its arguments or calls
    what cannot be followed may do anything.
    """
    return _Function.of(function, owner, frozenset()).only_computes


class _Function:
    """The text of a function.

    Args:
        tree: its definition; None if there is no text.
        names: the global names of its module.
        owner: the class of its ``self``.
        callers: the functions that call it here.
    """

    def __init__(self, tree: Any, names: dict[str, Any], owner: type | None, callers: frozenset[Any]) -> None:
        self._tree, self._names, self._owner, self._callers = tree, names, owner, callers

    @classmethod
    def of(cls, function: Any, owner: type | None, callers: frozenset[Any]) -> _Function:
        function = getattr(function, "__func__", function)
        function = inspect.unwrap(function) if callable(function) else function
        try:
            tree: Any = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
        # SystemError: until Python 3.12, threads that parse at the same time may disturb each other
        except (OSError, TypeError, SyntaxError, SystemError, IndexError):
            tree = None
        names = getattr(function, "__globals__", {})
        return cls(tree if isinstance(tree, ast.FunctionDef) else None, names, owner, callers | {function})

    @property
    def only_computes(self) -> bool:
        """Whether it returns what it computes, and has no other effect."""
        returned = [node.value for node in self._nodes if isinstance(node, ast.Return)]
        is_computed = any(not isinstance(value, ast.Constant | None) for value in returned)
        return is_computed and self._may_be_left_out

    @property
    def only_checks(self) -> bool:
        """Whether all it does is to raise where something is wrong with its arguments."""
        return any(isinstance(node, ast.Raise) for node in self._nodes) and self._may_be_left_out

    @cached_property
    def _nodes(self) -> list[ast.AST]:
        is_known = self._tree is not None and len(self._callers) <= _DEPTH
        return list(ast.walk(self._tree)) if is_known else []

    @property
    def _may_be_left_out(self) -> bool:
        return self._uses_arguments(self._nodes) and self._has_no_effect(self._nodes)

    def _uses_arguments(self, nodes: list[ast.AST]) -> bool:
        """Return whether it uses its arguments; a fake of the robot does not."""
        names = {node.arg for node in nodes if isinstance(node, ast.arg)} - {"self", "cls"}
        return not names or any(isinstance(node, ast.Name) and node.id in names for node in nodes)

    def _has_no_effect(self, nodes: list[ast.AST]) -> bool:
        if any(isinstance(node, _EFFECTS) for node in nodes):
            return False
        if any(_root(node) not in self._own for node in nodes if _is_stored(node)):
            return False
        return all(self._is_harmless(node) for node in nodes if isinstance(node, ast.Call))

    @cached_property
    def _own(self) -> set[str]:
        """The names of objects that it makes, rather than only looks up."""
        made, others = set[str](), set[str]()
        values = {id(node): node for node in ast.walk(self._tree) if isinstance(node, ast.Assign)}
        for node in values.values():
            for target in node.targets:
                names = made if isinstance(target, ast.Name) and self._is_made(node.value) else others
                names.update(inner.id for inner in ast.walk(target) if _is_bound(inner))
        assigned = {
            id(inner) for node in values.values() for target in node.targets for inner in ast.walk(target)
        }
        others.update(
            inner.id for inner in ast.walk(self._tree) if _is_bound(inner) and id(inner) not in assigned
        )
        return made - others

    def _is_made(self, value: ast.expr) -> bool:
        while isinstance(value, ast.Attribute | ast.Subscript):  # a part of what is made
            value = value.value
        if isinstance(value, ast.Call):
            found = self._found(value.func)
            module = (getattr(found, "__module__", "") or "").partition(".")[0]
            return isinstance(found, type) or module in _COMPUTING
        return isinstance(value, _MAKING)

    def _is_harmless(self, call: ast.Call) -> bool:
        function, root = call.func, _root(call.func)
        if root in self._own:
            return True
        if isinstance(function, ast.Name) and root == "cls":
            return True  # an object is made
        if isinstance(function, ast.Attribute) and function.attr in _METHODS and function.attr != "get":
            return True
        if isinstance(function, ast.Attribute) and self._is_of_constant(function):
            return True
        if isinstance(function, ast.Attribute) and root in ("self", "cls") and self._owner is not None:
            found = inspect.getattr_static(self._owner, function.attr, None)
            return isinstance(function.value, ast.Name) and self._may_be_called(found, self._owner)
        if root is None or (root not in self._names and not hasattr(_builtins(), root)):
            return isinstance(function, ast.Attribute) and function.attr == "get"
        return self._may_be_called(self._found(function), None)

    def _is_of_constant(self, function: ast.Attribute) -> bool:
        """Return whether it is a method, of a table or value of the module, that only reads it."""
        holder = self._found(function.value)
        kind = type(holder)  # methods of a subclass, as of members of an IntEnum, may do anything
        return kind in _UNCHANGING or (kind in _TABLES and function.attr in _METHODS)

    def _may_be_called(self, found: Any, owner: type | None) -> bool:
        if isinstance(found, type):
            return True  # an object is made
        if getattr(found, "__func__", found) in self._callers:
            return True
        module = (getattr(found, "__module__", "") or "").partition(".")[0]
        if module in _OUTSIDE or found in _WRITING:
            return False
        if module in _COMPUTING or (module == "random" and getattr(found, "__name__", "") in _DRAWING):
            return True
        # a cached function is a wrapper; hasattr is true of all names of mock.call
        is_wrapper = "__wrapped__" in getattr(found, "__dict__", {})
        is_text = is_wrapper or isinstance(found, FunctionType | staticmethod | classmethod)
        if not is_text:
            return False
        function = _Function.of(found, owner, self._callers)
        return function.only_computes or function.only_checks

    def _found(self, node: ast.expr) -> Any:
        """Return the object to which a name, or attributes of one, refer now."""
        if isinstance(node, ast.Name):
            return self._names.get(node.id, getattr(_builtins(), node.id, None))
        if isinstance(node, ast.Attribute):
            holder = self._found(node.value)
            is_known = isinstance(holder, ModuleType | type)
            return inspect.getattr_static(holder, node.attr, None) if is_known else None
        return None


#: libraries that compute
_COMPUTING = frozenset(
    {
        "_hashlib", "_struct", "base64", "binascii", "builtins", "cmath", "copy", "functools", "hashlib",
        "itertools", "math", "numpy", "operator", "re", "scipy", "statistics", "uuid", "zlib",
    }
)  # fmt: skip
#: functions of ``random`` that draw a number: others shuffle what they are given, or hand out a part of it
_DRAWING = frozenset({"gauss", "getrandbits", "randbytes", "randint", "random", "randrange", "uniform"})
#: built-in functions that do more than compute
_WRITING = (print, open, input, setattr, delattr, exec, eval)
#: methods of numbers, arrays, texts and bytes that compute
_METHODS = frozenset(
    {
        "astype", "bit_length", "casefold", "conjugate", "copy", "count", "decode", "dot", "encode",
        "endswith", "findall", "flatten", "format", "fullmatch", "get", "group", "groupdict", "groups",
        "hex", "index", "inv", "isalnum", "isalpha", "isascii", "isdecimal", "isdigit", "isnumeric",
        "isspace", "item", "items", "join", "keys", "ljust", "lower", "lstrip", "max", "mean", "min",
        "partition", "ravel", "removeprefix", "removesuffix", "reshape", "rjust", "rpartition", "rsplit",
        "rstrip", "split", "splitlines", "startswith", "strip", "sum", "to_bytes", "tolist", "transpose",
        "upper", "values", "zfill",
    }
)  # fmt: skip
#: constants of a module: no method changes the first, and those of ``_METHODS`` do not change the others
_UNCHANGING = (str, bytes, int, float, tuple, frozenset, range, re.Pattern)
_TABLES = (dict, list, set, MappingProxyType)


def _builtins() -> ModuleType:
    return sys.modules["builtins"]


def _is_stored(node: ast.AST) -> bool:
    return isinstance(node, ast.Attribute | ast.Subscript) and isinstance(node.ctx, ast.Store)


def _is_bound(node: ast.AST) -> TypeGuard[ast.Name]:
    return isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)


def _root(node: Any) -> str | None:
    """Return the name at which attributes and items begin; None if they begin with another expression."""
    while isinstance(node, ast.Attribute | ast.Subscript | ast.Starred):
        node = node.value
    return node.id if isinstance(node, ast.Name) else None
