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
from pathlib import Path

from mutabot.campaign.request import Request
from mutabot.errors import ConfigurationError
from mutabot.frozen import frozen
from mutabot.journal.files import HOME


@dataclass(slots=True)
class ProjectFiles:
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


_NO_END = "\\ No newline at end of file\n"


def read_text(root: Path, file: str) -> str:
    """The text of a project's file, with its own ends of lines."""
    return (root / file).read_bytes().decode("utf-8")


def diff_of(root: Path, texts: Mapping[str, str]) -> str:
    """One unified diff of all changed files, for ``git apply`` and ``patch -p1``."""
    parts: list[str] = []
    for file, text in sorted(texts.items()):
        before, after = read_text(root, file).splitlines(keepends=True), text.splitlines(keepends=True)
        parts += difflib.unified_diff(before, after, f"a/{file}", f"b/{file}")
    return "".join(one if one.endswith("\n") else f"{one}\n{_NO_END}" for one in parts)


@frozen
class ImportedName:
    """How something of a module is named in a file.

    Attributes:
        text: the name.
        needs: the import that the file lacks, if it does.
    """

    text: str
    needs: tuple[str, ...] = ()


def name_in(module: ast.Module, wanted: str, attribute: str, taken: Iterable[str] = ()) -> ImportedName:
    """How a file can name ``attribute`` of the module ``wanted``; ``taken`` are names of other things."""
    bound: set[str] = set(taken)
    for node in module.body:
        if isinstance(node, ast.ImportFrom) and node.module == wanted and not node.level:
            for alias in node.names:
                if alias.name == attribute and (alias.asname or alias.name) not in bound:
                    return ImportedName(alias.asname or alias.name)
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name == wanted and (alias.asname or alias.name.partition(".")[0]) not in bound:
                    return ImportedName(f"{alias.asname or alias.name}.{attribute}")
    bound |= top_names(module)
    if attribute not in bound:
        return ImportedName(attribute, (f"from {wanted} import {attribute}",))
    return ImportedName(f"{wanted}.{attribute}", (f"import {wanted}",))


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
