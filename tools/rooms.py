"""The rooms of the package and which of them import which, read from the program text.

A folder without folders is a room, and so is a file beside folders. ``tests/test_architecture.py`` holds the
imports to their rules, and ``make_design_page.py`` draws them.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "src" / "mutabot"

Graph = Mapping[str, set[str]]


def files() -> list[Path]:
    """All modules of the package."""
    return sorted(SOURCE.rglob("*.py"))


@cache
def imports(file: Path) -> list[str]:
    """Absolute names of the modules that a file of the package, or of one beside it, imports."""
    return [*_imports(file)]


def _imports(file: Path) -> Iterator[str]:
    package = [*file.relative_to(SOURCE.parent).parent.parts]
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            start = package[: len(package) - node.level + 1] if node.level else []
            module = ".".join([*start, *([node.module] if node.module else [])])
            yield module
            yield from (name for alias in node.names if (name := f"{module}.{alias.name}") in _modules())


@cache
def _modules() -> frozenset[str]:
    return frozenset(map(name_of, SOURCE.parent.rglob("*.py")))


def name_of(file: Path) -> str:
    """The name a module is imported under."""
    names = [*file.relative_to(SOURCE.parent).with_suffix("").parts]
    return ".".join(names[:-1] if names[-1] == "__init__" else names)


def room_of(file: Path) -> str:
    """The room a module is in: its folder, or itself if its folder has folders."""
    has_folders = any((folder / "__init__.py").exists() for folder in file.parent.iterdir())
    return str((file.with_suffix("") if has_folders else file.parent).relative_to(SOURCE))


def rooms() -> dict[str, set[str]]:
    """Room -> other rooms it imports; what gathers the modules of a package counts as importing nothing."""
    homes = {name_of(file): room_of(file) for file in files()}
    found: dict[str, set[str]] = {room: set() for room in homes.values()}
    for file in files():
        for module in imports(file):
            other = homes.get(module)
            if other is not None and "__init__" not in (file.stem, other):
                found[room_of(file)].add(other)
    return {room: others - {room} for room, others in found.items()}


def gathered(graph: Graph) -> dict[str, set[str]]:
    """The same with all rooms of a package as one."""
    found: dict[str, set[str]] = {}
    for room, others in graph.items():
        top = room.partition("/")[0]
        found.setdefault(top, set()).update(other.partition("/")[0] for other in others)
    return {top: others - {top} for top, others in found.items()}


def levels(graph: Graph) -> dict[str, int]:
    """How many rooms stand below each room, on the longest way down.

    Raises ValueError if a way leads back to where it began.
    """
    found: dict[str, int] = {}

    def level(room: str, path: tuple[str, ...]) -> int:
        if room in path:
            raise ValueError(" -> ".join((*path[path.index(room) :], room)))
        if room not in found:
            found[room] = 1 + max(
                (level(below_room, (*path, room)) for below_room in graph[room]), default=-1
            )
        return found[room]

    for room in graph:
        level(room, ())
    return found


def direct(graph: Graph, room: str) -> set[str]:
    """The rooms that a room imports, without those that stand below another of them."""
    return {
        neighbour
        for neighbour in graph[room]
        if not any(neighbour in below(graph, other) for other in graph[room])
    }


def below(graph: Graph, room: str) -> set[str]:
    """All rooms that a room imports, also by way of others."""
    found: set[str] = set()
    waiting: list[str] = [*graph[room]]
    while waiting:
        lowest = waiting.pop()
        if lowest not in found:
            found.add(lowest)
            waiting += graph[lowest]
    return found


def among(graph: Graph, names: Iterable[str]) -> dict[str, set[str]]:
    """The graph of some rooms alone."""
    chosen = set(names)
    return {room: graph[room] & chosen for room in graph if room in chosen}
