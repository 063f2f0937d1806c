"""What a program's text tells: values that it compares with, and calls that no test reaches."""

from __future__ import annotations

import ast
import builtins
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

from mutabot.extensions import libraries

from .layout import Layout, parsed

_NO_ROBOTS = frozenset({*sys.stdlib_module_names, "numpy", "np", "pytest", "math3d"})


@dataclass(frozen=True)
class Unreached:
    """A call in the text that was not seen: its file, line and callee as written."""

    file: str
    line: int
    callee: str


def compared_with(layout: Layout) -> list[list[Any]]:
    """Constants that the program and its tests compare one and the same thing with, a list for each thing."""
    groups: dict[str, list[Any]] = {}
    for path in (*layout.program, *layout.tests):
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.Compare):
                constants = [value for one in node.comparators for value in _constants(one)]
                groups.setdefault(ast.unparse(node.left), []).extend(constants)
            elif isinstance(node, ast.Match):
                patterns = [one.pattern for one in node.cases]
                values = [v for p in patterns for one in ast.walk(p) if isinstance(one, ast.MatchValue)
                          for v in _constants(one.value)]  # fmt: skip
                groups.setdefault(ast.unparse(node.subject), []).extend(values)
    return [list(dict.fromkeys(group)) for group in groups.values() if group]


def with_compared(values: Sequence[Any], groups: Iterable[Sequence[Any]]) -> list[Any]:
    """Values that were seen, and those that the program compares the same thing with."""
    found = list(values)
    for group in groups:
        if any(isinstance(value, str) and value in group for value in values):
            found += [value for value in group if value not in found]
    return found


def unreached(layout: Layout, seen: Iterable[tuple[str, int, str]]) -> list[Unreached]:
    """Calls of the text that the run did not make; ``seen``: file, line and name of those it did."""
    made = set(seen)
    lines = {(file, line) for file, line, _ in made}  # a function may have another name here
    found: dict[tuple[str, str], Unreached] = {}
    for path in layout.program:
        tree, file = parsed(path), layout.relative(path)
        own = {one.name for one in ast.walk(tree)
               if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)}  # fmt: skip
        for node, names in _callees(tree):
            line = node.func.end_lineno or node.lineno
            is_made = (file, line, names[-1]) in made or (len(names) == 1 and (file, line) in lines)
            if not is_made and not _is_plain(names, own):
                call = Unreached(file, line, ".".join(names))
                found.setdefault((file, call.callee), call)
    return sorted(found.values(), key=lambda call: (call.file, call.line))


def _callees(tree: ast.Module) -> Iterator[tuple[ast.Call, list[str]]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            names: list[str] = []
            part: ast.expr = node.func
            while isinstance(part, ast.Attribute):
                names.insert(0, part.attr)
                part = part.value
            if isinstance(part, ast.Name):
                yield node, [part.id, *names]


def _is_plain(names: Sequence[str], own: set[str]) -> bool:
    """Whether it is no robot's: a builtin, a class, something private or of the standard library."""
    last = names[-1]
    return (
        (len(names) == 1 and (hasattr(builtins, last) or last in own))
        or names[0] in _NO_ROBOTS
        or any(fnmatchcase(names[0], one) and last not in known for one, known in libraries().items())
        or last.startswith("_")
        or last[:1].isupper()
        or any(hasattr(kind, last) for kind in (list, dict, str, set))
        or (names[0] == "self" and last in own)
    )


def _constants(node: ast.expr) -> Iterator[Any]:
    parts = node.elts if isinstance(node, ast.Tuple | ast.List | ast.Set) else [node]
    for part in parts:
        if isinstance(part, ast.Constant) and isinstance(part.value, str | int | float):
            yield part.value
