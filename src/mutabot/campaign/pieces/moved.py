"""Moved: files, functions and classes that have another place or name now, found by what they say."""

from __future__ import annotations

import ast
import copy
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from pathlib import PurePosixPath

from .piece import Kind, Piece
from .project import Project
from .renaming import Renaming

#: the share of its pieces that a renamed file must still hold
_ALIKE = 0.5


def renaming_between(old: Project, new: Project) -> Renaming:
    """How things of the new state were called in the old one. Only what is unique is taken for the same."""
    files = _files(old, new)
    functions = _functions(old, new, files)
    words = {PurePosixPath(now).stem: PurePosixPath(was).stem for now, was in files.items()}
    words |= {_last(now): _last(was) for now, was in functions.items()}
    return Renaming(files, functions, _safe(words, old, new))


def _files(old: Project, new: Project) -> dict[str, str]:
    gone, come = old.texts.keys() - new.texts.keys(), new.texts.keys() - old.texts.keys()
    said = {file: _said_in(old, file) for file in gone}
    found: dict[str, list[str]] = {}
    for file in come:
        here = _said_in(new, file)
        found[file] = [
            other
            for other, those in said.items()
            if old.texts[other] == new.texts[file]
            or (here & those).total() > _ALIKE * max(here.total(), those.total())
        ]
    return _unique(found)


def _said_in(project: Project, file: str) -> Counter[str]:
    return Counter(_bare(piece) for piece in project.pieces if piece.file == file)


def _functions(old: Project, new: Project, files: Mapping[str, str]) -> dict[str, str]:
    """Functions and classes that were called otherwise, or stood in another file."""
    renaming = Renaming(files)
    before = {f"{piece.file}:{piece.name}": piece for piece in old.pieces if _may_move(piece)}
    now = {f"{piece.file}:{piece.name}": piece for piece in new.pieces if _may_move(piece)}
    known = {renaming.target(name) for name in now}
    gone = {name: piece for name, piece in before.items() if name not in known}
    come = {name: piece for name, piece in now.items() if renaming.target(name) not in before}
    by_text: dict[tuple[str, str], list[str]] = defaultdict(list)
    for name, piece in gone.items():
        by_text[piece.kind, _nameless(piece)].append(name)
    found = {}
    for name, piece in come.items():
        alike = by_text.get((piece.kind, _nameless(piece)), [])
        same_name = [other for other in alike if _last(other) == _last(name)]
        found[name] = same_name if same_name else alike
    unique = _unique(found)
    return {name: was for name, was in unique.items() if not _goes_with(name, was, unique)}


def _may_move(piece: Piece) -> bool:
    return piece.kind in (Kind.FUNCTION, Kind.CLASS)


def _goes_with(name: str, was: str, functions: Mapping[str, str]) -> bool:
    """Whether a method only goes where its class goes."""
    owner, _, last = name.rpartition(".")
    return bool(owner) and functions.get(owner) == was.removesuffix(f".{last}") and was.endswith(f".{last}")


def _unique(found: Mapping[str, list[str]]) -> dict[str, str]:
    """Those that fit one only, which fits them only."""
    counts = Counter(one for alike in found.values() for one in set(alike))
    return {name: alike[0] for name, alike in found.items() if len(alike) == 1 and counts[alike[0]] == 1}


def _safe(words: Mapping[str, str], old: Project, new: Project) -> dict[str, str]:
    """Words that can be read as others without being taken for what else is called so."""
    mentioned_old, mentioned_new = _words(old.pieces), _words(new.pieces)
    return {
        now: was
        for now, was in words.items()
        if now != was and now not in mentioned_old and was not in mentioned_new
    }


def _words(pieces: Iterable[Piece]) -> set[str]:
    return {name for piece in pieces for name in (piece.last, *piece.mentions.names)}


def _bare(piece: Piece) -> str:
    return piece.text or repr([ast.dump(node) for node in piece.nodes])


def _nameless(piece: Piece) -> str:
    return repr([ast.dump(_without_name(node)) for node in piece.nodes])


def _without_name(node: ast.AST) -> ast.AST:
    if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        return node
    bare = copy.copy(node)
    bare.name = ""
    return bare


def _last(name: str) -> str:
    return name.rpartition(":")[2].rpartition(".")[2]
