"""A project's test files: the places where a check can be added, and private copies of the project.

Three styles: test functions of pytest, methods of ``TestCase``, and tests that another tool makes of
something else, as pytest-bdd does of scenarios. No diff changes the last ones, but checks are tried in them.
Nothing is ever written to the project itself.
"""

from __future__ import annotations

import ast
import difflib
import os
import shutil
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch

from mutabot.api.processes import Request
from mutabot.api.reports import UsageError

TestFunctionNode = ast.FunctionDef | ast.AsyncFunctionDef
Definition = ast.ClassDef | TestFunctionNode
_NO_END = "\\ No newline at end of file\n"


@dataclass(slots=True)
class SuiteFiles:
    """The test files of a project.

    Attributes:
        request: of the campaign: root, program, oracle and vocabulary.
        tests: files of the tests that are looked at.
    """

    request: Request
    tests: tuple[str, ...] = ()
    _modules: dict[str, ast.Module | None] = field(default_factory=dict)

    @property
    def root(self) -> Path:
        """The project's folder."""
        return self.request.root

    def text(self, file: str) -> str:
        """Return the text of a file, with its own line endings."""
        return (self.root / file).read_bytes().decode("utf-8")

    def module(self, file: str) -> ast.Module | None:
        """Return the parsed file; None if it cannot be read."""
        if file not in self._modules:
            try:
                self._modules[file] = ast.parse(self.text(file))
            except (OSError, SyntaxError, ValueError):
                self._modules[file] = None
        return self._modules[file]

    def import_name(self, file: str) -> str:
        """Return the name under which pytest and the tests import a file, with its packages."""
        path = self.root / file
        parts = [path.stem]
        folder = path.parent
        while (folder / "__init__.py").exists() and folder != self.root:
            parts.insert(0, folder.name)
            folder = folder.parent
        return ".".join(parts)

    def python_files(self, folders: tuple[str, ...]) -> list[str]:
        """Return the Python files in a list of files and folders, relative to the root."""
        found: list[str] = []
        for name in folders:
            path = self.root / name
            files = sorted(path.rglob("*.py")) if path.is_dir() else [path]
            files = [file for file in files if file.suffix == ".py" and file.exists()]
            found += [str(file.relative_to(self.root)) for file in files]
        return found

    @property
    def program_files(self) -> list[str]:
        """The program's files."""
        return self.python_files(self.request.configuration.program)

    @property
    def suite_files(self) -> list[str]:
        """The files of the tests considered, and the files beside them that are not the program's."""
        program = {*self.program_files}
        found = dict.fromkeys(self.tests)
        for folder in dict.fromkeys((self.root / file).parent for file in self.tests):
            paths = folder.glob("*.py") if folder == self.root else folder.rglob("*.py")
            found |= dict.fromkeys(str(path.relative_to(self.root)) for path in sorted(paths))
        found |= dict.fromkeys(self.python_files(self.request.configuration.oracle))
        return [file for file in found if file not in program and not _LEFT & {*Path(file).parts}]

    @property
    def own_modules(self) -> set[str]:
        """The names under which the project's files are imported."""
        files = [*self.suite_files, *self.program_files]
        return {self.import_name(file).partition(".")[0] for file in files}

    def beside(self, file: str) -> Iterator[ast.Module]:
        """Yield a test file and the ``conftest.py`` files that apply to it, nearest first."""
        folders = [folder for folder in (self.root / file).parents if folder.is_relative_to(self.root)]
        conftests = [str((folder / "conftest.py").relative_to(self.root)) for folder in folders]
        return (module for path in (file, *conftests) if (module := self.module(path)) is not None)

    def classes_of(self, file: str) -> dict[str, str]:
        """Return the annotated classes of the arguments of steps and fixtures, by argument name."""
        return {
            parameter.arg: ast.unparse(parameter.annotation)
            for module in self.beside(file)
            for node in module.body
            if isinstance(node, TestFunctionNode)
            for parameter in (*node.args.args, *node.args.kwonlyargs)
            if isinstance(parameter.annotation, ast.Name)
        }

    def diff(self, texts: Mapping[str, str]) -> str:
        """Return a unified diff of all changed files, for ``git apply`` and ``patch -p1``."""
        parts: list[str] = []
        for file, text in sorted(texts.items()):
            before, after = self.text(file).splitlines(keepends=True), text.splitlines(keepends=True)
            parts += difflib.unified_diff(before, after, f"a/{file}", f"b/{file}")
        return "".join(part if part.endswith("\n") else f"{part}\n{_NO_END}" for part in parts)


def name_in(
    module: ast.Module, wanted: str, attribute: str, taken: Iterable[str] = ()
) -> tuple[str, tuple[str, ...]]:
    """Return how a file can refer to ``attribute`` of module ``wanted``, and the missing import if any.

    ``taken`` are names of other things.
    """
    bound: set[str] = set(taken)
    for node in module.body:
        if isinstance(node, ast.ImportFrom) and node.module == wanted and not node.level:
            for alias in node.names:
                if alias.name == attribute and (alias.asname or alias.name) not in bound:
                    return alias.asname or alias.name, ()
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name == wanted and (alias.asname or alias.name.partition(".")[0]) not in bound:
                    return f"{alias.asname or alias.name}.{attribute}", ()
    bound |= top_names(module)
    if attribute not in bound:
        return attribute, (f"from {wanted} import {attribute}",)
    return f"{wanted}.{attribute}", (f"import {wanted}",)


def top_names(module: ast.Module) -> set[str]:
    """Return the names that a file binds at its top level."""
    found: set[str] = set()
    for node in module.body:
        if isinstance(node, ast.Import | ast.ImportFrom):
            found |= {alias.asname or alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, Definition):
            found.add(node.name)
        else:
            found |= {inner.id for inner in ast.walk(node) if isinstance(inner, ast.Name)}
    return found


PYTEST, UNITTEST, OTHER = "pytest", "unittest", "other"


@dataclass(frozen=True, slots=True)
class PlaceInTest:
    """A test at whose end a check can be added; all of its parameters are one place.

    Attributes:
        style: name of its style.
        file: its module, relative to the project.
        node: its node id without parameters.
        names: what it is given: fixtures and parameters.
    """

    style: str
    file: str
    node: str
    names: tuple[str, ...] = ()

    @property
    def path(self) -> tuple[str, ...]:
        """Its name in its module, preceded by its class."""
        return tuple(self.node.split("::")[1:])


def text_of(node: ast.AST) -> str:
    """Return the source text of an expression or statement, with quotes as formatters write them."""
    text = ast.unparse(node)
    return text if '"' in text or "\\" in text else text.replace("'", '"')


def in_one_line(statements: str) -> str:
    """Return statements as a line that is still Python."""
    return "; ".join(text_of(node) for node in ast.parse(statements).body)


def awaits(node: ast.AST) -> bool:
    """Return whether an expression awaits something, so that no plain function can evaluate it."""
    return any(isinstance(inner, ast.Await) for inner in ast.walk(node))


def place_of(project: SuiteFiles, test: str) -> PlaceInTest | None:
    """Return the place of a test by its node id; None if nothing can be added to it."""
    node = test.partition("[")[0]
    file, *path = node.split("::")
    module = project.module(file)
    if module is None or len(path) not in (1, 2):
        return None
    function = function_of(module, PlaceInTest(OTHER, file, node))
    if len(path) == 1 and (function is None or _is_scenario(function)):
        return PlaceInTest(OTHER, file, node, _available_fixtures(project, file))
    if function is None or not _can_append(function):
        return None
    is_case = len(path) == 2 and _is_test_case(module, path[0])
    return PlaceInTest(UNITTEST if is_case else PYTEST, file, node, _names(function))


def function_of(module: ast.Module | None, place: PlaceInTest) -> TestFunctionNode | None:
    """Return the function of a place in its parsed file; None if it has none."""
    found: ast.Module | Definition | None = module
    for name in place.path:
        found = _defined(found, name) if found is not None else None
    return found if isinstance(found, TestFunctionNode) else None


def _is_scenario(function: TestFunctionNode) -> bool:
    """Return whether a function only stands for a scenario of pytest-bdd."""
    called = (ast.unparse(decorator).partition("(")[0] for decorator in function.decorator_list)
    return any(name.rpartition(".")[2] == "scenario" for name in called)


def _available_fixtures(project: SuiteFiles, file: str) -> tuple[str, ...]:
    """Return the arguments of a test file's fixtures and steps: fixtures that a test may have requested."""
    functions = [
        node
        for module in project.beside(file)
        for node in module.body
        if isinstance(node, TestFunctionNode) and node.decorator_list
    ]
    return tuple(dict.fromkeys(name for function in functions for name in arguments_of(function)))


def _can_append(function: TestFunctionNode) -> bool:
    """Return whether statements can follow: not after a one-line body, nor after a final ``raise``."""
    return function.body[0].lineno != function.lineno and not isinstance(function.body[-1], ast.Raise)


def _names(function: TestFunctionNode) -> tuple[str, ...]:
    """Return the arguments of a function, and the names that it assigns."""
    assigned = [
        node.id
        for statement in function.body
        for node in ast.walk(statement)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    ]
    return tuple(dict.fromkeys((*arguments_of(function), *assigned)))


def bound_names(function: TestFunctionNode) -> tuple[str, ...]:
    """Return a function's arguments, and the names that statements directly in its body assign."""
    targets = [
        target
        for statement in function.body
        if isinstance(statement, ast.Assign | ast.AnnAssign)
        for target in (statement.targets if isinstance(statement, ast.Assign) else [statement.target])
    ]
    names = [target.id for target in targets if isinstance(target, ast.Name)]
    return tuple(dict.fromkeys((*arguments_of(function), *names)))


def _is_test_case(module: ast.Module, name: str, depth: int = 5) -> bool:
    owner = _defined(module, name)
    bases = [ast.unparse(base) for base in owner.bases] if isinstance(owner, ast.ClassDef) else []
    return any(
        base.endswith("TestCase") or (depth > 0 and _is_test_case(module, base, depth - 1)) for base in bases
    )


def _defined(owner: ast.Module | Definition, name: str) -> Definition | None:
    """Return the class or function with this name in a module or class; None if there is none."""
    return next(
        (
            statement
            for statement in reversed(owner.body)
            if isinstance(statement, Definition) and statement.name == name
        ),
        None,
    )


def arguments_of(function: TestFunctionNode) -> tuple[str, ...]:
    """Return the names of a function's arguments."""
    given = function.args
    return tuple(parameter.arg for parameter in (*given.posonlyargs, *given.args, *given.kwonlyargs))


#: folders that no test needs and that may be large
_LEFT = {".git", ".hg", "__pycache__", ".pytest_cache", ".mypy_cache", ".ruff_cache", ".tox", ".nox"}
_LEFT |= {"node_modules"}
_PATH = "PYTHONPATH"


@contextmanager
def copy_of(request: Request, texts: Mapping[str, str]) -> Iterator[Request]:
    """Yield the request for a private copy of the project in which files have these texts.

    Raises UsageError if there is no place for it.
    """
    with TemporaryDirectory(prefix="mutabot-suggest-", ignore_cleanup_errors=True) as home:
        root = Path(home) / request.root.name
        try:
            left = {*_LEFT, request.journal_path.parent.name}
            shutil.copytree(request.root, root, symlinks=True, ignore=partial(_ignored, left))
            for file, text in texts.items():
                (root / file).write_bytes(text.encode("utf-8"))
        except (OSError, shutil.Error) as error:
            problem = f"the project cannot be copied to {home} (set TMPDIR to another place): {error}"
            raise UsageError(problem) from error
        paths = _paths(request.root, root, os.environ.get(_PATH, ""))
        with patch.dict(os.environ, {_PATH: os.pathsep.join(paths)}):
            yield request.changed(root=root)


def _ignored(left: Collection[str], folder: str, names: Sequence[str]) -> set[str]:
    return {name for name in names if name in left or Path(folder, name, "pyvenv.cfg").exists()}


def _paths(own: Path, copy: Path, before: str) -> list[str]:
    """Return the copy's import paths, before those of an installation that points to the project."""
    found = [str(copy / "src")] if (copy / "src").is_dir() else []
    given = [entry for entry in before.split(os.pathsep) if entry]
    for entry in [*given, *sys.path[1:]]:  # the first is where this process was started
        path = Path(entry).resolve()
        copied = copy / path.relative_to(own) if path.is_relative_to(own) else None
        if copied is not None and copied.is_dir():
            found.append(str(copied))
        elif copied is None and entry in given:
            found.append(entry)
    return list(dict.fromkeys(found))
