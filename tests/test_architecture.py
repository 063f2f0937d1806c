"""Imports go one way, without cycles, and the inside needs almost nothing."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import mutabot

SOURCE = Path(mutabot.__file__).parent
#: package -> packages of ours it may import
ALLOWED = {
    "errors": set(),
    "model": {"errors"},
    "operators": {"errors", "model"},
    "inside": {"errors", "model", "operators"},
    "vocabulary": {"errors", "model"},
    "classical": {"errors", "model"},
    "campaign": {"errors", "model", "operators", "vocabulary", "classical"},
    "analysis": {"errors", "model", "vocabulary", "campaign"},
    "report": {"errors", "model", "vocabulary", "campaign", "analysis"},
    "cells": set(),
    "__main__": {"cli"},
    "cli_options": {"errors", "model"},
    "cli_compare": {"errors", "campaign", "analysis"},
    "cli": {"errors", "model", "vocabulary", "campaign", "analysis", "report", "cli_options", "cli_compare"},
}
FILES = sorted(SOURCE.rglob("*.py"))


def imports(file: Path) -> Iterator[str]:
    """Absolute names of the modules a file imports."""
    package = ["mutabot", *file.relative_to(SOURCE).parent.parts]
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            start = package[: len(package) - node.level + 1] if node.level else []
            yield ".".join([*start, *([node.module] if node.module else [])])


def part(module: str) -> str | None:
    """Which of our packages a module belongs to; None for others and for the top package itself."""
    names = module.split(".")
    return names[1] if names[0] == "mutabot" and len(names) > 1 else None


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(SOURCE)))
def test_imports_go_one_way(file: Path) -> None:
    own = file.relative_to(SOURCE).parts[0].removesuffix(".py")
    if own == "__init__":
        return
    for module in imports(file):
        other = part(module)
        assert other is None or other == own or other in ALLOWED[own], f"{file} imports {module}"


def test_no_module_imports_itself_in_a_circle() -> None:
    graph = {
        _name(file): {module for module in imports(file) if module.startswith("mutabot.")} for file in FILES
    }
    done: set[str] = set()

    def visit(module: str, path: tuple[str, ...]) -> None:
        assert module not in path, " -> ".join((*path, module))
        if module in done or module not in graph:
            return
        for other in graph[module]:
            if other != module.rpartition(".")[0]:  # a package's own __init__ gathers its modules
                visit(other, (*path, module))
        done.add(module)

    for module in graph:
        visit(module, ())


def _name(file: Path) -> str:
    names = ["mutabot", *file.relative_to(SOURCE).with_suffix("").parts]
    return ".".join(names[:-1] if names[-1] == "__init__" else names)


def test_the_inside_imports_the_standard_library_wrapt_and_pytest_only() -> None:
    allowed = {"wrapt", "pytest", "mutabot", *sys.stdlib_module_names}
    for file in (SOURCE / "inside").glob("*.py"):
        for module in imports(file):
            assert module.partition(".")[0] in allowed, f"{file.name} imports {module}"


def test_the_sleeping_plugin_loads_neither_operators_nor_wrapt() -> None:
    code = (
        "import sys, pytest, mutabot.inside.pytest_plugin\n"
        "heavy = {'wrapt', 'pydantic', 'rich', 'typer', 'mujoco', 'numpy', 'mutabot.inside.session'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
