"""Packages beside the core import ``mutabot.api`` and nothing else of mutabot; it is small and described."""

from __future__ import annotations

import ast
import inspect
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

import mutabot.api

SOURCE = Path(mutabot.api.__file__).parents[2]
MODULES = [import_module(f"mutabot.api.{name}") for name in ("faults", "values", "reports", "processes")]
PACKAGES = sorted(path.parent.name for path in SOURCE.glob("mutabot_*/__init__.py"))


def names(module: ModuleType) -> list[str]:
    return [name for names in module._HOMES.values() for name in names]


def test_the_interface_has_at_most_seventy_names_each_in_one_module() -> None:
    found = [name for module in MODULES for name in names(module)]
    assert len(found) == len(set(found)) <= 70


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_each_class_and_function_has_a_docstring(module: ModuleType) -> None:
    described = {name: found for name in names(module) if not _is_alias(found := getattr(module, name))}
    assert [name for name, found in described.items() if not (found.__doc__ or "").strip()] == []


def _is_alias(found: object) -> bool:
    return not (inspect.isclass(found) or inspect.isroutine(found))


@pytest.mark.parametrize("package", PACKAGES)
def test_packages_import_nothing_of_mutabot_but_its_interface(package: str) -> None:
    outside = {
        f"{file.relative_to(SOURCE)}:{node.lineno}: {name}"
        for file in (SOURCE / package).rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        for name in imported(node)
        if name.partition(".")[0] == "mutabot" and not name.startswith("mutabot.api.")
    }
    assert sorted(outside) == []


def imported(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom) and not node.level:
        return [f"{node.module}.{alias.name}" for alias in node.names]
    return []
