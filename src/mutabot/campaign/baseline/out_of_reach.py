"""Find which files of the program tests may run in processes that cannot join the campaign.

No mutant of a call acts there, so that such a test does not judge it: what it lets through may be noticed.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Iterator, Mapping
from importlib.util import decode_source
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.languages.registry import program_files

if TYPE_CHECKING:
    from mutabot.model.events import OutOfReach, TestEnd

#: modules that import what the text does not name
_IMPORTING = {"importlib", "runpy", "pkgutil"}


def files_out_of_reach(
    root: Path, program: Iterable[str], ends: Mapping[tuple[int, str], TestEnd]
) -> dict[tuple[int, str], dict[str, str]]:
    """Return, by round and test, the files of the program that run so, each with the command and why."""
    if not any(end.out_of_reach for end in ends.values()):
        return {}
    files = program_files(root, program)
    return {
        key: {
            file: f"{process.command} ({process.why})"
            for process in end.out_of_reach
            for file in _files_of(process, root, files)
        }
        for key, end in ends.items()
        if end.out_of_reach
    }


def _files_of(process: OutOfReach, root: Path, program: Collection[str]) -> Collection[str]:
    """Return the files of the program that a process names, and those that they import, or may import."""
    if process.files is None:
        return program
    waiting, found = [*map(Path, process.files)], set[Path]()
    while waiting:
        path = waiting.pop()
        if path in found:
            continue
        found.add(path)
        try:
            names = set(_imports(ast.parse(decode_source(path.read_bytes()))))
        except (OSError, SyntaxError, ValueError):
            continue
        if not _IMPORTING.isdisjoint(name.partition(".")[0] for name in names):
            return program
        waiting += [(root / file).resolve() for file in program if _is_named(file, names)]
    return [file for file in program if (root / file).resolve() in found]


def _imports(tree: ast.Module) -> Iterator[str]:
    """Yield the dotted names of all modules that a file may import; of relative ones without their dots."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            module = f"{node.module}." if node.module else ""
            yield from (f"{module}{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Name) and node.id == "__import__":
            yield "importlib"


def _is_named(file: str, names: Iterable[str]) -> bool:
    """Return whether one of these names is that of a file's module, of a package around it, or in it."""
    parts = [*Path(file).with_suffix("").parts]
    last = parts[-2:-1] if parts[-1] == "__init__" else parts[-1:]
    return any(set(last) <= set(name.split(".")) for name in names)
