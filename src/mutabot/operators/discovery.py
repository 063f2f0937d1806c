"""Finding operators by the files in a folder."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any


def modules_in(folder: Path) -> list[str]:
    """Names of the modules in a folder, bar those that begin with ``_``; none of them is loaded."""
    return sorted(file.stem for file in folder.glob("*.py") if not file.name.startswith("_"))


def packages_in(folder: Path) -> list[str]:
    """Names of the packages in a folder; none of them is loaded."""
    return sorted(file.parent.name for file in folder.glob("*/__init__.py"))


def classes_in(module: ModuleType, base: type[Any]) -> list[type[Any]]:
    """The concrete subclasses of ``base`` that a module itself defines, in the order of its text."""
    return [
        kind
        for kind in vars(module).values()
        if isinstance(kind, type) and issubclass(kind, base)
        if kind.__module__ == module.__name__ and not getattr(kind, "__abstractmethods__", None)
    ]
