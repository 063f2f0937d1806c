"""Which files of a project outcomes depend on.

All that tests could import or read, as far as anybody can tell. Of texts and logs, which people and tools
leave everywhere, only those that something has to do with.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Set
from pathlib import Path, PurePosixPath

from mutabot.campaign.request import Request

#: stands for the content of data that the unmutated tests write: results, not causes
WRITTEN = "written by the tests themselves"
#: names of what people and tools leave in a folder; any other file counts by its mere presence
_NOTES = {
    ".bak", ".diff", ".dot", ".err", ".gif", ".htm", ".html", ".log", ".md", ".mp4", ".orig", ".out",
    ".patch", ".pdf", ".pid", ".prof", ".rst", ".svg", ".tex", ".tmp", ".txt", ".webm",
}  # fmt: skip
#: files that may name others, and bytes beyond which they are data
_MAY_NAME, _LONGEST = re.compile(r".*\.(py|toml|cfg|ini|json|ya?ml|xml|urdf|xacro|feature|txt)"), 1 << 20
#: how our own JSON begins, and reports of tests and their coverage
_REPORTS = {
    ".json": re.compile(rb'\{\s*"format": \d+,\s*"'),
    ".xml": re.compile(rb".{0,200}<(testsuites?|coverage)\b", re.DOTALL),
}


def counted(
    request: Request, digests: Mapping[str, str], written: Set[str], opened: Set[str] | None
) -> dict[str, str]:
    """The files that outcomes depend on, with their digests.

    Those that the configuration itself consists of count by what they say. A note (``_NOTES``) counts if the
    baseline opened it or one like it beside it, or if another file names it: a mutant might read it.

    Args:
        digests: all files of the project.
        written: those that the baseline touched.
        opened: those that anybody opened meanwhile; None if that is not known.
    """
    own = own_files(request)
    others = {
        name: digest
        for name, digest in digests.items()
        if name not in own and not _is_report(request.root / name)
    }
    ignored = _ignored(request.root, others, opened) if opened is not None else set()
    found = {}
    for name, digest in others.items():
        if name not in ignored:
            is_result = name in written and not name.endswith(".py")
            found[name] = WRITTEN if is_result else digest
    return found


def is_note(name: str) -> bool:
    """Whether a file is of the kind that people and tools leave everywhere."""
    return PurePosixPath(name).suffix.lower() in _NOTES


def own_files(request: Request) -> set[str]:
    """The files that the configuration consists of; they count by what they say."""
    configuration = request.configuration
    named = (configuration.selection or "", *configuration.vocabulary)
    own = {configuration.file, "pyproject.toml", *(PurePosixPath(name).as_posix() for name in named)}
    lists = [Path(word[1:]) for word in (*request.only, *request.skip) if word.startswith("@")]
    own |= {_relative(file, request.root) for file in lists}
    if request.other_journal is not None:
        name = _relative(request.other_journal, request.root)
        own |= {name, f"{name}-wal", f"{name}-shm", f"{name}.lock"}
    return own


def _ignored(root: Path, names: Iterable[str], opened: Set[str]) -> set[str]:
    """Notes that nothing has to do with."""
    names = list(names)
    alike = {_kind(name) for name in opened}
    notes = {
        name
        for name in names
        if is_note(name)
        and _kind(name) not in alike
        and not (root / name).is_symlink()  # it is opened elsewhere
    }
    if not notes:
        return notes
    for text in _texts(root, (name for name in names if name not in notes)):
        notes = {name for name in notes if not _is_named(PurePosixPath(name), text)}
    return notes


def _kind(name: str) -> tuple[str, str]:
    path = PurePosixPath(name)
    return path.parent.as_posix(), path.suffix.lower()


def _texts(root: Path, names: Iterable[str]) -> Iterator[bytes]:
    for name in names:
        if not _MAY_NAME.fullmatch(name):
            continue
        try:
            path = root / name
            if path.stat().st_size <= _LONGEST:
                yield path.read_bytes()
        except OSError:
            continue


def _is_named(note: PurePosixPath, text: bytes) -> bool:
    """Whether a text holds the name of a file, or what comes before the suffix, in quotes."""
    stem = os.fsencode(note.stem)
    return os.fsencode(note.name) in text or any(quote + stem + quote in text for quote in (b"'", b'"'))


def _relative(path: Path, root: Path) -> str:
    return Path(os.path.relpath(path.resolve(), root)).as_posix()


def _is_report(path: Path) -> bool:
    """Whether it is our own JSON or a report on tests, which no robot program reads."""
    if path.suffix not in _REPORTS:
        return False
    try:
        with path.open("rb") as file:
            return _REPORTS[path.suffix].match(file.read(1000)) is not None
    except OSError:
        return False
