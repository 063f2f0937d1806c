"""Units of a program file: each function, and the module level, which is the rest.

The runtime records which units are executed, by the lines of their ``def``; the controller compares what the
units say. A unit says its syntax tree, without positions, comments and layout. Languages other than Python
define their units themselves.
"""

from __future__ import annotations

import ast
import os
import warnings
from _blake2 import blake2b  # hashlib has the same, and loads OpenSSL in every process
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import copy
from functools import cached_property
from typing import NamedTuple

#: in the place of a line: the module level, the text of the whole file, or that it was read as text
MODULE, WHOLE, AS_TEXT = -1, 0, -2
#: in the place of a file: all Python files of the project may have been executed
ALL_FILES = "*"
#: units that were executed: by file, the lines of their ``def``, ``MODULE``, ``WHOLE`` or ``AS_TEXT``
Executed = Mapping[str, tuple[int, ...]]

#: decorators that leave it to others when a function is called, and do not look into it
_PLAIN = {
    "staticmethod", "classmethod", "property", "setter", "getter", "deleter", "cached_property", "cache",
    "lru_cache", "contextmanager", "asynccontextmanager", "abstractmethod", "override", "overload", "final",
    "fixture",
}  # fmt: skip
#: names by which a function may read program text or its line numbers
_TEXT = {
    "getsource", "getsourcelines", "getsourcefile", "findsource", "f_lineno", "tb_lineno", "co_firstlineno",
    "lineno", "linecache", "tokenize", "getframeinfo", "extract_stack", "format_stack", "print_stack",
}  # fmt: skip


def digest(text: bytes) -> str:
    """Return a digest of a text, short and practically unique."""
    return blake2b(text, digest_size=12).hexdigest()


def together(parts: Iterable[Executed | None]) -> Executed | None:
    """Return the union of executed units; None if those of any part are unknown."""
    found: dict[str, set[int]] = {}
    for part in parts:
        if part is None:
            return None
        for file, lines in part.items():
            found.setdefault(file, set()).update(lines)
    return {file: tuple(sorted(lines)) for file, lines in found.items()}


class ExecutedByTests:
    """The units executed in a run of the suite; each test reports only those that are new.

    What was executed before a test counts for it.

    Args:
        tests: the tests in their order, and what each has reported.
    """

    def __init__(self, tests: Iterable[tuple[str, Executed | None]]) -> None:
        self._numbers: dict[str, int] = {}
        self._by_test: list[Executed | None] = []
        self._read: dict[str, int] = {}  # by file, the first test that reads it as text
        for number, (test, executed) in enumerate(tests):
            self._numbers[test] = number
            self._by_test.append(executed)
            for file, lines in (executed or {}).items():
                if AS_TEXT in lines:
                    self._read.setdefault(file, number)

    def by(self, tests: Iterable[str]) -> Executed | None:
        """Return the units that these tests depend on; None if those of any test are unknown."""
        last = max((self._numbers[test] for test in tests if test in self._numbers), default=-1)
        return together(self._by_test[: last + 1])

    def from_reader_of(self, file: str) -> list[str]:
        """Return the tests from the first on that reads a file as text; none if no test does."""
        first = self._read.get(file)
        return [] if first is None else [*self._numbers][first:]


FunctionNode = ast.FunctionDef | ast.AsyncFunctionDef
#: the first and last line and column of a node, or a line alone
NodeExtent = tuple[int, ...]


def is_test_file(name: str) -> bool:
    """Return whether pytest looks for tests in a file of this name."""
    last = os.path.basename(name)
    return last.endswith(".py") and (last.startswith("test_") or last.endswith("_test.py"))


def is_unit(node: ast.AST) -> bool:
    """Return whether a function is a separate unit; one with an unknown decorator is not."""
    return isinstance(node, FunctionNode) and all(map(_is_plain, node.decorator_list))


def functions_of(tree: ast.AST, prefix: str = "") -> Iterator[tuple[str, FunctionNode]]:
    """Yield the functions of a module and its classes that are units, with their qualified names."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, FunctionNode):
            if is_unit(node):
                yield prefix + node.name, node
        elif isinstance(node, ast.ClassDef):
            yield from functions_of(node, f"{prefix}{node.name}.")
        elif isinstance(node, ast.stmt | ast.ExceptHandler | ast.match_case):
            yield from functions_of(node, prefix)


def last_name(node: ast.AST) -> str:
    """Return the last part of the name of an expression; empty if it has none."""
    if isinstance(node, ast.Call):
        return last_name(node.func)
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def _is_plain(decorator: ast.expr) -> bool:
    return last_name(decorator) in _PLAIN or _is_mark(decorator)


def _is_mark(decorator: ast.expr) -> bool:
    """Return whether a decorator is a mark of pytest's, with arguments computed without a call."""
    calls = [node for node in ast.walk(decorator) if isinstance(node, ast.Call)]
    is_mark = ast.unparse(decorator).startswith(("pytest.mark.", "mark."))
    return is_mark and all(call is decorator or last_name(call) == "param" for call in calls)


#: a unit of a file in another language than Python: its number when it is recorded (``MODULE``, or above 0),
#: what it says without positions, comments and layout, and places in it, in an order that this decides
TextUnit = tuple[int, str, Sequence[NodeExtent]]


class _Units(NamedTuple):
    """The units of a file, with their lines and digests.

    Attributes:
        lines: their lines, by name, as executed units are reported.
        digests: of their content, by name.
        is_quiet: whether nothing happens at the module level but that names are given to what is plain.
    """

    lines: Mapping[str, int]
    digests: Mapping[str, str]
    is_quiet: bool


class File:
    """The content of a program file.

    Args:
        name: its path relative to the project.
        text: what it holds.
        units: gives the units of a text by their names, "" for the module level; None for Python.
    """

    def __init__(
        self, name: str, text: bytes, units: Callable[[bytes], Mapping[str, TextUnit]] | None = None
    ) -> None:
        self.name, self._text, self._units_of = name, text, units

    @cached_property
    def digest(self) -> str:
        """The digest of the text."""
        return digest(self._text)

    @cached_property
    def _units(self) -> _Units | None:
        """The units; None if the file cannot be parsed. Trees, a hundred times larger, are not kept."""
        if self._units_of is not None:
            units = self._units_of(self._text)
            texts = {name: digest(text.encode()) for name, (_, text, _) in units.items()}
            return _Units({name: number for name, (number, *_) in units.items()}, texts, is_quiet=False)
        nodes = self._nodes()
        if nodes is None:
            return None
        module = nodes[""]
        return _Units(
            {name: getattr(node, "lineno", MODULE) for name, node in nodes.items()},
            {name: self._said_by(node) for name, node in nodes.items()},
            isinstance(module, ast.Module) and all(map(_is_quiet, module.body)),
        )

    def _nodes(self) -> dict[str, ast.AST] | None:
        """Return the units' nodes by name, the module level by ""; None if it cannot be parsed."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                tree = ast.parse(self._text)
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            return None
        found: dict[str, ast.AST] = {}
        numbers: Counter[str] = Counter()
        for name, node in functions_of(tree):
            number = numbers[name]
            numbers[name] += 1
            found[f"{name}#{number}" if number else name] = node
        found[""] = _ModuleLevel(is_test_file(self.name)).visit(tree)
        return found

    @property
    def is_python(self) -> bool:
        """Whether it can be parsed."""
        return self._units is not None

    @cached_property
    def digests(self) -> Mapping[str, str]:
        """The digests of the units by name; of a file that cannot be parsed, that of the text."""
        return {"": self.digest} if self._units is None else self._units.digests

    @property
    def is_quiet(self) -> bool:
        """Whether importing the file does nothing but give names to plain values."""
        return self._units is not None and self._units.is_quiet

    def names_at(self, lines: tuple[int, ...]) -> set[str] | None:
        """Return the names of the units at these lines; None if the whole text counts."""
        if self._units is None or WHOLE in lines:
            return None
        by_line = {line: name for name, line in self._units.lines.items()}
        found = {by_line.get(line) for line in lines}
        return None if None in found else {name for name in found if name is not None}

    def lines_of(self, names: Iterable[str] | None) -> tuple[int, ...]:
        """Return the line numbers by which these units are recorded; None is the whole text."""
        if self._units is None or names is None:
            return (WHOLE,)
        return tuple(sorted(map(self._units.lines.__getitem__, names)))

    def shown(self, name: str) -> str:
        """Return a unit's name with its file: ``place() in sorting.py``."""
        return f"{name.partition('#')[0]}() in {self.name}" if name else f"module level of {self.name}"

    def moves_to(self, new: File) -> dict[NodeExtent, NodeExtent | None]:
        """Map lines and nodes of this text to those of a new one; None where that is ambiguous."""
        found: dict[NodeExtent, NodeExtent | None] = {}
        places, others = self._places(), new._places()
        for name, before in places.items():
            if name not in others or self.digests[name] != new.digests.get(name):
                continue
            for was, is_now in zip(before, others[name], strict=True):
                for part in (slice(None), slice(0, 1), slice(2, 3)) if was and is_now else ():
                    if found.setdefault(was[part], is_now[part]) != is_now[part]:
                        found[was[part]] = None
        return found

    def _places(self) -> Mapping[str, Iterable[NodeExtent]]:
        """Return the places in each unit, in the same order for all units that say the same."""
        if self._units_of is not None:
            return {name: extents for name, (_, _, extents) in self._units_of(self._text).items()}
        return {name: map(_extent, ast.walk(node)) for name, node in (self._nodes() or {}).items()}

    def _said_by(self, node: ast.AST) -> str:
        names = {getattr(inner, "attr", getattr(inner, "id", "")) for inner in ast.walk(node)}
        text = self.digest if not _TEXT.isdisjoint(names) else ""
        return digest((ast.dump(node) + text).encode())


def _is_quiet(node: ast.AST) -> bool:
    if isinstance(node, ast.ClassDef):
        return not node.decorator_list and not node.bases and all(map(_is_quiet, node.body))
    if isinstance(node, ast.Assign | ast.AnnAssign | ast.Expr):
        targets = getattr(node, "targets", [getattr(node, "target", None)] if hasattr(node, "target") else [])
        if not all(isinstance(target, ast.Name) and target.id != "pytest_plugins" for target in targets):
            return False
        parts = ast.walk(node.value) if node.value is not None else ()
        return not any(isinstance(part, ast.Call | ast.Await) for part in parts)
    return isinstance(node, ast.Import | ast.ImportFrom | ast.Pass)


def _extent(node: ast.AST) -> NodeExtent:
    line = getattr(node, "lineno", None)
    if line is None:
        return ()
    end, column = getattr(node, "end_lineno", line), getattr(node, "end_col_offset", 0)
    return int(line), int(getattr(node, "col_offset", 0)), int(end), int(column)


class _ModuleLevel(ast.NodeTransformer):
    """Removes from functions everything that does not happen when the module is imported.

    Of tests it leaves nothing: pytest alone looks for them, and which tests there are is compared elsewhere.
    """

    def __init__(self, are_tests: bool) -> None:
        self._are_tests = are_tests

    def visit_FunctionDef(self, node: FunctionNode) -> FunctionNode | None:
        if not is_unit(node):
            return node
        if (
            self._are_tests
            and node.name.startswith("test")
            and not any(last_name(decorator) == "fixture" for decorator in node.decorator_list)
        ):
            return None
        text = ast.get_docstring(node, clean=False) or ""
        node = copy(node)  # it is a unit, too
        node.body = node.body[:1] if ">>>" in text else []  # the examples of a docstring are tests
        return node

    visit_AsyncFunctionDef = visit_FunctionDef  # noqa: N815  # the name that ast looks for

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.ClassDef | None:
        had = len(node.body)
        self.generic_visit(node)
        is_plain = not (node.decorator_list or node.bases or node.keywords)
        # a docstring is an expression
        is_empty = is_plain and all(isinstance(statement, ast.Expr) for statement in node.body)
        return None if len(node.body) < had and is_empty else node
