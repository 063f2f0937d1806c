"""What watches runs beside the user's program and in processes of the tests: it imports next to nothing."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import mutabot_init.watching

#: beside the standard library
ALLOWED = (
    "mutabot.api.processes", "mutabot.api.values", "mutabot_init.proposers", "mutabot_init.observations",
    "mutabot_init.watching", "mutabot_init.words",
)  # fmt: skip


def imported(tree: ast.AST) -> Iterator[str]:
    """Names of modules that a file imports, and of what it takes out of the top package."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            names = [alias.name for alias in node.names] if node.module == "mutabot" else [""]
            yield from (f"{node.module}.{name}".strip(".") for name in names)


def test_it_imports_the_standard_library_and_the_interface() -> None:
    files = sorted(Path(mutabot_init.watching.__file__).parent.glob("*.py"))
    names = {name for file in files for name in imported(ast.parse(file.read_text(encoding="utf-8")))}
    assert "mutabot.api.processes" in names
    wrong = {
        name
        for name in names
        if name.partition(".")[0] not in sys.stdlib_module_names
        and not any(name == allowed or name.startswith(f"{allowed}.") for allowed in ALLOWED)
    }
    assert wrong == set()


def test_processes_below_the_tests_need_no_pytest_for_it() -> None:
    code = (
        "import sys, mutabot_init.watching.watch, mutabot.runtime.observer, mutabot_init.proposers\n"
        "[one.watch() for one in mutabot_init.proposers.brought_proposers().values()]\n"
        "heavy = {'pytest', '_pytest', 'pydantic', 'rich', 'typer', 'mujoco', 'numpy', 'libcst'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
