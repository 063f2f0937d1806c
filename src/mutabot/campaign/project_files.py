"""The files of a project."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Self

from mutabot.errors import UsageError
from mutabot.journal.files import HOME, REPORT_MARK
from mutabot.repository import GitError, repository_of, tracked, unignored

if TYPE_CHECKING:
    from mutabot.config.configuration import Configuration

#: folders without anything that a test imports or reads; hidden ones are left out as well
_FOLDERS = {"__pycache__", "node_modules", "site-packages"}
#: how names of folders and files end that no test imports or reads
UNREAD = (".pyc", ".pyo", ".swp", "~", ".egg-info", ".dist-info")
#: files that make a folder a virtual environment, or a report of mutabot
_MARKS = ("pyvenv.cfg", REPORT_MARK)
#: files, in the project and above it, by which pytest finds its bearings
_OF_PYTEST = ("pyproject.toml", "pytest.ini", ".pytest.ini", "tox.ini", "setup.cfg", "conftest.py")
#: what Python makes by itself
_MADE = (".pyc", ".pyo")


@dataclass(frozen=True)
class ProjectListing:
    """The files of a project; names are relative to its folder, and mutabot's own folder is in none.

    Attributes:
        root: the project's folder.
        files: every file and link, but those in hidden folders, virtual environments and caches.
        folders: every folder likewise.
        tracked: the files and links that are there of those that git tracks, also hidden ones and those of
            submodules. Empty without a repository.
        unignored: Python files that git neither tracks nor ignores.
        named: files that the configuration consists of or names, and those by which pytest is configured.
        programs: folders that the configuration names as program, oracle or tests.
        above: absolute paths of files above the project by which pytest is configured; in a repository those
            that git tracks.
    """

    root: Path
    files: tuple[str, ...]
    folders: tuple[str, ...]
    tracked: tuple[str, ...]
    unignored: tuple[str, ...]
    named: tuple[str, ...]
    programs: tuple[str, ...]
    above: tuple[Path, ...]

    @classmethod
    def of(cls, root: Path, configuration: Configuration | None = None) -> Self:
        """List the files of the project in this folder. Raises UsageError where git cannot list them."""
        try:
            repository = repository_of(root)
            known = tracked(root) if repository is not None else []
            more = unignored(root) if known else []
            above = tuple(_above(root, repository if known else None))
        except GitError as error:
            raise UsageError(f"the files that git tracks cannot be listed: {error}") from error
        inside = dict(_walk(root))
        given = [*_named(configuration)] if configuration is not None else []
        there = [name for name in given if _is_path(root, name)]
        return cls(
            root,
            tuple(name for names in inside.values() for name in names),
            tuple(inside),
            tuple(name for name in known if _is_ours(name) and _is_file(root, name)),
            tuple(name for name in more if _is_ours(name) and name.endswith(".py")),
            tuple(name for name in (*there, *_OF_PYTEST) if _is_ours(name) and _is_file(root, name)),
            tuple(name for name in there if (root / name).is_dir()),
            above,
        )


def python_files(root: Path) -> list[str]:
    """Return the Python files of the project, relative to its folder."""
    return [name for _, names in _walk(root) for name in names if name.endswith(".py")]


def _named(configuration: Configuration) -> Iterator[str]:
    """Yield the files and folders that the configuration names, and options that may be either."""
    yield from (*configuration.program, *configuration.oracle)
    yield from (argument.partition("::")[0] for argument in configuration.tests)
    yield from (option.partition("=")[2] or option for option in configuration.pytest_args)
    yield from (*configuration.vocabulary, configuration.file)


def _is_path(root: Path, name: str) -> bool:
    """Return whether a text names something in the project."""
    if not name or "\0" in name or name.startswith(("-", "/", "~")) or ".." in PurePosixPath(name).parts:
        return False
    try:
        return os.path.lexists(root / name)
    except OSError:
        return False  # too long for a name


def _is_ours(name: str) -> bool:
    return PurePosixPath(name).parts[:1] != (HOME,)


def _is_file(root: Path, name: str) -> bool:
    """Return whether this is a file or a link; git also lists folders that are repositories of their own."""
    path = root / name
    return path.is_symlink() or path.is_file()


def _walk(root: Path) -> Iterator[tuple[str, list[str]]]:
    """Yield the folders of the project with the files and links in each."""
    for folder, folders, names in os.walk(root):
        here = Path(folder)
        links = {name for name in folders if (here / name).is_symlink()}
        folders[:] = sorted(
            name for name in folders if name not in links and is_folder_of_project(here / name)
        )
        inner = here.relative_to(root).as_posix()
        start = "" if inner == "." else f"{inner}/"
        yield inner, [f"{start}{name}" for name in sorted([*names, *links]) if not name.endswith(_MADE)]


def is_folder_of_project(folder: Path) -> bool:
    """Return whether a folder may hold what a test imports or reads."""
    return is_name_of_project(folder.name) and not any((folder / mark).exists() for mark in _MARKS)


def is_name_of_project(name: str) -> bool:
    """Return whether a file or folder may be the project's, by its name alone."""
    return not (name.startswith(".") or name in _FOLDERS or name.endswith(UNREAD))


def _above(root: Path, repository: Path | None) -> Iterator[Path]:
    """Yield pytest's configuration files in folders above the project; in a repository only tracked files."""
    for folder in root.parents[:-1] if repository != root else ():
        there = [folder / name for name in _OF_PYTEST if (folder / name).is_file()]
        if there and repository is not None:
            known = set(tracked(folder, *(path.name for path in there)))
            there = [path for path in there if path.name in known]
        yield from there
        if folder == repository:
            break
