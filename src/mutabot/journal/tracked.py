"""A journal that came with the program text is refused.

What a journal says is believed: outcomes in it are taken over, and gates are decided by it. One that git
tracks was written by whoever wrote the commit, as by a stranger's pull request, which would judge itself.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from mutabot.errors import JournalError
from mutabot.repository import GitError, repository_of, tracked

from .files import HOME, previous_of
from .recordings import recordings_path

#: what SQLite keeps beside a file, and reads
_BESIDE = ("", "-wal", "-shm", "-journal")
#: as many links one after the other as Linux follows
_LINKS = 40


def refuse_tracked(journal: Path) -> None:
    """Raise JournalError if git tracks a journal, a file beside it that belongs to it, or a link on the way.

    Also if git cannot tell: then nobody knows where the journal comes from.
    """
    for path in _ways(Path(os.path.abspath(journal)), _LINKS):  # noqa: PTH100  # links stay links
        found = _tracked_at(path, journal)
        if found:
            raise JournalError(_why(journal, path.parent, found), path=str(journal))


def _tracked_at(path: Path, journal: Path) -> list[str]:
    """What git tracks of the files that belong to the journal at ``path``, relative to its folder."""
    folder = path.parent
    names = [HOME] if folder.name == HOME else []
    if names:
        folder = folder.parent
    else:
        files = (path, recordings_path(path), previous_of(path), recordings_path(previous_of(path)))
        names = [file.name + end for file in files for end in _BESIDE]
        names.append(f"{path.stem}-suggestions.json")
    if repository_of(folder) is None or not any(os.path.lexists(folder / name) for name in names):
        return []
    try:
        return tracked(folder, *names)
    except GitError as error:
        why = f"nobody can tell whether {journal} came with the repository; then it is not used: {error}"
        raise JournalError(why, path=str(journal)) from error


def _ways(path: Path, left: int) -> Iterator[Path]:
    """A path, and every link on the way to what it means, each in its real folder; at last where it leads."""
    place = Path(path.anchor)
    parts = path.parts[1:]
    for index, part in enumerate(parts):
        here = place / part
        if part == "..":
            place = place.parent
        elif here.is_symlink() and left:
            yield here
            yield from _ways(Path(place, here.readlink(), *parts[index + 1 :]), left - 1)
            return
        else:
            place = here
    yield place


def _why(journal: Path, folder: Path, names: list[str]) -> str:
    first = names[0]
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    option = "-r " if folder.name == HOME else ""
    what = HOME if option else first
    return (
        f"the journal {journal} is not used, since git tracks {first}{more}: whoever commits a journal "
        f"decides what it says. Take it out of the repository with `git rm --cached {option}{what}`, add "
        f"{HOME}/ to .gitignore, and keep journals for CI in a cache outside of the checkout"
    )
