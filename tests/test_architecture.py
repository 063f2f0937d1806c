"""Imports go one way, without cycles, and the inside needs almost nothing."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from pkgutil import resolve_name

import pytest

from rooms import SOURCE, files, gathered, imports, levels, name_of, rooms

#: package -> packages of ours it may import, beside ``frozen`` and ``lazy``
ALLOWED = {
    "errors": set(),
    "extensions": {"errors"},
    "families": set(),
    "faults": {
        "errors", "extensions", "families", "languages", "model", "operators", "original", "thresholds",
    },
    "thresholds": {"errors", "families", "model"},
    "repository": set(),
    "shared_memory": set(),
    "testpaths": set(),
    "model": {"errors", "extensions", "families"},
    "languages": {"extensions", "model"},
    "operators": {"errors", "extensions", "families", "model"},
    "config": {"errors", "extensions", "families", "model", "operators", "faults", "testpaths", "thresholds"},
    "evidence": {"model"},
    "runtime": {"errors", "extensions", "model", "languages", "operators", "evidence", "shared_memory"},
    "execution": {"errors", "evidence", "extensions", "model", "testpaths"},
    "journal": {"errors", "model", "repository"},
    "original": {"errors", "model"},
    "api": {
        "errors", "extensions", "faults", "model", "original", "operators", "languages", "config", "cli",
        "execution", "campaign", "evidence", "journal", "results", "report", "runtime", "shared_memory",
    },
    "campaign": {
        "errors", "extensions", "families", "faults", "model", "original", "languages", "config", "execution",
        "operators", "journal", "evidence", "repository", "thresholds",
    },
    "results": {"errors", "families", "model", "journal", "evidence", "thresholds"},
    "report": {"errors", "extensions", "languages", "model", "journal", "results", "evidence", "thresholds"},
    "__main__": {"cli"},
    "cli": {
        "errors", "extensions", "families", "faults", "model", "config", "execution",
        "journal", "campaign", "results", "report", "thresholds",
    },
}  # fmt: skip
FILES = files()
#: those of the packages beside the core as well
ALL_FILES = sorted(SOURCE.parent.rglob("*.py"))


def part(module: str) -> str | None:
    """Which of our packages a module belongs to; None for others and for the top package itself."""
    names = module.split(".")
    return names[1] if names[0] == "mutabot" and len(names) > 1 else None


def test_imports_go_one_way() -> None:
    wrong = []
    for file in FILES:
        own = file.relative_to(SOURCE).parts[0].removesuffix(".py")
        allowed = {None, own, "frozen", "lazy", *ALLOWED.get(own, ())}
        if own != "__init__":
            wrong += [f"{file} imports {module}" for module in imports(file) if part(module) not in allowed]
    assert wrong == []


def test_packages_beside_the_core_import_the_core_and_none_of_each_other() -> None:
    """That the core imports none of them is a rule of the linter (``banned-api`` in pyproject.toml)."""
    packages = [path.parent for path in SOURCE.parent.glob("mutabot_*/__init__.py")]
    assert len(packages) == 14
    wrong = [
        f"{file.relative_to(SOURCE.parent)} imports {name}"
        for package in packages
        for file in package.rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        for name in _imported(node)
        if name.startswith("mutabot_") and name.partition(".")[0] != package.name
    ]
    assert wrong == []


def test_ros_in_process_knows_nothing_of_mutabot() -> None:
    files = [*SOURCE.parent.glob("ros_in_process/**/*.py")]
    assert len(files) > 30
    assert [str(file) for file in files if "mutabot" in file.read_text(encoding="utf-8").lower()] == []


def _imported(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    return [node.module or ""] if isinstance(node, ast.ImportFrom) and not node.level else []


def test_reports_read_the_results_and_no_journal() -> None:
    allowed = {"mutabot.journal", "mutabot.journal.records", "mutabot.journal.files"}
    wrong = [
        f"{file} imports {module}"
        for file in (SOURCE / "report").rglob("*.py")
        for module in imports(file)
        if module.startswith("mutabot.journal") and module not in allowed
    ]
    assert wrong == []


def test_no_module_imports_itself_in_a_circle() -> None:
    graph = {name_of(file): {*imports(file)} - {name_of(file)} for file in ALL_FILES}
    assert {"mutabot", "mutabot_ros", "ros_in_process"} <= graph.keys()
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


def test_no_top_folder_leads_back_to_itself() -> None:
    levels(gathered(rooms()))


def test_the_runtime_imports_the_standard_library_wrapt_and_pytest_only() -> None:
    allowed = {"wrapt", "pytest", "_pytest", "mutabot", *sys.stdlib_module_names}
    for file in (SOURCE / "runtime").rglob("*.py"):
        for module in imports(file):
            assert module.partition(".")[0] in allowed, f"{file.name} imports {module}"


def test_the_sleeping_plugin_loads_neither_operators_nor_wrapt() -> None:
    code = (
        "import sys, pytest, mutabot.runtime.pytest_plugin\n"
        "heavy = {'wrapt', 'pydantic', 'rich', 'typer', 'mujoco', 'numpy', 'mutabot.runtime.session'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_processes_below_the_tests_need_no_pytest() -> None:
    code = (
        "import sys, mutabot.runtime.processes.member\n"
        "heavy = {'pytest', '_pytest', 'pydantic', 'rich', 'typer', 'mujoco', 'numpy', 'libcst'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


_CHANGES = {"add", "append", "clear", "discard", "extend", "insert", "pop", "remove", "setdefault", "update"}


def _is_of_baseline(node: ast.expr) -> bool:
    """Whether something is an attribute of a baseline, or an item of one."""
    while isinstance(node, ast.Subscript):
        node = node.value
    if not isinstance(node, ast.Attribute):
        return False
    owner = node.value
    return "baseline" in (getattr(owner, "id", None), getattr(owner, "attr", None))


def test_the_baseline_is_changed_by_its_own_room_alone() -> None:
    for file in (SOURCE / "campaign").rglob("*.py"):
        if file.parent.name == "baseline":
            continue
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            changed: list[ast.expr] = []
            if isinstance(node, ast.Assign | ast.Delete):
                changed = [*node.targets]
            elif isinstance(node, ast.AugAssign | ast.AnnAssign):
                changed = [node.target]
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                changed = [node.func.value] if node.func.attr in _CHANGES else []
            assert not any(_is_of_baseline(target) for target in changed), f"{file}:{node.lineno}"


@pytest.mark.parametrize("text", ["baseline.x.add(1)", "a.baseline.x[1] = 2", "baseline.x += 1"])
def test_a_change_of_the_baseline_is_seen(text: str) -> None:
    statement = ast.parse(text).body[0]
    if isinstance(statement, ast.Expr):
        assert isinstance(statement.value, ast.Call)
        assert isinstance(statement.value.func, ast.Attribute)
        assert _is_of_baseline(statement.value.func.value)
    else:
        assert isinstance(statement, ast.Assign | ast.AugAssign)
        assert _is_of_baseline(
            statement.target if isinstance(statement, ast.AugAssign) else statement.targets[0]
        )


def test_the_source_speaks_of_rooms_and_modules_that_there_are() -> None:
    room = "|".join(sorted({file.relative_to(SOURCE).parts[0].removesuffix(".py") for file in FILES}))
    told = {
        (name, file)
        for file in ALL_FILES
        for name in re.findall(
            rf"``(?:mutabot\.)?((?:{room})\.[A-Za-z_.]+)(?<!sqlite)``", file.read_text("utf-8")
        )
    }
    assert told
    for name, file in told:
        try:
            resolve_name(f"mutabot.{name}")
        except (ImportError, AttributeError):
            pytest.fail(f"{file.relative_to(SOURCE.parent)} speaks of {name}, which is not there")


#: aliases of option types are always written with their module: ``options.Seed``
_WITH_MODULE = {"mutabot/cli/options.py"}


def test_no_two_classes_share_a_name() -> None:
    """Private classes and aliases of types count as well, and those of all packages."""
    found: dict[str, set[str]] = {}
    for file in sorted(SOURCE.parent.rglob("*.py")):
        place = str(file.relative_to(SOURCE.parent))
        for name in _types(file) if place not in _WITH_MODULE else ():
            found.setdefault(name.lstrip("_"), set()).add(place)
    assert found
    assert {name: sorted(places) for name, places in found.items() if len(places) > 1} == {}


def _types(file: Path) -> Iterator[str]:
    for node in ast.parse(file.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            name = node.targets[0].id
            if re.fullmatch(r"_?[A-Z][a-z]\w*", name) and "TypeVar(" not in ast.unparse(node.value):
                yield name
