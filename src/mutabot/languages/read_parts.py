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
    reader = _ReadParts(tree)
    calls = (node for node in ast.walk(tree) if isinstance(node, ast.Call))
    found = ((extent_of(call), reader.parts_of(call)) for call in calls)
    return {extent: parts for extent, parts in found if parts is not None}


class _ReadParts:
    """Finds what a file does with the values of its expressions."""

    def __init__(self, tree: ast.Module) -> None:
        self._parents = {child: node for node in ast.walk(tree) for child in ast.iter_child_nodes(node)}
        #: by function and name, where the function uses the name; None for one that may use any unseen
        self._uses: dict[ast.AST, dict[str, list[ast.expr]] | None] = {}

    def parts_of(self, call: ast.expr) -> frozenset[PathSteps] | None:
        """Return the paths into the value of a call; None if they are not known."""
        match self._parents[call]:
            case ast.Await() as awaited:
                return self.parts_of(awaited)
            case ast.Expr():
                return frozenset()
            case ast.Assign(targets=[ast.Name(id=name)]) as statement:
                return self._paths_of(name, statement)
            case ast.AnnAssign(target=ast.Name(id=name), value=value) as statement if value is call:
                return self._paths_of(name, statement)
            case ast.Assign(targets=[ast.Tuple(elts=targets) | ast.List(elts=targets)]) as statement:
                return self._elements(targets, statement)
            case _:
                path = self._path(call)
                return frozenset({path}) if path else None

    def _elements(self, targets: list[ast.expr], statement: ast.stmt) -> frozenset[PathSteps] | None:
        """Return the paths into a result that is unpacked into names."""
        if any(isinstance(target, ast.Starred) for target in targets):
            return None
        found: set[PathSteps] = set()
        for index, target in enumerate(targets):
            paths = self._paths_of(target.id, statement) if isinstance(target, ast.Name) else None
            found |= {(Step(item=index), *path) for path in ({()} if paths is None else paths)}
        return frozenset(found) or None  # if no element is read, one that cannot be unpacked would still fail

    def _paths_of(self, name: str, statement: ast.stmt) -> frozenset[PathSteps] | None:
        """Return the paths into the value that a statement gives a name; None if they are not known.

        Outside functions, others may read the name as well.
        """
        function = self._function(statement)
        if function is None:
            return None
        if function not in self._uses:
            self._uses[function] = _uses(function)
        uses = self._uses[function]
        paths = None if uses is None else frozenset(map(self._path, uses.get(name, [])))
        return None if paths is None or () in paths else paths

    def _function(self, node: ast.AST) -> ast.AST | None:
        """Return the function whose local names a statement assigns; None in a module or class."""
        around = self._parents.get(node)
        while around is not None and not isinstance(around, FunctionNode | ast.ClassDef):
            around = self._parents.get(around)
        return around if isinstance(around, FunctionNode) else None

    def _path(self, value: ast.expr) -> PathSteps:
        """Return the steps that the text around takes into a value; none if the value is used whole."""
        around = self._parents.get(value)
        call = self._parents.get(around) if around is not None else None
        if isinstance(call, ast.Call) and call.func is around:
            return ()  # a method sees the whole object
        match around:
            case ast.Attribute(attr=name, ctx=ast.Load()):
                return (Step(attribute=name), *self._path(around))
            case ast.Subscript(slice=ast.Constant(value=str() | int() as item), ctx=ast.Load(), value=inner):
                return (Step(item=item), *self._path(around)) if inner is value else ()
            case _:
                return ()


def _uses(function: ast.AST) -> dict[str, list[ast.expr]] | None:
    """Return where a function uses names, by the names; None if it may use any of them unseen."""
    uses: dict[str, list[ast.expr]] = {}
    for node in ast.walk(function):
        match node:
            case ast.Global(names=names) | ast.Nonlocal(names=names):
                for name in names:  # others use it: an expression that stands nowhere
                    uses.setdefault(name, []).append(ast.Name(name, ast.Load()))
            case ast.AugAssign(target=ast.Name(id=name) as target):
                uses.setdefault(name, []).append(target)
            case ast.Name(id=name, ctx=ast.Load()):
                uses.setdefault(name, []).append(node)
    return None if _READ_ALL & uses.keys() else uses
