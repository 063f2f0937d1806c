"""A project's test files as they are read, and changes of their text, made in private copies of the project.

Nothing is ever written to the project itself.
"""

from __future__ import annotations

import ast
import difflib
import os
import shutil
import sys
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

from mutabot.campaign.request import Request
from mutabot.errors import ConfigurationError
from mutabot.frozen import frozen
from mutabot.journal.files import HOME


@dataclass(slots=True)
class Project:
    """The files of a project.

    Attributes:
        request: of the campaign: root, program, oracle and vocabulary.
    """

    request: Request
    _modules: dict[str, ast.Module | None] = field(default_factory=dict)

    @property
    def root(self) -> Path:
        """The project's folder."""
        return self.request.root

    def text(self, file: str) -> str:
        """The text of a file."""
        return read_text(self.root, file)

    def lines(self, file: str) -> list[str]:
        """The lines of a file without their ends."""
        return self.text(file).splitlines()

    def module(self, file: str) -> ast.Module | None:
        """The parsed file; None if it cannot be read."""
        if file not in self._modules:
            try:
                self._modules[file] = ast.parse(self.text(file))
            except (OSError, SyntaxError, ValueError):
                self._modules[file] = None
        return self._modules[file]

    def import_name(self, file: str) -> str:
        """The name under which pytest and the tests import a file: with the packages that it is in."""
        path = self.root / file
        parts = [path.stem]
        folder = path.parent
        while (folder / "__init__.py").exists() and folder != self.root:
            parts.insert(0, folder.name)
            folder = folder.parent
        return ".".join(parts)

    def python_files(self, folders: tuple[str, ...]) -> list[str]:
        """The Python files that a list of files and folders names, relative to the root."""
        found: list[str] = []
        for name in folders:
            path = self.root / name
            files = sorted(path.rglob("*.py")) if path.is_dir() else [path]
            files = [one for one in files if one.suffix == ".py" and one.exists()]
            found += [str(one.relative_to(self.root)) for one in files]
        return found

    def beside(self, file: str) -> list[str]:
        """The ``conftest.py`` files that hold for a test file, nearest first."""
        folder = (self.root / file).parent
        found = []
        while folder.is_relative_to(self.root):
            if (folder / "conftest.py").exists():
                found.append(str((folder / "conftest.py").relative_to(self.root)))
            folder = folder.parent
        return found


#: an import that is longer is not made longer still
_JOINED = 70
_NO_END = "\\ No newline at end of file\n"


@frozen
class Insertion:
    """Lines that are put into a file.

    Attributes:
        file: relative to the project.
        after: the 1-based line after which they come; 0 for the beginning.
        lines: without their ends.
        instead: how many lines after that line they stand for.
    """

    file: str
    after: int
    lines: tuple[str, ...]
    instead: int = 0


def changed_texts(root: Path, insertions: Iterable[Insertion]) -> dict[str, str]:
    """The new texts of the files that change, by file. Equal lines at one place are put there once."""
    by_file: dict[str, dict[Insertion, None]] = {}
    for one in insertions:
        by_file.setdefault(one.file, {})[one] = None
    return {file: _changed(read_text(root, file), list(found)) for file, found in by_file.items()}


def read_text(root: Path, file: str) -> str:
    """The text of a project's file, with its own ends of lines."""
    return (root / file).read_bytes().decode("utf-8")


def _changed(text: str, insertions: list[Insertion]) -> str:
    lines = text.splitlines(keepends=True)
    end = "\r\n" if lines and lines[0].endswith("\r\n") else "\n"
    if lines and not lines[-1].endswith("\n"):
        lines[-1] += end
    for after in sorted({one.after for one in insertions}, reverse=True):
        here = [one for one in insertions if one.after == after]
        added = [line + end for one in here for line in one.lines]
        lines[after : after + max(one.instead for one in here)] = added
    return "".join(lines)


def diff_of(root: Path, texts: Mapping[str, str]) -> str:
    """One unified diff of all changed files, for ``git apply`` and ``patch -p1``."""
    parts: list[str] = []
    for file, text in sorted(texts.items()):
        before, after = read_text(root, file).splitlines(keepends=True), text.splitlines(keepends=True)
        parts += difflib.unified_diff(before, after, f"a/{file}", f"b/{file}")
    return "".join(one if one.endswith("\n") else f"{one}\n{_NO_END}" for one in parts)


@frozen
class Name:
    """How something of a module is named in a file.

    Attributes:
        text: the name.
        needs: the import that the file lacks, or None.
    """

    text: str
    needs: str | None = None


def name_in(module: ast.Module, wanted: str, attribute: str, taken: Iterable[str] = ()) -> Name:
    """How a file can name ``attribute`` of the module ``wanted``; ``taken`` are names of other things."""
    bound: set[str] = set(taken)
    for node in module.body:
        if isinstance(node, ast.ImportFrom) and node.module == wanted and not node.level:
            for alias in node.names:
                if alias.name == attribute and (alias.asname or alias.name) not in bound:
                    return Name(alias.asname or alias.name)
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name == wanted and (alias.asname or alias.name.partition(".")[0]) not in bound:
                    return Name(f"{alias.asname or alias.name}.{attribute}")
    bound |= top_names(module)
    if attribute not in bound:
        return Name(attribute, f"from {wanted} import {attribute}")
    return Name(f"{wanted}.{attribute}", f"import {wanted}")


def top_names(module: ast.Module) -> set[str]:
    """The names that a file binds at its top level."""
    found: set[str] = set()
    for node in module.body:
        if isinstance(node, ast.Import | ast.ImportFrom):
            found |= {alias.asname or alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            found.add(node.name)
        else:
            found |= {one.id for one in ast.walk(node) if isinstance(one, ast.Name)}
    return found


def imports_of(file: str, module: ast.Module, imports: Iterable[str]) -> list[Insertion]:
    """What puts imports into a file that lacks them: in their order, or into a line of the same module.

    All imports of a file must come at once.
    """
    has = {ast.unparse(node) for node in module.body}
    own = [node for node in module.body if isinstance(node, ast.Import | ast.ImportFrom)]
    own = [node for node in own if getattr(node, "module", None) != "__future__"]
    joined: dict[int, tuple[ast.ImportFrom, set[str]]] = {}
    found = []
    for line in sorted(set(imports), key=import_order):
        new = ast.parse(line).body[0]
        if ast.unparse(new) in has:
            continue
        host = _host(own, new)
        if host is not None and isinstance(new, ast.ImportFrom):
            joined.setdefault(host.lineno, (host, set()))[1].update(alias.name for alias in new.names)
        else:
            found.append(Insertion(file, _line_for(module, own, line), (line,)))
    for host, names in joined.values():
        texts = [f"{one.name} as {one.asname}" if one.asname else one.name for one in host.names]
        line = f"from {host.module} import {', '.join(sorted({*texts, *names}, key=_by_case))}"
        found.append(Insertion(file, host.lineno - 1, (line,), instead=1))
    return found


def import_order(line: str) -> tuple[bool, str]:
    """Plain imports first, then by module."""
    return line.startswith("from"), line.split()[1]


def _host(own: list[ast.Import | ast.ImportFrom], new: ast.stmt) -> ast.ImportFrom | None:
    """An import in one line from the same module, which the new one can join."""
    if not isinstance(new, ast.ImportFrom):
        return None
    froms = [node for node in own if isinstance(node, ast.ImportFrom) and not node.level]
    lines = [node for node in froms if node.module == new.module and node.lineno == node.end_lineno]
    return next((node for node in lines if len(ast.unparse(node)) < _JOINED), None)


def _by_case(name: str) -> tuple[int, str]:
    """Constants, classes, all others: as formatters of imports have it."""
    return (0 if name.isupper() else 1 if name[:1].isupper() else 2), name


def _line_for(module: ast.Module, own: list[ast.Import | ast.ImportFrom], line: str) -> int:
    if own:
        block = _block(own, line.split()[1].partition(".")[0])
        before = [node for node in block if import_order(ast.unparse(node)) < import_order(line)]
        return (before[-1].end_lineno or 0) if before else block[0].lineno - 1
    head = [
        node
        for node in module.body[:2]
        if isinstance(node, ast.ImportFrom) or (isinstance(node, ast.Expr) and _is_text(node.value))
    ]
    return (head[-1].end_lineno or 0) if head else 0


def _block(own: list[ast.Import | ast.ImportFrom], package: str) -> list[ast.Import | ast.ImportFrom]:
    """The imports that no empty line divides, among which one of this package belongs."""
    blocks: list[list[ast.Import | ast.ImportFrom]] = [[own[0]]]
    for before, node in pairwise(own):
        if node.lineno - (before.end_lineno or 0) > 1:
            blocks.append([])
        blocks[-1].append(node)
    if package in sys.stdlib_module_names:
        return blocks[0]
    same = [block for block in blocks if any(_package(node) == package for node in block)]
    foreign = [node for node in own if _package(node) not in sys.stdlib_module_names]
    others = [block for block in blocks if any(node in foreign for node in block)]
    return (same or others or blocks)[0]


def _package(node: ast.Import | ast.ImportFrom) -> str:
    name = node.module or "" if isinstance(node, ast.ImportFrom) else node.names[0].name
    return name.partition(".")[0]


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


#: folders that no test needs and that may be large
_LEFT = {HOME, ".git", ".hg", "__pycache__", ".pytest_cache", ".mypy_cache", ".ruff_cache", ".tox", ".nox"}
_LEFT |= {"node_modules"}
_PATH = "PYTHONPATH"


@contextmanager
def copy_of(request: Request, texts: Mapping[str, str]) -> Iterator[Request]:
    """The request for a private copy of the project in which files have these texts.

    Raises ConfigurationError if there is no place for it.
    """
    home = Path(tempfile.mkdtemp(prefix="mutabot-suggest-"))
    root = home / request.root.name
    before = os.environ.get(_PATH)
    try:
        try:
            shutil.copytree(request.root, root, symlinks=True, ignore=_ignored)
            for file, text in texts.items():
                (root / file).parent.mkdir(parents=True, exist_ok=True)
                (root / file).write_bytes(text.encode("utf-8"))
        except (OSError, shutil.Error) as error:
            problem = f"the project cannot be copied to {home} (set TMPDIR to another place): {error}"
            raise ConfigurationError(problem) from error
        os.environ[_PATH] = os.pathsep.join(_paths(request.root, root, before))
        yield replace(request, configuration=request.configuration.model_copy(update={"root": root}))
    finally:
        if before is None:
            os.environ.pop(_PATH, None)
        else:
            os.environ[_PATH] = before
        shutil.rmtree(home, ignore_errors=True)


def _ignored(folder: str, names: Sequence[str]) -> set[str]:
    return {name for name in names if name in _LEFT or Path(folder, name, "pyvenv.cfg").exists()}


def _paths(own: Path, copy: Path, before: str | None) -> list[str]:
    """Where the copy's modules are found, before those of an installation that points to the project."""
    found = [str(copy / "src")] if (copy / "src").is_dir() else []
    given = [entry for entry in (before or "").split(os.pathsep) if entry]
    for entry in [*given, *sys.path[1:]]:  # the first is where this process was started
        path = Path(entry).resolve()
        copied = copy / path.relative_to(own) if path.is_relative_to(own) else None
        if copied is not None and copied.is_dir():
            found.append(str(copied))
        elif copied is None and entry in given:
            found.append(entry)
    return list(dict.fromkeys(found))
