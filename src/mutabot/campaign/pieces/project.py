"""The Python files of a project, taken apart: what the names in them stand for.

Also where lines of an old text stand in a new one.
"""

from __future__ import annotations

import ast
import re
import sys
import warnings
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import PurePosixPath

from .piece import Kind, Module, Piece, pure_classes, take_apart

#: what another file must not be taken for
_OUTSIDE = "outside "


@dataclass(slots=True)
class Project:
    """All Python files of a project.

    Attributes:
        digests: the files, with the digests of their content.
        texts: what stands in them.
        tests: those that hold tests.
    """

    digests: Mapping[str, str]
    texts: Mapping[str, bytes]
    tests: Collection[str]
    modules: dict[str, Module] = field(init=False, default_factory=dict)
    pieces: list[Piece] = field(init=False, default_factory=list)
    _paths: dict[str, list[str]] = field(init=False, default_factory=lambda: defaultdict(list))
    _resolved: dict[tuple[str, str], tuple[str, ...]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        trees: dict[str, ast.Module] = {}
        for file, text in self.texts.items():
            tree = _parsed(text)
            if tree is None:
                self.pieces.append(Piece(file, "", Kind.FILE, is_root=True, text=self.digests[file]))
            else:
                trees[file] = tree
            for name in _dotted_names(file):
                self._paths[name].append(file)
        found: dict[str, bool] = {}
        for tree in trees.values():
            for name, is_pure in pure_classes(tree):
                found[name] = found.get(name, True) and is_pure
        pure = {name for name, is_pure in found.items() if is_pure}
        for file, tree in trees.items():
            module = take_apart(file, tree, pure, is_test=file in self.tests)
            self.modules[file] = module
            self.pieces += module.pieces
        words = {word for piece in self.pieces for word in piece.mentions.words}
        handed = {
            target
            for piece in self.pieces
            for name in piece.mentions.bare
            for target in self._resolve(piece.file, name)
        }
        for module in self.modules.values():
            self.pieces += self._passed_on(module, words, handed)

    def digest(self, piece: Piece) -> str:
        """What a piece says."""
        return piece.digest(self._bindings(piece))

    @property
    def around(self) -> dict[str, str]:
        """What of the files concerns everybody, beyond what they say: where they lie, what they import."""
        present = {
            file: "there" for file in self.texts if PurePosixPath(file).name in ("conftest.py", "__init__.py")
        }
        outside = {
            target.removeprefix(_OUTSIDE).partition(".")[0]
            for module in self.modules.values()
            for name in module.modules
            for target in self._files_of(module.file, name) or [_OUTSIDE + name]
            if target.startswith(_OUTSIDE)
        }
        first = {PurePosixPath(file).parts[0].removesuffix(".py") for file in self.texts}
        hiding = sorted(first & sys.stdlib_module_names)
        found = {**present, "packages that are imported": ", ".join(sorted(outside - {""}))}
        starred = {
            file
            for module in self.modules.values()
            for star in module.stars
            for file in self._files_of(module.file, star)
        }
        for piece in self.pieces:  # nobody mentions it, and it decides what a star imports
            if piece.name == "__all__" and piece.file in starred:
                found[f"__all__ of {piece.file}"] = f"#{self.digest(piece)}"
        if hiding:
            found["files that hide modules of Python"] = ", ".join(hiding)
        loud = [piece for piece in self.pieces if piece.kind is Kind.MODULE]
        if len(loud) > 1:  # then the order may matter in which they are imported
            for module in self.modules.values():
                files = [file for name in module.modules for file in self._files_of(module.file, name)]
                if files:
                    found[f"imports of {module.file}"] = ", ".join(dict.fromkeys(files))
        return found

    def aliases(self) -> dict[str, set[str]]:
        """Names that imports give to what has another one."""
        found: dict[str, set[str]] = defaultdict(set)
        for module in self.modules.values():
            for bound, targets in module.imports.items():
                for target in targets:
                    name = target.rpartition(":")[2].rpartition(".")[2]
                    if name != bound:
                        found[bound].add(name)
        return found

    def _passed_on(self, module: Module, words: Collection[str], handed: Collection[str]) -> Iterator[Piece]:
        """Names that a module imports from others of the project and does not mention itself.

        They matter where the module itself is handed around, so that nobody knows who asks it for what.
        """
        path = PurePosixPath(module.file)
        called = path.parent.name if path.stem == "__init__" else path.stem
        if called not in words and module.file not in handed:
            return
        own = {name for piece in module.pieces for name in piece.mentions.names}
        for name in module.imports.keys() - own:
            targets = self._resolve(module.file, name)
            if any(not target.startswith(_OUTSIDE) for target in targets):
                yield Piece(module.file, name, Kind.PASSED, text="")

    def _bindings(self, piece: Piece) -> Iterator[tuple[str, tuple[str, ...]]]:
        if piece.kind is Kind.FILE:
            return
        if piece.kind is Kind.PASSED:
            yield piece.name, self._resolve(piece.file, piece.name)
            return
        for name in sorted(piece.mentions.names):
            targets = self._resolve(piece.file, name)
            if targets and targets != (f"{piece.file}:{piece.name}",):
                yield name, targets
        for dotted in sorted(piece.mentions.dotted):
            targets = self._attribute(piece.file, dotted)
            if targets:
                yield dotted, targets

    def _resolve(self, file: str, name: str) -> tuple[str, ...]:
        """What a name at the module level of a file stands for: ``file:name``, or a file; empty if none."""
        key = file, name
        if key not in self._resolved:
            self._resolved[key] = ()  # for whoever asks in a circle
            self._resolved[key] = tuple(dict.fromkeys(self._found(file, name)))
        return self._resolved[key]

    def _found(self, file: str, name: str) -> Iterator[str]:
        module = self.modules.get(file)
        if module is None:
            return
        if name in module.defined:
            yield f"{file}:{name}"
        for target in module.imports.get(name, ()):
            origin, separator, wanted = target.partition(":")
            files = self._files_of(file, origin)
            if not separator:
                yield from files or [_OUTSIDE + origin]
                continue
            submodules = self._files_of(file, f"{origin}.{wanted}" if origin.strip(".") else origin + wanted)
            yield from submodules
            for other in files:
                yield from self._resolve(other, wanted) or ([] if submodules else [f"{other}:{wanted}"])
            if not files and not submodules:
                yield _OUTSIDE + target
        if name not in module.defined and name not in module.imports:
            for star in module.stars:
                for other in self._files_of(file, star):
                    yield from self._resolve(other, name)

    def _attribute(self, file: str, dotted: str) -> tuple[str, ...]:
        """What an attribute of a module of the project stands for."""
        first, *others = dotted.split(".")
        here = self._resolve(file, first)
        for position, name in enumerate(others):
            files = [target for target in here if target in self.texts]
            if not files:
                return here if position else ()
            found = [target for one in files for target in self._resolve(one, name)]
            found += [
                other
                for one in files
                for other in self._files_of(one, "." + name)
                if one.endswith("__init__.py")
            ]
            here = tuple(dict.fromkeys(found))
        return here

    def _files_of(self, file: str, module: str) -> list[str]:
        """The files that a module may be, seen from a file."""
        level = len(module) - len(module.lstrip("."))
        name = module.lstrip(".")
        if not level:
            return self._paths.get(name, [])
        folder = PurePosixPath(file).parents[min(level, len(PurePosixPath(file).parents)) - 1]
        whole = ".".join([*folder.parts, *(name.split(".") if name else [])])
        return [
            one for one in self._paths.get(whole, []) if one.startswith(f"{folder}/") or str(folder) == "."
        ]


def _parsed(text: bytes) -> ast.Module | None:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None


def _dotted_names(file: str) -> Iterable[str]:
    """All names by which a file may be imported: which folders are on the path, nobody knows."""
    parts = list(PurePosixPath(file).with_suffix("").parts)
    if parts[-1] == "__init__":
        parts.pop()
    return [".".join(parts[first:]) for first in range(len(parts))]


#: a place as outcomes name it: ``file:line``, or ``file:line:column-line:column``
_PLACE = re.compile(r"(?<![\w./-])([\w./-]+\.py):(\d+)(?::(\d+)-(\d+):(\d+))?")
#: a line, or the first and last line and column of a node
Extent = tuple[int, ...]


class Lines:
    """From the lines of an old project to those of a new one.

    Args:
        old, new: the projects.
    """

    def __init__(self, old: Project, new: Project) -> None:
        self._old, self._new = old, new

    def moved(self, text: str) -> str | None:
        """The text with the places that it names as they are now; None if one of them is gone."""
        gone = False

        def place(match: re.Match[str]) -> str:
            nonlocal gone
            file = match[1]
            if file not in self._old.texts or self._new.digests.get(file) == self._old.digests[file]:
                return match[0]
            extent = tuple(int(part) for part in match.groups()[1:] if part is not None)
            found = self._map.get(file, {}).get(extent)
            gone = gone or found is None
            return match[0] if found is None else f"{file}:{_shown(found)}"

        text = _PLACE.sub(place, text)
        return None if gone else text

    @cached_property
    def _map(self) -> Mapping[str, Mapping[Extent, Extent | None]]:
        """By file, where each extent is now; None where that is not clear."""
        now = _by_name(self._new)
        found: dict[str, dict[Extent, Extent | None]] = defaultdict(dict)
        for (file, name), olds in _by_name(self._old).items():
            for old, new in zip(olds, now.get((file, name), ()), strict=False):
                if self._old.digest(old) != self._new.digest(new):
                    continue
                for was, is_now in _lines(old, new):
                    if found[file].setdefault(was, is_now) != is_now:
                        found[file][was] = None
        return found


def _by_name(project: Project) -> dict[tuple[str, str], list[Piece]]:
    found: dict[tuple[str, str], list[Piece]] = defaultdict(list)
    for piece in project.pieces:
        found[piece.file, piece.name].append(piece)
    return found


def _shown(extent: Extent) -> str:
    if len(extent) == 1:
        return str(extent[0])
    line, column, end_line, end_column = extent
    return f"{line}:{column}-{end_line}:{end_column}"


def _lines(old: Piece, new: Piece) -> set[tuple[Extent, Extent]]:
    """Lines and extents in two pieces that say the same."""
    return {pair for nodes in zip(old.nodes, new.nodes, strict=True) for pair in _extents(*nodes)}


def _extents(before: ast.AST, now: ast.AST) -> Iterator[tuple[Extent, Extent]]:
    """Lines and extents of all nodes of two trees that are alike."""
    for one, other in zip(ast.walk(before), ast.walk(now), strict=True):
        was, is_now = (_extent(node) for node in (one, other))
        if was is not None and is_now is not None:
            yield was, is_now
            yield was[:1], is_now[:1]
            yield was[2:3], is_now[2:3]


def _extent(node: ast.AST) -> Extent | None:
    line = getattr(node, "lineno", None)
    if line is None:
        return None
    end, column = getattr(node, "end_lineno", line), getattr(node, "end_col_offset", 0)
    return int(line), int(getattr(node, "col_offset", 0)), int(end), int(column)
