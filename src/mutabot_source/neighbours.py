"""Finds the values that several calls have at the same place: waypoints, names of poses, settings.

What one call of a function gets, another call of it could get as well. So no types need to be known.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

_WITHOUT_NEIGHBOURS = {
    "print", "debug", "info", "warning", "error", "critical", "exception", "log", "isinstance", "issubclass",
    "getattr", "setattr", "hasattr", "range", "round", "min", "max", "pow", "len", "int", "float", "str",
    "format", "open", "encode", "decode", "split", "join", "strip", "TypeVar",
}  # fmt: skip
#: longer texts are messages for people
_LONGEST = 40


class Neighbours:
    """The values that a module's calls and subscripts have at the same places.

    Args:
        tree: the tree of the module.
    """

    def __init__(self, tree: ast.Module) -> None:
        self._places: dict[ast.expr, str] = {}
        self._values: dict[str, list[ast.expr]] = {}
        for node in ast.walk(tree):
            for place, value in _passed_values(node):
                if _is_fixed(value):
                    self._places[value] = place
                    self._values.setdefault(place, []).append(value)
        for found in self._values.values():
            found.sort(key=lambda expression: (expression.lineno, expression.col_offset))

    def next_of(self, node: ast.AST) -> ast.expr | None:
        """Return the next different value at this place in the text, cyclically; None if there is none."""
        if not isinstance(node, ast.expr) or node not in self._places:
            return None
        place = self._places[node]
        values = self._values[place]
        start = values.index(node)
        for other in [*values[start + 1 :], *values[:start]]:
            if ast.dump(other) != ast.dump(node) and _kind(other) == _kind(node):
                return other
        return None


def _passed_values(node: ast.AST) -> Iterator[tuple[str, ast.expr]]:
    """Yield the values passed to a call or subscript, each with a key of its place."""
    if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name | ast.Attribute):
        yield f"{ast.unparse(node.value)}[]", node.slice
    elif isinstance(node, ast.Call):
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        if not name or name in _WITHOUT_NEIGHBOURS or name.endswith(("Error", "Exception", "Warning")):
            return
        for number, value in enumerate(node.args):
            is_row = isinstance(value, ast.Starred)
            yield f"{name} {'*' * is_row}{number}", value.value if isinstance(value, ast.Starred) else value
        yield from (
            (f"{name} {keyword.arg}", keyword.value) for keyword in node.keywords if keyword.arg is not None
        )


def _is_fixed(node: ast.expr) -> bool:
    """Return whether an expression is constant in the module, and neither a truth value nor a message."""
    match node:
        case ast.Constant(value=str() as text):
            return 0 < len(text) <= _LONGEST and " " not in text
        case ast.Constant(value=value):
            return isinstance(value, int | float) and not isinstance(value, bool)
        case ast.UnaryOp(op=ast.USub()):
            return isinstance(node.operand, ast.Constant) and _is_fixed(node.operand)
        case ast.Tuple() | ast.List():
            return bool(node.elts) and all(_is_fixed(element) for element in node.elts)
        case ast.Name(id=name):
            return name.isupper()
        case ast.Attribute(attr=name):
            return name.isupper() and isinstance(node.value, ast.Name)
    return False


def _kind(node: ast.expr) -> str:
    """Return the kind of an expression's value, as far as the text shows it."""
    match node:
        case ast.Constant(value=str()):
            return "text"
        case ast.Constant() | ast.UnaryOp():
            return "number"
        case ast.Tuple() | ast.List():
            return f"row of {len(node.elts)}"
    return "name"
