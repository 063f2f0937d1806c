"""Applies a patch to the files of a project, or finds out why it makes no mutant."""

from __future__ import annotations

import ast
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from .applying import HunkExtent, apply
from .diffs import FileDiff, PatchError, read_diff


@dataclass(frozen=True, slots=True)
class ChangedFile:
    """A file before and after a patch.

    Attributes:
        path: in the project, with forward slashes.
        before: its content; None if the patch adds it.
        after: its content then.
        extents: where the hunks stand in what it held before.
    """

    path: str
    before: bytes | None
    after: bytes
    extents: tuple[HunkExtent, ...]


@dataclass(frozen=True, slots=True)
class Patch:
    """A patch that applies.

    Attributes:
        title: what it says of itself; may be empty.
        files: what it makes of files.
        notes: hunks that stand elsewhere than it says.
    """

    title: str
    files: tuple[ChangedFile, ...]
    notes: tuple[str, ...]


def read_patch(content: bytes, root: Path, is_of_suite: Callable[[str], bool]) -> Patch:
    """Read a patch and apply it to the files of a project, in memory.

    Args:
        content: the unified diff.
        root: the project's folder.
        is_of_suite: whether a file, by its path in the project, belongs to the tests.

    Raises PatchError, which says why it makes no mutant.
    """
    diff = read_diff(content)
    if not diff.files:
        raise PatchError("it has no hunk, so that it changes nothing" if content.strip() else "it is empty")
    changed, notes = dict[str, ChangedFile](), list[str]()
    for file_diff in diff.files:
        path = _path_in(root, file_diff)
        if is_of_suite(path):
            raise PatchError(f"{path} belongs to the tests, and a patch to these is no mutant of the program")
        if path in changed:
            raise PatchError(f"it changes {path} twice: join the hunks below one header")
        file, more_notes = _changed(root, path, file_diff)
        changed[path] = file
        notes += more_notes
    _check(changed.values())
    return Patch(diff.title, tuple(changed.values()), tuple(notes))


def _path_in(root: Path, diff: FileDiff) -> str:
    """Return the path in the project: without the first folder, which git adds, or as it is written."""
    names = [name for name in (diff.old, diff.new) if name]
    candidates = [part for name in names for part in (name.partition("/")[2], name) if part]
    path = next((name for name in candidates if _is_file(root, name)), candidates[0] if candidates else "")
    if not path or Path(path).is_absolute() or not _is_below(root, path):
        raise PatchError(f"{path or diff.path} is not a file of the project")
    return os.path.normpath(path).replace(os.sep, "/")


def _is_file(root: Path, name: str) -> bool:
    return not Path(name).is_absolute() and (root / name).is_file()


def _is_below(root: Path, name: str) -> bool:
    return (root / name).resolve().is_relative_to(root.resolve())


def _changed(root: Path, path: str, diff: FileDiff) -> tuple[ChangedFile, Sequence[str]]:
    if diff.other:
        raise PatchError(f"{path} {diff.other}: only lines of files can be changed")
    if diff.new is None:
        raise PatchError(f"it deletes {path}: a mutant changes what files hold, and takes none away")
    if not diff.hunks:
        raise PatchError(f"no line of {path} changes, at most its mode")
    file = root / path
    if diff.old is None:
        if file.exists():
            raise PatchError(f"it adds {path}, which is there")
        return ChangedFile(path, None, apply(b"", diff.hunks, path).content, ((1, 0, 1, 0),)), ()
    if not file.is_file():
        raise PatchError(f"hunk {diff.hunks[0].number} does not apply: there is no file {path}")
    before = file.read_bytes()
    made = apply(before, diff.hunks, path)
    return ChangedFile(path, before, made.content, made.extents), made.notes


def _check(files: Iterable[ChangedFile]) -> None:
    """Refuse files that are no valid program, or the same program."""
    is_same = [_is_same_program(file) for file in files]  # each is looked at: any may be no Python
    if all(is_same):
        raise PatchError("it changes nothing but comments and layout")


def _is_same_program(file: ChangedFile) -> bool:
    """Return whether a Python file differs only in comments and layout. Raises PatchError if invalid."""
    if not file.path.endswith(".py"):
        return file.before == file.after
    try:
        after = ast.parse(file.after)
    except (SyntaxError, ValueError) as error:
        line = f", line {error.lineno}" if isinstance(error, SyntaxError) and error.lineno else ""
        raise PatchError(f"{file.path} would no longer be valid Python: {error.args[0]}{line}") from None
    if file.before is None:
        return False
    try:
        return ast.dump(ast.parse(file.before)) == ast.dump(after)
    except (SyntaxError, ValueError):
        return False
