"""The modules that a Python file may import, by its text alone."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from importlib.util import decode_source

#: a name of all modules: the text does not say which are imported
ANY = "*"
#: modules that import what the text does not name
_IMPORTING = {"importlib", "runpy", "pkgutil"}


def imported_names(source: bytes) -> frozenset[str]:
    """Return the dotted names of what a file may import, of relative imports without the dots before them.

    ``ANY`` is among them if the text does not say all; of a text that is no Python there are none.
    """
    try:
        return frozenset(_imports(ast.parse(decode_source(source))))
    except (SyntaxError, ValueError):
        return frozenset()


def _imports(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            module = f"{node.module}." if node.module else ""
            names = [f"{module}{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Name) and node.id == "__import__":
            names = [ANY]
        yield from names
        if not _IMPORTING.isdisjoint(name.partition(".")[0] for name in names):
            yield ANY
