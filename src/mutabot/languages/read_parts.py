"""Find which parts of a call's result a Python function reads, where its text shows that.

The text shows it where the result is discarded, where a part is read at the call (``arm.pose().z``), and
where a local name takes the result, or names take its elements, and all that the function does with these
names is to read parts of them. Of a result that goes anywhere else it is unknown.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from typing import TYPE_CHECKING

from mutabot.languages.python import extent_of
from mutabot.model.path import PathSteps, Step
from mutabot.model.source_units import FunctionNode

if TYPE_CHECKING:
    from mutabot.model.mutant import Extent

#: functions that may read any local variable
_READ_ALL = frozenset({"locals", "vars", "dir", "eval", "exec"})


def read_parts(source: str) -> Mapping[Extent, frozenset[PathSteps]]:
    """Return the paths into the results of calls, by the extents of the calls; without those unknown.

    A result of which nothing is read has none. Raises SyntaxError or ValueError for a file that cannot be
    read.
    """
    tree = ast.parse(source)
    for node in ast.walk(tree):
        for child in ast.iter_child_nodes(node):
            child.parent = node  # type: ignore[attr-defined]
    calls = (node for node in ast.walk(tree) if isinstance(node, ast.Call))
    found = ((extent_of(call), _parts_of(call)) for call in calls)
    return {extent: parts for extent, parts in found if parts is not None}


def _parts_of(call: ast.expr) -> frozenset[PathSteps] | None:
    """Return the paths into the value of a call; None if they are not known."""
    match _parent(call):
        case ast.Await() as awaited:
            return _parts_of(awaited)
        case ast.Expr():
            return frozenset()
        case ast.Assign(targets=[ast.Name(id=name)]) as statement:
            return _paths(_reads(name, statement))
        case ast.AnnAssign(target=ast.Name(id=name), value=value) as statement if value is call:
            return _paths(_reads(name, statement))
        case ast.Assign(targets=[ast.Tuple(elts=targets) | ast.List(elts=targets)]) as statement:
            return _elements(targets, statement)
        case _:
            return _paths([call])


def _elements(targets: list[ast.expr], statement: ast.stmt) -> frozenset[PathSteps] | None:
    """Return the paths into a result that is unpacked into names."""
    if any(isinstance(target, ast.Starred) for target in targets):
        return None
    found: set[PathSteps] = set()
    for index, target in enumerate(targets):
        paths = _paths(_reads(target.id, statement)) if isinstance(target, ast.Name) else None
        found |= {(Step(item=index), *path) for path in ({()} if paths is None else paths)}
    return frozenset(found) or None  # if no element is read, one that cannot be unpacked would still fail


def _reads(name: str, statement: ast.stmt) -> list[ast.expr]:
    """Return where the function around a statement uses a name; where that is not known, a name of no place.

    Outside functions, others may read the name as well.
    """
    function = _function(statement)
    uses = _uses(function) if function is not None else None
    return [ast.Name(name, ast.Load())] if uses is None else uses.get(name, [])


def _uses(function: ast.AST) -> dict[str, list[ast.expr]] | None:
    """Return where a function uses names, by the names; None if it may use any of them unseen."""
    if not hasattr(function, "uses"):
        uses: dict[str, list[ast.expr]] = {}
        for node in ast.walk(function):
            match node:
                case ast.Global(names=names) | ast.Nonlocal(names=names):
                    for name in names:  # others use it
                        uses.setdefault(name, []).append(ast.Name(name, ast.Load()))
                case ast.Name(id=name, ctx=ast.Load()) | ast.AugAssign(target=ast.Name(id=name)):
                    uses.setdefault(name, []).append(node.target if isinstance(node, ast.AugAssign) else node)
        function.uses = None if _READ_ALL & uses.keys() else uses  # type: ignore[attr-defined]
    found: dict[str, list[ast.expr]] | None = function.uses  # type: ignore[attr-defined]
    return found


def _function(node: ast.AST) -> ast.AST | None:
    """Return the function whose local names a statement assigns; None in a module or class."""
    around = _parent(node)
    while around is not None and not isinstance(around, FunctionNode | ast.ClassDef):
        around = _parent(around)
    return around if isinstance(around, FunctionNode) else None


def _paths(values: list[ast.expr]) -> frozenset[PathSteps] | None:
    """Return the paths that lead on from these expressions; None if one is used as it is."""
    paths = frozenset(map(_path, values))
    return None if () in paths else paths


def _path(value: ast.expr) -> PathSteps:
    """Return the steps that the text around an expression takes into its value; none if it takes it whole."""
    around = _parent(value)
    call = _parent(around)
    if isinstance(call, ast.Call) and call.func is around:
        return ()  # a method sees the whole object
    match around:
        case ast.Attribute(attr=name, ctx=ast.Load()):
            return (Step(attribute=name), *_path(around))
        case ast.Subscript(slice=ast.Constant(value=str() | int() as item), ctx=ast.Load(), value=inner):
            return (Step(item=item), *_path(around)) if inner is value else ()
        case _:
            return ()


def _parent(node: ast.AST | None) -> ast.AST | None:
    return getattr(node, "parent", None)
