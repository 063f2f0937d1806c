"""What the text of a project tells: where program and tests lie, and which calls no test reaches."""

from __future__ import annotations

import ast
import builtins
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from mutabot.errors import UsageError
from mutabot.extensions import libraries

#: folders that hold no code of the project
_SKIPPED = frozenset(
    {"node_modules", "build", "dist", "site-packages", "venv", "env", "__pycache__", "docs", "doc"}
)
_TEST_FOLDERS = ("tests", "test", "testing", "features")
_NO_PROGRAMS = frozenset({"setup.py", "noxfile.py", "fabfile.py", "conftest.py", "__init__.py"})
_MOST_FILES = 1000
#: words in a file's name that say "this is a robot program", where there is a choice
_PROGRAM_NAMES = (
    "mission", "program", "main", "task", "job", "app", "process", "pick", "place", "pallet", "sort",
    "policy", "routine", "sequence", "demo", "controller",
)  # fmt: skip


@dataclass(frozen=True)
class Layout:
    """What lies where in a project.

    Attributes:
        root: absolute path of the project.
        program: files with the robot program.
        tests: files on the tests' side: tests, their helpers, conftest.
        arguments: pytest arguments that name the tests.
        guessed: whether the program was guessed.
    """

    root: Path
    program: list[Path]
    tests: list[Path]
    arguments: list[str]
    guessed: bool

    def relative(self, path: Path) -> str:
        """A path as the configuration writes it."""
        return path.relative_to(self.root).as_posix()


def look(root: Path, given: Sequence[Path]) -> Layout:
    """The layout of the project in ``root``; ``given`` are files or folders of the program, if known.

    Raises UsageError if a given path is not there, or if there is no Python file at all.
    """
    files = _python_files(root)
    chosen = _named(root, given)
    tests = [path for path in files if _is_test_side(path.relative_to(root)) and path not in chosen]
    code = [path for path in files if path not in tests and path.name not in _NO_PROGRAMS]
    program = chosen or _guess_program(code) or [path for path in tests if path.name != "conftest.py"]
    if not program:
        raise UsageError(
            f"{root}: there is no Python file here; name the files of the program: mutabot init FILE…"
        )
    others = [path for path in tests if path not in program]
    arguments = _arguments(root, tests)
    return Layout(root, program, others, arguments, guessed=not chosen)


def imported_modules(path: Path) -> set[str]:
    """Names of the modules that a file imports, and of what it imports from them."""
    names: set[str] = set()
    for node in ast.walk(parsed(path)):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            source = node.module or ""
            names.update([source, *(f"{source}.{alias.name}".strip(".") for alias in node.names)])
    return names - {""}


def parsed(path: Path) -> ast.Module:
    """A file's syntax tree; an empty one if it is no Python."""
    try:
        return ast.parse(path.read_bytes())
    except (OSError, SyntaxError, ValueError):
        return ast.Module([], [])


def _python_files(folder: Path) -> list[Path]:
    return list(_walk(folder))[:_MOST_FILES]


def _walk(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or path.name in _SKIPPED or (path / "pyvenv.cfg").exists():
            continue
        if path.is_dir() and not path.is_symlink():
            yield from _walk(path)
        elif path.suffix == ".py":
            yield path


def _is_test_side(path: Path) -> bool:
    in_folder = any(part in _TEST_FOLDERS for part in path.parts[:-1])
    stem = path.stem
    return in_folder or stem.startswith("test_") or stem.endswith("_test") or stem == "conftest"


def _named(root: Path, given: Sequence[Path]) -> list[Path]:
    found: list[Path] = []
    for path in given:
        place = next((one for one in (path, root / path) if one.exists()), None)
        if place is None:
            raise UsageError(f"{path}: there is no such file or folder")
        if not place.resolve().is_relative_to(root):
            raise UsageError(f"{path} does not lie in {root}; -C names the project's folder")
        found += _python_files(place.resolve()) if place.is_dir() else [place.resolve()]
    return list(dict.fromkeys(found))


def _guess_program(code: Sequence[Path]) -> list[Path]:
    """Files that use others and are used by none of the program's side; by their names where that helps."""
    ends = {path: path.stem for path in code}
    imports = {path: {part for name in imported_modules(path) for part in name.split(".")} for path in code}
    used = {path for path in code for other in code if other != path and ends[path] in imports[other]}
    using = [path for path in code if imports[path]]
    free = [path for path in using if path not in used] or using or list(code)
    telling = [path for path in free if any(word in path.stem.lower() for word in _PROGRAM_NAMES)]
    busy = [path for path in free if imports[path] & set(ends.values())]
    return telling or busy or free


def _arguments(root: Path, tests: Sequence[Path]) -> list[str]:
    """The outermost folder of tests for each file, or the file where it lies among others."""
    found = []
    for path in tests:
        parts = path.relative_to(root).parts
        folder = next((index for index, part in enumerate(parts[:-1]) if part in _TEST_FOLDERS), None)
        if folder is not None:
            found.append("/".join(parts[: folder + 1]))
        elif path.stem != "conftest":
            found.append("/".join(parts))
    return list(dict.fromkeys(found))


_NO_ROBOTS = frozenset({*sys.stdlib_module_names, "numpy", "np", "pytest", "math3d"})


@dataclass(frozen=True)
class Unreached:
    """A call in the text that was not seen: its file, line and callee as written."""

    file: str
    line: int
    callee: str


def compared_with(layout: Layout) -> list[list[Any]]:
    """Constants that the program and its tests compare one and the same thing with, a list for each thing."""
    groups: dict[str, list[Any]] = {}
    for path in (*layout.program, *layout.tests):
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.Compare):
                constants = [value for one in node.comparators for value in _constants(one)]
                groups.setdefault(ast.unparse(node.left), []).extend(constants)
    return [list(dict.fromkeys(group)) for group in groups.values() if group]


def with_compared(values: Sequence[Any], groups: Iterable[Sequence[Any]]) -> list[Any]:
    """Values that were seen, and those that the program compares the same thing with."""
    found = list(values)
    for group in groups:
        if any(isinstance(value, str) and value in group for value in values):
            found += [value for value in group if value not in found]
    return found


def unreached(layout: Layout, seen: Iterable[tuple[str, int, str]]) -> list[Unreached]:
    """Calls of the text that the run did not make; ``seen``: file, line and name of those it did."""
    made = set(seen)
    lines = {(file, line) for file, line, _ in made}  # a function may have another name here
    found: dict[tuple[str, str], Unreached] = {}
    for path in layout.program:
        tree, file = parsed(path), layout.relative(path)
        own = {one.name for one in ast.walk(tree)
               if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)}  # fmt: skip
        for node, names in _callees(tree):
            line = node.func.end_lineno or node.lineno
            is_made = (file, line, names[-1]) in made or (len(names) == 1 and (file, line) in lines)
            if not is_made and not _is_plain(names, own):
                call = Unreached(file, line, ".".join(names))
                found.setdefault((file, call.callee), call)
    return sorted(found.values(), key=lambda call: (call.file, call.line))


def _callees(tree: ast.Module) -> Iterator[tuple[ast.Call, list[str]]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            names: list[str] = []
            part: ast.expr = node.func
            while isinstance(part, ast.Attribute):
                names.insert(0, part.attr)
                part = part.value
            if isinstance(part, ast.Name):
                yield node, [part.id, *names]


def _is_plain(names: Sequence[str], own: set[str]) -> bool:
    """Whether it is no robot's: a builtin, a class, something private or of the standard library."""
    last = names[-1]
    return (
        (len(names) == 1 and (hasattr(builtins, last) or last in own))
        or names[0] in _NO_ROBOTS
        or any(fnmatchcase(names[0], one) and last not in known for one, known in libraries().items())
        or last.startswith("_")
        or last[:1].isupper()
        or any(hasattr(kind, last) for kind in (list, dict, str, set))
        or (names[0] == "self" and last in own)
    )


def _constants(node: ast.expr) -> Iterator[Any]:
    parts = node.elts if isinstance(node, ast.Tuple | ast.List | ast.Set) else [node]
    for part in parts:
        if isinstance(part, ast.Constant) and isinstance(part.value, str | int | float):
            yield part.value
