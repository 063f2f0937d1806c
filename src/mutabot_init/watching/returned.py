"""Finds the names of the elements of a tuple that a function returns, in its text or its docstring."""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections.abc import Iterator
from typing import Any

#: how docstrings name the elements of a tuple: ``Returns: Tuple of (x, y, angle)``
_NAMED = re.compile(r"\breturns?\b[^()]{0,80}\((\w+(?:\s*,\s*\w+)+)\)", re.IGNORECASE)
#: functions that change no more than the form of a value
_FORMS = frozenset({"abs", "bool", "float", "int", "round", "str"})


def names_of_elements(function: Any) -> list[str]:
    """Return the names of the elements of a returned tuple; an empty one is unknown, no names: no tuple."""
    tuples = list(_tuples(function))
    if tuples and len({len(names) for names in tuples}) == 1:
        return [names[0] if len(set(names)) == 1 else "" for names in zip(*tuples, strict=True)]
    found = _NAMED.search(getattr(function, "__doc__", None) or "")
    return re.split(r"\s*,\s*", found[1]) if found and not tuples else []


def _tuples(function: Any) -> Iterator[list[str]]:
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    except (OSError, TypeError, SyntaxError, SystemError):  # as in ``effects``
        return
    inner = {
        id(node)
        for definition in ast.walk(tree)
        if isinstance(definition, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        and definition is not tree.body[0]
        for node in ast.walk(definition)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Return) and isinstance(node.value, ast.Tuple) and id(node) not in inner:
            yield [_name_of(element) for element in node.value.elts]


def _name_of(node: ast.expr) -> str:
    if isinstance(node, ast.Call):
        is_form = isinstance(node.func, ast.Name) and node.func.id in _FORMS and bool(node.args)
        return _name_of(node.args[0] if is_form else node.func)
    if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant):
        return node.slice.value if isinstance(node.slice.value, str) else ""
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""
