"""Records which units of the project's Python files are executed, and which files are read as text.

Files are compiled with one more statement at the beginning of each function, which sets a byte. That takes a
tenth of the time that a trace function takes (14 ns a call instead of 165), and works alike in all versions
of Python. What is executed in the call phase of a test belongs to that test, everything else to all tests
after it. So does the call phase of a test that may leave something behind. See ``model.units``.
"""

from __future__ import annotations

import ast
import builtins
import os
import sys
from collections.abc import Collection, Iterable, Iterator
from types import CodeType, FrameType
from typing import Any

from mutabot.model.source_units import (
    ALL_FILES,
    MODULE,
    WHOLE,
    Executed,
    functions_of,
    is_test_file,
    last_name,
)
from mutabot.runtime.program_text import loading

#: the built-in name of the bytes, one for each function
RAN = "__mutabot_ran__"
_STARTS = {"subprocess.Popen", "os.posix_spawn", "os.system", "os.fork", "os.forkpty", "os.exec"}
_FOREIGN = {"uname", "git", "ldconfig", "lsb_release", "nvidia-smi"}
#: decorators of functions whose results are kept
_KEPT = {"cache", "lru_cache", "cached_property"}
#: what makes objects that nobody can change, or that tests do not depend on
_FIXED = {
    "Path", "PurePath", "frozenset", "tuple", "float", "int", "str", "bool", "bytes", "round", "abs", "min",
    "max", "sum", "len", "sorted", "Decimal", "Fraction", "timedelta", "TypeVar", "ParamSpec", "radians",
    "degrees", "sqrt", "getLogger", "compile", "namedtuple", "MappingProxyType", "NewType", "field", "param",
    "mark", "joinpath", "resolve", "absolute", "with_name", "auto",
}  # fmt: skip
_PLACES = tuple[str, int]


class ExecutedUnits:
    """The record of this process and of its forks. See ``loading.Step``.

    Args:
        root: absolute path of the project.

    Attributes:
        is_optional: loaders that compile in a way of their own may do so.
    """

    is_optional = True

    def __init__(self, root: str) -> None:
        self._root = os.path.join(os.path.realpath(root), "")
        self._ran = bytearray()
        self._places: list[_PLACES] = []
        self._keeping: set[int] = set()
        self._tests: set[_PLACES] = set()
        self._common: set[_PLACES] = set()
        self._test: set[_PLACES] = set()
        self._held: dict[str, set[_PLACES]] = {}
        self._shared: Collection[str] = ()
        self._loaded: set[str] = set()
        self._in_call = self._leaves = self._has_objects = False

    @property
    def has_started(self) -> bool:
        """Whether a process was started outside of the call phases of tests, but for those of libraries."""
        return (ALL_FILES, WHOLE) in self._common

    def install(self) -> None:
        """Record from now on."""
        setattr(builtins, RAN, self._ran)
        loading.add(self)
        rewriting: Any = sys.modules.get("_pytest.assertion.rewrite")
        if rewriting is not None:
            rewrite, read = rewriting.rewrite_asserts, rewriting._read_pyc

            def rewrite_asserts(tree: ast.Module, source: bytes, path: str | None = None, *rest: Any) -> None:
                original = ast.parse(source)
                rewrite(tree, source, path, *rest)
                if path is not None and self.wants(path):
                    self._instrument(tree, original, path)

            def read_pyc(source: Any, *rest: Any, **named: Any) -> Any:
                return None if self.wants(str(source)) else read(source, *rest, **named)

            rewriting.rewrite_asserts, rewriting._read_pyc = rewrite_asserts, read_pyc
        sys.addaudithook(self._hear)

    def wants(self, path: str) -> bool:
        """Whether a file is the project's own."""
        return path.endswith(".py") and self._name(path) is not None

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Mark the functions of a file."""
        self._instrument(tree, ast.parse(source), path)

    def give_up(self, path: str, error: Exception) -> None:
        """It is compiled without marks: all of it counts."""

    def start_test(self) -> None:
        """A test begins, before its fixtures."""
        self._test.clear()

    def begin_call(self, shared: Collection[str]) -> None:
        """The fixtures of the test are set up; ``shared``: those that outlive it."""
        self._common |= self._take()
        self._in_call, self._leaves, self._shared = True, False, shared
        self._test.update(*(self._held.get(one, ()) for one in shared))

    def end_call(self) -> None:
        """The fixtures of the test are next to be taken down."""
        if not self._in_call:
            return
        leaves = self._leaves or self._has_objects or any(self._ran[number] for number in self._keeping)
        found = self._take()
        self._test |= found
        if leaves:
            self._common |= found - self._tests
        for one in self._shared:
            self._held.setdefault(one, set()).update(found - self._tests)
        self._in_call = False

    def of_test(self, *, alone: bool = False) -> Executed:
        """All that the running test depends on, as far as it has come; ``alone``: in its call phase."""
        self.end_call()
        self._common |= self._take()
        found: dict[str, set[int]] = {}
        for file, line in self._test if alone else self._common | self._test:
            found.setdefault(file, set()).add(line)
        return {file: tuple(sorted(lines)) for file, lines in found.items()}

    def is_of_project(self, code: Any) -> bool:
        """Whether this is code of the project's own files."""
        return isinstance(code, CodeType) and self._name(code.co_filename) is not None

    def _take(self) -> set[_PLACES]:
        """The functions that were executed since this was last asked."""
        found, number = set(), self._ran.find(1)
        while number >= 0:
            found.add(self._places[number])
            number = self._ran.find(1, number + 1)
        self._ran[:] = bytes(len(self._ran))
        return found

    def _name(self, path: str) -> str | None:
        """The path of a file of the project, relative to it; None for others."""
        real = os.path.realpath(path) if not path.startswith("<") else path
        if not real.startswith(self._root) or "/site-packages/" in real or "/.mutabot/" in real:
            return None
        return real[len(self._root) :]

    def _instrument(self, tree: ast.Module, original: ast.Module, path: str) -> None:
        name = self._name(path)
        assert name is not None
        self._loaded.add(name)
        self._common.add((name, MODULE))
        self._leaves = True  # it stays loaded
        if _imports(original, "numba"):  # it compiles functions in a way of its own
            self._common.add((name, WHOLE))
            return
        makers = list(_objects_of(original))
        self._has_objects |= bool(makers)
        containers = set(_containers_of(original))
        keeping = {node.lineno for _, node in functions_of(original) if _keeps(node, containers)}
        for _, node in functions_of(tree):
            number = len(self._places)
            self._places.append((name, node.lineno))
            if is_test_file(name) and node.name.startswith("test"):
                self._tests.add((name, node.lineno))
            self._ran.append(0)
            if node.lineno in keeping:
                self._keeping.add(number)
            _mark(node, number)  # what is defined in it may be sent to processes that know no marks

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        """Something happens that may matter beside what is executed; see ``sys.addaudithook``."""
        if event == "open":
            path, _, flags = arguments
            if self._in_call and isinstance(path, str | bytes) and not flags & (os.O_WRONLY | os.O_TRUNC):
                name = self._name(os.fsdecode(path))
                if name is not None and not _is_by_us():
                    self._test.add((name, WHOLE))
        elif event == "exec" and isinstance(arguments[0], CodeType):
            name = self._name(arguments[0].co_filename)
            if name is not None and name not in self._loaded:
                self._common.add((name, WHOLE))
        elif event in _STARTS and not (
            _is_by_us() or _is_foreign(event, arguments) or self._is_import_of_library()
        ):
            self._common.add((ALL_FILES, WHOLE))

    def _is_import_of_library(self) -> bool:
        """Whether an installed package does it while it is imported, as ``glfw`` does to know a version."""
        frame: FrameType | None = sys._getframe(2)
        while frame is not None:
            file = frame.f_code.co_filename
            if "site-packages" in file and frame.f_code.co_name == "<module>":
                return True
            if self._name(file) is not None:
                return False
            frame = frame.f_back
        return False


def _is_by_us() -> bool:
    """Whether it is Mutabot that does what is heard of, be it by modules that read program text."""
    frame: FrameType | None = sys._getframe(2)
    while frame is not None and frame.f_globals.get("__name__") in ("linecache", "tokenize", "codecs"):
        frame = frame.f_back
    return frame is not None and str(frame.f_globals.get("__name__", "")).startswith("mutabot.")


def _is_foreign(event: str, arguments: tuple[Any, ...]) -> bool:
    """Whether a program is started that runs no code of the project, as libraries do to know their system."""
    if event != "subprocess.Popen" or not arguments[1]:
        return False
    executable = arguments[0] or (arguments[1] if isinstance(arguments[1], str | bytes) else arguments[1][0])
    return os.path.basename(os.fsdecode(executable)) in _FOREIGN


def _mark(function: ast.FunctionDef | ast.AsyncFunctionDef, number: int) -> None:
    """Let a function tell that it is executed."""
    statement = ast.parse(f"{RAN}[{number}] = 1").body[0]
    for node in ast.walk(statement):
        if isinstance(node, ast.expr | ast.stmt):  # where no other node can stand
            node.lineno = node.end_lineno = function.lineno
            node.col_offset = node.end_col_offset = 0
    first = function.body[0]
    is_text = isinstance(first, ast.Expr) and isinstance(getattr(first.value, "value", None), str)
    function.body.insert(1 if is_text else 0, statement)


def _imports(tree: ast.Module, package: str) -> bool:
    names: Iterable[str] = (
        name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
        for name in (getattr(node, "module", None) or "", *(one.name for one in node.names))
    )
    return any(name.partition(".")[0] == package for name in names)


def _at_import(node: ast.AST) -> Iterator[ast.stmt]:
    """The statements that are executed when a module is imported, those of its classes included."""
    for one in ast.iter_child_nodes(node):
        if isinstance(one, ast.stmt) and not isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef):
            yield one
            yield from _at_import(one)


def _objects_of(tree: ast.Module) -> Iterator[ast.Call]:
    """Calls that make objects which live as long as the module, and may change in every test."""
    for statement in _at_import(tree):
        if isinstance(statement, ast.Assign | ast.AnnAssign) and statement.value is not None:
            for node in ast.walk(statement.value):
                if isinstance(node, ast.Call) and last_name(node) not in _FIXED:
                    yield node


def _containers_of(tree: ast.Module) -> Iterator[str]:
    """Names of lists, dictionaries and sets that live as long as the module."""
    for statement in _at_import(tree):
        value = getattr(statement, "value", None)
        if isinstance(value, ast.List | ast.Dict | ast.Set | ast.ListComp | ast.DictComp | ast.SetComp):
            targets = getattr(statement, "targets", [getattr(statement, "target", None)])
            yield from (one.id for one in targets if isinstance(one, ast.Name))


def _keeps(function: ast.FunctionDef | ast.AsyncFunctionDef, containers: set[str]) -> bool:
    """Whether a function may write to what outlives a test: to globals, to classes, to what it has cached."""
    if any(last_name(one) in _KEPT for one in function.decorator_list):
        return True
    own = {one.arg for one in ast.walk(function) if isinstance(one, ast.arg)} - {"cls"}
    own |= {one.id for one in ast.walk(function) if isinstance(one, ast.Name) and _is_stored(one)}
    for node in ast.walk(function):
        if isinstance(node, ast.Global):
            return True
        if isinstance(node, ast.Attribute | ast.Subscript):
            is_shared = last_name(node.value) in containers
            if is_shared or (_is_stored(node) and _root(node) not in own):
                return True
        if isinstance(node, ast.Call) and last_name(node) in ("setattr", "delattr", "__setattr__"):
            return True
    return False


def _is_stored(node: ast.Name | ast.Attribute | ast.Subscript) -> bool:
    return isinstance(node.ctx, ast.Store | ast.Del)


def _root(node: ast.AST) -> str:
    """The name that an attribute or item is reached from; empty if that is no name."""
    while isinstance(node, ast.Attribute | ast.Subscript):
        node = node.value
    return node.id if isinstance(node, ast.Name) else ""
