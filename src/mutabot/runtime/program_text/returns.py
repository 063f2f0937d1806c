"""Record what the program returns to its tests, by instrumenting the ends of its functions.

``return E`` becomes ``return __mutabot_returned__(E)``, and what a function raises passes a note on its way
out: no function stands around another, so recursion, tracebacks and identities stay what they are. Only
functions of modules and their classes are looked at; generators, and what a compiler of its own translates,
are left alone.

A value counts where it leaves the program: the nearest frame of the project around the function is not one of
the program's files, but a test, a fixture or one of their helpers.
"""

from __future__ import annotations

import ast
import builtins
import os
import sys
from collections.abc import Callable, Iterator
from functools import cache
from sys import _getframe
from types import FrameType
from typing import TYPE_CHECKING, Any

from mutabot.languages.python import placed
from mutabot.model import Role
from mutabot.model.source_units import FunctionNode
from mutabot.runtime.observation.probes import json_data, text_of_error
from mutabot.runtime.program_text import loading

if TYPE_CHECKING:
    from mutabot.runtime.interception.trace import Locator

RETURNED, RAISED = "__mutabot_returned__", "__mutabot_raised__"
#: values per test that are noted
LIMIT = 1000
#: words in decorators of functions that are not run as Python
_TRANSLATED = ("jit", "vectorize", "kernel", "cfunc", "stencil")
_LIBRARIES = (f"{os.sep}site-packages{os.sep}", f"{os.sep}dist-packages{os.sep}")


class Returns:
    """The returned values that one process records.

    Attributes:
        entries: of the running test: name of the function and what it returned (``[value]``) or raised
            (``{"raised": text}``).
        prepared: how many of them are from before the test itself began: from its fixtures.
        is_on: whether what comes is noted: during a test, until there is too much.
        is_last: what rewrites functions sees none of the notes.
    """

    is_last = True

    def __init__(self, locator: Locator) -> None:
        self.entries: list[tuple[str, Any]] = []
        self.prepared = 0
        self.is_on = False
        self._locator = locator
        self._own: set[str] = set()
        self._is_test = cache(self._is_of_tests)

    def install(self) -> None:
        """Instrument program files from now on."""
        setattr(builtins, RETURNED, self._returned)
        setattr(builtins, RAISED, self._raised)
        loading.add(self)
        loading.hook_pytest(self.wants, self.change)

    def wants(self, path: str) -> bool:
        """Return whether a file belongs to the program, whose functions are instrumented."""
        if path.startswith(sys.base_prefix) or any(part in path for part in _LIBRARIES):
            return False
        return self._locator.role(path) is Role.PROGRAM

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Instrument the functions of a program file."""
        for function in _functions(tree):
            own = list(_own_nodes(function))
            is_generator = any(isinstance(node, ast.Yield | ast.YieldFrom) for node in own)
            if not is_generator and not is_translated(function):
                _add_notes(function, own)
        self._own.add(path)

    def give_up(self, path: str, error: Exception) -> None:
        """Ignore a file that is compiled without notes: its import will fail, or it is nested too deeply."""
        self._own.discard(path)

    def start(self) -> None:
        """Begin a test, before its fixtures."""
        self.entries, self.prepared, self.is_on = [], 0, True

    def begin_call(self) -> None:
        """Note that the test's fixtures are set up."""
        self.prepared = len(self.entries)

    def stop(self) -> None:
        """Stop recording, as the test is over."""
        self.is_on = False

    def _returned(self, value: Any) -> Any:
        if self.is_on:
            function = _getframe(1)
            around = function.f_back
            if around is not None and around.f_code.co_filename not in self._own and self._leaves(around):
                self._note(function, lambda: [json_data(value)])
        return value

    def _raised(self) -> None:
        if self.is_on:
            function, error = _getframe(1), sys.exc_info()[1]
            around = function.f_back
            if isinstance(error, Exception) and around is not None and self._leaves(around):
                self._note(function, lambda: {"raised": text_of_error(error)})

    def _note(self, function: FrameType, value: Callable[[], Any]) -> None:
        if len(self.entries) >= LIMIT:
            self.is_on = False
            return
        try:
            self.entries.append((function.f_code.co_qualname, value()))
        except Exception as error:  # objects of the user's may fail to show what is in them
            self.entries.append((function.f_code.co_qualname, [{"opaque": type(error).__name__}]))

    def _leaves(self, frame: FrameType | None) -> bool:
        """Return whether the nearest frame of the project belongs to the tests."""
        while frame is not None:
            name = frame.f_code.co_filename
            if name in self._own:
                return False
            if self._is_test(name):
                return True
            frame = frame.f_back
        return False

    def _is_of_tests(self, name: str) -> bool:
        if name.startswith("<") or any(part in name for part in _LIBRARIES):
            return False
        return not self._locator.relative(name).startswith("..") and not self.wants(name)


def _functions(tree: ast.Module) -> Iterator[FunctionNode]:
    """Yield functions of a module and methods of its classes, except those within functions."""
    stack: list[ast.AST] = [tree]
    while stack:
        for node in ast.iter_child_nodes(stack.pop()):
            if isinstance(node, FunctionNode):
                yield node
            elif isinstance(node, ast.stmt | ast.ExceptHandler | ast.match_case):
                stack.append(node)


def _own_nodes(function: FunctionNode) -> Iterator[ast.AST]:
    """Yield the nodes of a function, except those of functions within it."""
    stack: list[ast.AST] = [*function.body]
    while stack:
        node = stack.pop()
        yield node
        if not isinstance(node, FunctionNode | ast.Lambda | ast.ClassDef):
            stack.extend(ast.iter_child_nodes(node))


def is_translated(function: FunctionNode) -> bool:
    """Return whether a decorator may translate a function's bytecode, which must then stay as it is."""
    names = [ast.unparse(decorator).lower() for decorator in function.decorator_list]
    return any(word in name for name in names for word in _TRANSLATED)


def _add_notes(function: FunctionNode, own: list[ast.AST]) -> None:
    for node in own:
        if isinstance(node, ast.Return) and node.value is not None:
            note = ast.Call(ast.Name(RETURNED, ast.Load()), [node.value], [])
            node.value = placed(note, node)
    has_text = ast.get_docstring(function, clean=False) is not None
    head, body = function.body[:has_text], function.body[has_text:]
    if body:
        report = ast.Expr(ast.Call(ast.Name(RAISED, ast.Load()), [], []))
        handler = ast.ExceptHandler(None, None, [report, ast.Raise()])
        function.body = [*head, placed(ast.Try(body, [handler], [], []), body[0])]
