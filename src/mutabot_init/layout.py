"""Finds where a project's program and tests are, and the values with which they compare."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from mutabot.api.reports import UsageError

from .words import words_of

#: folders that hold no code of the project
_SKIPPED = frozenset(
    {"node_modules", "build", "dist", "site-packages", "venv", "env", "__pycache__", "docs", "doc"}
)
_TEST_FOLDERS = ("tests", "test", "testing", "features")
_TEST_FILES = ("conftest", "tests", "test")
#: words in the names of files that stand in for a device
_DOUBLES = frozenset({"mock", "mocks", "fake", "fakes", "stub", "stubs", "dummy", "dummies"})
_NO_PROGRAMS = frozenset({"setup.py", "noxfile.py", "fabfile.py", "conftest.py", "__init__.py"})
_MOST_FILES = 1000
#: what stands at the top of a project
_OF_PROJECTS = ("pyproject.toml", "setup.py", "setup.cfg", "pytest.ini", "tox.ini")
NOTHING_WRITTEN = "nothing was written: `mutabot init` runs the tests to see what the program calls"
#: methods that no robot alone has
_OF_BUILT_INS = frozenset(name for kind in (dict, list, set, str, bytes) for name in dir(kind))
#: words in a file's name that say "this is a robot program", where there is a choice
_PROGRAM_NAMES = (
    "mission", "program", "main", "task", "job", "app", "process", "pick", "place", "pallet", "sort",
    "policy", "routine", "sequence", "controller",
)  # fmt: skip


@dataclass(frozen=True)
class Layout:
    """The locations of a project's files.

    Attributes:
        root: absolute path of the project.
        program: files with the robot program.
        tests: files on the tests' side: tests, their helpers, conftest.
        arguments: pytest arguments that name the tests.
        guessed: whether the program was guessed.
        below: files that a guessed program imports and that import others in turn.
        imported: all files of the project that a guessed program imports.
    """

    root: Path
    program: list[Path]
    tests: list[Path]
    arguments: list[str]
    guessed: bool
    below: list[Path]
    imported: list[Path]

    def extended(self, files: Sequence[Path]) -> Layout:
        """Return the layout with these files as parts of the program."""
        return replace(self, program=[*self.program, *files], below=[], imported=[])

    def importing(self, packages: Collection[str]) -> list[Path]:
        """Return the files below the program that import one of these packages."""
        return [
            path
            for path in self.imported
            if any(name.partition(".")[0] in packages for name in imported_modules(path))
        ]

    def relative(self, path: Path) -> str:
        """Return a path as the configuration writes it."""
        return path.relative_to(self.root).as_posix()


def look(root: Path, given: Sequence[Path]) -> Layout:
    """Return the layout of the project in ``root``; ``given``: the program's files or folders, if known.

    Raises UsageError if a given path is not there, or if there is no Python file at all.
    """
    files = _python_files(root)
    chosen = _named(root, given)
    suites = [path for path in files if _is_test_side(path.relative_to(root)) and path not in chosen]
    code = [path for path in files if path not in suites]
    doubles = [path for path in _doubles(code, root) if path not in chosen]
    tests, code = [*suites, *doubles], [path for path in code if path not in doubles]
    program = (
        chosen or _guess_program(code, tests, root) or [path for path in tests if path.name != "conftest.py"]
    )
    if not program:
        raise UsageError(
            f"{root}: there is no Python file here; name the files of the program: mutabot init FILE…"
        )
    others = [path for path in tests if path not in program]
    arguments = _arguments(root, suites)
    modules = _Modules(code, root)
    imported = set() if chosen else modules.reached(program) - set(program)
    below = [path for path in code if path in imported and modules.reached([path]) - {path}]
    under = [path for path in code if path in imported]
    return Layout(root, program, others, arguments, guessed=not chosen, below=below, imported=under)


def other_files(root: Path, given: Sequence[Path]) -> list[Path]:
    """Return non-Python files: the given ones, or those of a project without a Python program.

    Raises UsageError if a given path is not there.
    """
    places = _places(root, given) or [root]
    files = [file for place in places for file in (_walk(place) if place.is_dir() else [place])]
    program = [file for file in files if file.suffix != ".py" or not _is_test_side(file.relative_to(root))]
    return [] if any(file.suffix == ".py" for file in program) else program[:_MOST_FILES]


def refuse_mistakes(layout: Layout) -> None:
    """Raise UsageError if a file of the program, or a conftest, is not valid Python."""
    for path in (*layout.program, *(file for file in layout.tests if file.name == "conftest.py")):
        try:
            ast.parse(path.read_bytes())
        except SyntaxError as error:
            raise UsageError(
                f"{layout.relative(path)}:{error.lineno}: {error.msg}; {NOTHING_WRITTEN}"
            ) from None
        except (OSError, ValueError) as error:
            raise UsageError(f"{layout.relative(path)}: {error}; {NOTHING_WRITTEN}") from None


def project_above(folder: Path) -> Path:
    """Return the project's folder: this one, or the nearest above it with tests or a build file.

    So ``mutabot init`` works in any folder of a project.
    """
    if any(_is_test_side(path.relative_to(folder)) for path in _python_files(folder)):
        return folder
    above = (parent for parent in folder.parents if any((parent / name).is_file() for name in _OF_PROJECTS))
    return next(above, folder)


def imported_modules(path: Path) -> set[str]:
    """Return the names of the modules that a file imports, and of what it imports from them."""
    names: set[str] = set()
    for node in ast.walk(parsed(path)):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            source = node.module or ""
            names.update([source, *(f"{source}.{alias.name}".strip(".") for alias in node.names)])
    return names - {""}


def parsed(path: Path) -> ast.Module:
    """Return a file's syntax tree; an empty one if it is not valid Python."""
    try:
        return ast.parse(path.read_bytes())
    except (OSError, SyntaxError, ValueError):
        return ast.Module([], [])


def _python_files(folder: Path) -> list[Path]:
    return [path for path in _walk(folder) if path.suffix == ".py"][:_MOST_FILES]


def _walk(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or path.name in _SKIPPED or (path / "pyvenv.cfg").exists():
            continue
        if path.is_dir() and not path.is_symlink():
            yield from _walk(path)
        elif path.is_file():
            yield path


def _is_test_side(path: Path) -> bool:
    in_folder = any(_holds_tests(part) for part in path.parts[:-1])
    stem = path.stem
    return in_folder or stem.startswith("test_") or stem.endswith(("_test", "_tests")) or stem in _TEST_FILES


def _doubles(code: Sequence[Path], root: Path) -> list[Path]:
    """Return files that stand in for a device, by their names, and that no code but the tests imports.

    What a package only hands on to its users is not used by it.
    """
    named = [path for path in code if _DOUBLES & set(words_of(path.stem))]
    using = [path for path in code if path not in named and path.name != "__init__.py"]
    used = _Modules(code, root).reached(using)
    return [path for path in named if path not in used]


def _holds_tests(folder: str) -> bool:
    """Return whether a folder of this name holds tests: ``tests``, ``sys_test``, ``unit-tests``."""
    return folder in _TEST_FOLDERS or re.search(r"[_-]tests?$", folder) is not None


def _named(root: Path, given: Sequence[Path]) -> list[Path]:
    places = _places(root, given)
    found = [file for place in places for file in (_python_files(place) if place.is_dir() else [place])]
    return list(dict.fromkeys(found))


def _places(root: Path, given: Sequence[Path]) -> list[Path]:
    found: list[Path] = []
    for path in given:
        place = next((candidate for candidate in (path, root / path) if candidate.exists()), None)
        if place is None:
            raise UsageError(f"{path}: there is no such file or folder")
        if not place.resolve().is_relative_to(root):
            raise UsageError(f"{path} does not lie in {root}; -C names the project's folder")
        found.append(place.resolve())
    return found


def _guess_program(code: Sequence[Path], tests: Sequence[Path], root: Path) -> list[Path]:
    """Return files that no other file of the program imports; those with telling names, or that command.

    Only those that the tests reach, where they import any: what no test runs has no mutants to judge.
    """
    modules = _Modules([*code, *tests], root)
    reached = modules.reached(tests)
    candidates = [path for path in code if path.name not in _NO_PROGRAMS]
    code = [path for path in candidates if path in reached] or candidates
    used = {path: modules.reached([path], through="__init__.py") - {path} for path in code}
    below = set().union(*used.values())
    commanding = {path for path in code if _calls_methods(path)}
    using = [path for path in code if path in commanding or imported_modules(path)]
    free = [path for path in using if path not in below] or using or list(code)
    named = [path for path in free if _names_a_program(path.stem)]
    busy = [path for path in free if used[path]]
    return named or busy or [path for path in free if path in commanding] or free


def _calls_methods(path: Path) -> bool:
    """Return whether a file calls methods of objects, as of a robot that it is given or holds.

    Those of built-in types, of modules and of ``self`` do not count: a driver calls them as well.
    """
    tree = parsed(path)
    imports = (node for node in ast.walk(tree) if isinstance(node, ast.Import))
    modules = {(alias.asname or alias.name).partition(".")[0] for node in imports for alias in node.names}
    owners = {
        ast.unparse(node.func.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)
        if node.func.attr not in _OF_BUILT_INS
    }
    names = {owner for owner in owners - {"self", "cls", "super()"} if re.match(r"[^\W\d]", owner)}
    return any(re.split(r"\W", owner)[0] not in modules for owner in names)


def _names_a_program(stem: str) -> bool:
    return any(word.startswith(_PROGRAM_NAMES) for word in re.split(r"[^a-z]+", stem.lower()))


class _Modules:
    """Which of these files import which others."""

    def __init__(self, paths: Sequence[Path], root: Path) -> None:
        self._files: dict[str, list[tuple[str, Path]]] = {}
        for path in paths:
            parts = path.relative_to(root).with_suffix("").parts
            names = parts[:-1] if parts[-1] == "__init__" else parts
            if names:
                self._files.setdefault(names[-1], []).append((f".{'.'.join(names)}", path))

    def reached(self, starts: Sequence[Path], through: str = "") -> set[Path]:
        """Return the files that these import, also by way of others.

        Args:
            starts: files to begin with.
            through: name of the files whose imports are followed; empty for all.
        """
        found: set[Path] = set()
        left = list(starts)
        while left:
            new = self._imported(left.pop()) - found
            found |= new
            left += [path for path in new if not through or path.name == through]
        return found

    def _imported(self, path: Path) -> set[Path]:
        names = (*imported_modules(path), *_files_named(path))
        return {
            file
            for name in names
            for module, file in self._files.get(name.rpartition(".")[2], ())
            if module.endswith(f".{name}")
        }


def _files_named(path: Path) -> Iterator[str]:
    """Yield the modules of Python files that a file names in a text, as it does to run them."""
    for node in ast.walk(parsed(path)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.endswith(".py"):
            yield node.value.removesuffix(".py").lstrip("./").replace("/", ".")


def _arguments(root: Path, tests: Sequence[Path]) -> list[str]:
    """Return the outermost test folder of each test file, or the file itself if its folder has others."""
    found = []
    for path in tests:
        parts = path.relative_to(root).parts
        folder = next((index for index, part in enumerate(parts[:-1]) if _holds_tests(part)), None)
        if folder is not None:
            found.append("/".join(parts[: folder + 1]))
        elif path.stem != "conftest":
            found.append("/".join(parts))
    return list(dict.fromkeys(found))


def compared_with(layout: Layout) -> list[list[Any]]:
    """Return lists of constants with which the program and its tests compare the same thing."""
    groups: dict[str, list[Any]] = {}
    for path in (*layout.program, *layout.tests):
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.Compare):
                constants = [value for comparator in node.comparators for value in _constants(comparator)]
                groups.setdefault(ast.unparse(node.left), []).extend(constants)
    return [list(dict.fromkeys(group)) for group in groups.values() if group]


def with_compared(values: Sequence[Any], groups: Iterable[Sequence[Any]]) -> list[Any]:
    """Return observed values, and those with which the program compares the same thing."""
    found = list(values)
    for group in groups:
        if any(isinstance(value, str) and value in group for value in values):
            found += [value for value in group if value not in found]
    return found


def _constants(node: ast.expr) -> Iterator[Any]:
    parts = node.elts if isinstance(node, ast.Tuple | ast.List | ast.Set) else [node]
    for part in parts:
        if isinstance(part, ast.Constant) and isinstance(part.value, str | int | float):
            yield part.value
