"""The available languages of robot programs: Python, and those of packages."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cache
from typing import TYPE_CHECKING

from mutabot.extensions import brought
from mutabot.languages.python import FRONT_END

if TYPE_CHECKING:
    from pathlib import Path

    from mutabot.languages.front_end import FrontEnd
    from mutabot.model.source_units import TextUnit


@cache
def _by_language() -> Mapping[str, FrontEnd]:
    """Return the front ends by the names of their languages, in the order in which they are tried."""
    return {**{name: part.load() for name, part in brought("languages").items()}, "python": FRONT_END}


@cache
def front_ends() -> tuple[FrontEnd, ...]:
    """Return all front ends; Python is last, since an interpreter's frames are Python's as well.

    Raises ExtensionError for one of a package that cannot be loaded.
    """
    return tuple(_by_language().values())


def language_of(file: str) -> str | None:
    """Return the name of a file's language, by its suffix; None for unknown suffixes.

    Raises ExtensionError for a language of a package that cannot be loaded.
    """
    name = file.lower()
    return next((key for key, found in _by_language().items() if name.endswith(found.suffixes)), None)


@cache
def languages_of(root: Path, program: tuple[str, ...]) -> frozenset[str]:
    """Return the names of a program's languages beside Python.

    Raises ExtensionError for a language of a package that cannot be loaded.
    """
    found = {language_of(file) for file in program_files(root, program)}
    return frozenset(name for name in found if name is not None and name != "python")


def front_end_of(file: str) -> FrontEnd:
    """Return the front end for a file, by its suffix; Python's for unknown suffixes."""
    return _by_language()[language_of(file) or "python"]


def highlighting_of(file: str) -> tuple[str, str]:
    """Return what reports mark in a file, as ``FrontEnd`` says; empty if its language says nothing."""
    return getattr(_by_language().get(language_of(file) or ""), "highlighting", ("", ""))


def unit_parser(file: str) -> Callable[[bytes], Mapping[str, TextUnit]] | None:
    """Return the function that finds the units of a file, see ``FrontEnd``; None for Python or if none."""
    return getattr(_by_language().get(language_of(file) or ""), "units", None)


def program_files(root: Path, program: Iterable[str]) -> list[str]:
    """Return the program's files among the configured files and folders, relative to ``root``, each once."""
    suffixes = tuple(suffix for front_end in front_ends() for suffix in front_end.suffixes)
    files: dict[str, None] = {}
    for name in program:
        path = root / name
        found = (
            [file for file in path.rglob("*") if file.name.lower().endswith(suffixes)]
            if path.is_dir()
            else [path]
        )
        files |= dict.fromkeys(file.relative_to(root).as_posix() for file in sorted(found))
    return list(files)
