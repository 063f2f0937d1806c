"""A project's test files as they are read: parsed once, with the names under which they are imported."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from pathlib import Path

from mutabot.campaign.request import Request

from .texts import read_text


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
