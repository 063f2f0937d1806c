"""Modules as text: what they define and what they import, without importing them."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from importlib.machinery import PathFinder
from pathlib import Path

from mutabot.errors import ConfigurationError

Function = ast.FunctionDef | ast.AsyncFunctionDef
#: folders that hold no code of the project
_SKIPPED = frozenset({"node_modules", "build", "dist", "site-packages", "venv", "env", "__pycache__"})
_MOST_FILES = 1000


@dataclass(frozen=True, eq=False)
class Module:
    """A module as text.

    Attributes:
        name: dotted name.
        path: its file.
        tree: its syntax tree.
        definitions: functions and classes at its top level.
        imports: local name to (module, name in it); the name is empty for a module.
    """

    name: str
    path: Path
    tree: ast.Module
    definitions: dict[str, Function | ast.ClassDef] = field(default_factory=dict)
    imports: dict[str, tuple[str, str]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Definition:
    """A function, method or class.

    Attributes:
        module: where it is defined.
        qualname: its name there.
        node: its text.
        owner: the class of a method, else None.
    """

    module: Module
    qualname: str
    node: Function | ast.ClassDef
    owner: Definition | None = None

    @property
    def target(self) -> str:
        """As vocabularies name it."""
        return f"{self.module.name}:{self.qualname}"


class Sources:
    """The modules that a project's code can import, read when they are asked for."""

    def __init__(self, roots: Sequence[Path]) -> None:
        self.roots = list(dict.fromkeys(root.resolve() for root in roots))
        self._modules: dict[str, Module | None] = {}

    def module(self, name: str) -> Module | None:
        """The module with this name, or None if there is no text of it."""
        if name not in self._modules:
            path = self._path(name)
            self._modules[name] = _parse(name, path) if path is not None else None
        return self._modules[name]

    def at(self, path: Path) -> Module:
        """The module in this file. Raises ConfigurationError if it is no Python."""
        name = self._name(path.resolve())
        module = self.module(name)
        if module is None or module.path.resolve() != path.resolve():
            module = _parse(name, path)
        if module is None:
            raise ConfigurationError("it is not a Python file that can be read", file=str(path))
        return module

    def lookup(self, module: Module, name: str, *, depth: int = 8) -> Definition | Module | None:
        """What a name means at the top level of a module, followed through imports."""
        if name in module.definitions:
            return Definition(module, name, module.definitions[name])
        if name not in module.imports or depth == 0:
            return None
        source, inner = module.imports[name]
        if not inner:
            return self.module(source)
        other = self.module(source)
        found = self.lookup(other, inner, depth=depth - 1) if other is not None else None
        return found or self.module(f"{source}.{inner}")

    def is_local(self, module: Module) -> bool:
        """Whether a module belongs to the project rather than to an installed package."""
        path = module.path.resolve()
        return any(path.is_relative_to(root) for root in self.roots) and not _SKIPPED & set(path.parts)

    def _name(self, path: Path) -> str:
        homes = [root for root in self.roots if path.is_relative_to(root)]
        home = max(homes, key=lambda root: len(root.parts), default=path.parent)
        parts = path.relative_to(home).with_suffix("").parts
        return ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts)

    def _path(self, name: str) -> Path | None:
        top, *rest = name.split(".")
        if top in sys.stdlib_module_names:
            return None
        for root in self.roots:
            path = _file_of(root.joinpath(top), rest)
            if path is not None:
                return path
        spec = PathFinder.find_spec(top)
        if spec is None or spec.origin is None or not spec.origin.endswith(".py"):
            return None
        origin = Path(spec.origin)
        return _file_of(origin.parent if origin.name == "__init__.py" else origin.with_suffix(""), rest)


def python_files(folder: Path) -> list[Path]:
    """The Python files of a project, without hidden and generated folders."""
    return list(_walk(folder))[:_MOST_FILES]


def _walk(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or path.name in _SKIPPED or (path / "pyvenv.cfg").exists():
            continue
        if path.is_dir() and not path.is_symlink():
            yield from _walk(path)
        elif path.suffix == ".py":
            yield path


def _file_of(start: Path, rest: Sequence[str]) -> Path | None:
    base = start.joinpath(*rest)
    for path in (base.with_name(base.name + ".py"), base / "__init__.py"):
        if path.is_file():
            return path
    return None


def _parse(name: str, path: Path) -> Module | None:
    try:
        tree = ast.parse(path.read_bytes())
    except (OSError, SyntaxError, ValueError):
        return None
    module = Module(name, path, tree)
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for item in node.names:
                local = item.asname or item.name.partition(".")[0]
                module.imports[local] = (item.name if item.asname else local, "")
        elif isinstance(node, ast.ImportFrom):
            source = _absolute(node, package)
            for item in node.names:
                module.imports[item.asname or item.name] = (source, item.name)
    for statement in tree.body:
        if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            module.definitions[statement.name] = statement
    return module


def _absolute(node: ast.ImportFrom, package: str) -> str:
    if not node.level:
        return node.module or ""
    parts = package.split(".") if package else []
    kept = parts[: len(parts) - node.level + 1]
    return ".".join([*kept, *([node.module] if node.module else [])])
