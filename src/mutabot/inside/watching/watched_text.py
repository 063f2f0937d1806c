"""Program text whose calls can be watched: every call and every attribute that is read asks the watch first.

``arm.move(1)`` becomes ``__mutabot_method__(arm, 'move', 7)(1)``, where 7 is the place; a function's name
likewise. Nothing is written: the text is changed while it is imported.
"""

from __future__ import annotations

import ast
import os
from collections.abc import Callable, Mapping

from mutabot.inside.text import loading, scripts

METHOD, NAME, READ = "__mutabot_method__", "__mutabot_name__", "__mutabot_read__"
#: these look at the frame that calls them
_BOUND_TO_FRAME = frozenset({"super", "locals", "globals", "vars", "dir", "eval", "exec", "breakpoint"})


def watch_imports(files: Mapping[str, str], new_place: Callable[[str, int], int]) -> None:
    """From now on these files (real path to the name for people) are imported with calls that are watched.

    ``new_place`` numbers a file and line.
    """
    loading.add(_Watched(files, new_place))
    scripts.hook_runpy()


class _Watched:
    """Puts the watch into files while they are compiled. See ``loading.Step``."""

    def __init__(self, files: Mapping[str, str], new_place: Callable[[str, int], int]) -> None:
        self._files, self._new_place = files, new_place

    def wants(self, path: str) -> bool:
        """Whether the file is to be watched."""
        return os.path.realpath(path) in self._files

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Let every call and every attribute that is read ask the watch first."""
        name = self._files[os.path.realpath(path)]
        watch(tree, lambda line: self._new_place(name, line))

    def give_up(self, path: str, error: Exception) -> None:
        """What cannot be compiled says so itself."""


def watch(tree: ast.Module, place: Callable[[int], int]) -> None:
    """Put the watch into a tree."""
    ast.fix_missing_locations(_Watcher(place).visit(tree))


class _Watcher(ast.NodeTransformer):
    """Puts the watch into a tree."""

    def __init__(self, place: Callable[[int], int]) -> None:
        self._place = place

    def visit_Call(self, node: ast.Call) -> ast.expr:
        node.args = [self.visit(one) for one in node.args]
        for keyword in node.keywords:
            keyword.value = self.visit(keyword.value)
        match node.func:
            case ast.Attribute(value=inner, attr=name) if not name.startswith("_"):
                node.func = self._asked(METHOD, node.func, self.visit(inner), ast.Constant(name))
            case ast.Name(id=name) if name not in _BOUND_TO_FRAME:
                node.func = self._asked(NAME, node.func, node.func)
            case _:
                node.func = self.visit(node.func)
        return node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        node.value = self.visit(node.value)
        if not isinstance(node.ctx, ast.Load) or node.attr.startswith("_"):
            return node
        return self._asked(READ, node, node.value, ast.Constant(node.attr))

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AnnAssign:
        node.value = self.visit(node.value) if node.value is not None else None
        return node

    def visit_arg(self, node: ast.arg) -> ast.arg:
        return node  # an annotation may be read as text

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        return self._function(node)

    def visit_AsyncFunctionDef(self, node: ast.AsyncFunctionDef) -> ast.AST:
        return self._function(node)

    def visit_match_case(self, node: ast.match_case) -> ast.match_case:
        node.guard = self.visit(node.guard) if node.guard is not None else None
        node.body = [self.visit(one) for one in node.body]
        return node

    def _function(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> ast.AST:
        node.decorator_list = [self.visit(one) for one in node.decorator_list]
        self.visit(node.args)
        node.body = [self.visit(one) for one in node.body]
        return node

    def _asked(self, function: str, at: ast.expr, *arguments: ast.expr) -> ast.Call:
        place = ast.Constant(self._place(at.end_lineno or at.lineno))
        asked = ast.Call(ast.Name(function, ast.Load()), [*arguments, place], [])
        return ast.copy_location(asked, at)
