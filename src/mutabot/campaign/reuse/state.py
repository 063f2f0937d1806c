"""A state of a project's files: what lies there, which of it counts, and what the Python files say."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from mutabot.campaign.pieces.mentions import names_in
from mutabot.campaign.request import Request

from .snapshot import Snapshot

#: files that may name what is to be called, and bytes beyond which they are data
_MAY_NAME, _LONGEST = re.compile(r".*\.(toml|cfg|ini|json|ya?ml|xml|launch|xacro|urdf|feature)"), 1 << 20
_ENTRY = re.compile(r"[\w.]+:[\w.]+")


@dataclass(frozen=True, slots=True)
class State:
    """The files of a project that count, at one moment.

    Attributes:
        files: all of them, with digests of their content.
        texts: what stands in the Python files.
        names: names that other files mention.
    """

    files: Mapping[str, str]
    texts: Mapping[str, bytes]
    names: frozenset[str] = frozenset()

    @classmethod
    def now(cls, request: Request, before: Snapshot, after: Snapshot, opened: Set[str] | None) -> State:
        """The state after the baseline.

        Args:
            before, after: the files before and after the baseline.
            opened: the files that were opened meanwhile; None if that is not known.
        """
        digests = {name: file.digest for name, file in after.files.items()}
        files = counted(request, digests, after.touched_since(before), opened)
        found = {name: read(request.root / name) for name in files if name.endswith(".py")}
        texts = {name: text for name, text in found.items() if text is not None}
        return cls(files, texts, named(request.root, files))


def named(root: Path, files: Mapping[str, str]) -> frozenset[str]:
    """The names that files beside the program text mention: by them, libraries may find what to call."""
    found: set[str] = set()
    for name in files:
        text = read(root / name) if _MAY_NAME.fullmatch(name) else None
        if text is not None and len(text) <= _LONGEST:
            found |= names_in(text.decode("utf-8", "replace"))
    for name in ("pyproject.toml", "setup.cfg"):
        text = read(root / name)
        if text is not None:
            for entry in _ENTRY.findall(text.decode("utf-8", "replace")):
                found |= names_in(entry)
    return frozenset(found)


def read(path: Path) -> bytes | None:
    """What a file holds; None if it cannot be read."""
    try:
        return path.read_bytes()
    except OSError:
        return None


#: stands for the content of data that the unmutated tests write: results, not causes
WRITTEN = "written by the tests themselves"
#: names of what people and tools leave in a folder; any other file counts by its mere presence
_NOTES = {
    ".bak", ".diff", ".dot", ".err", ".gif", ".htm", ".html", ".log", ".md", ".mp4", ".orig", ".out",
    ".patch", ".pdf", ".pid", ".prof", ".rst", ".svg", ".tex", ".tmp", ".txt", ".webm",
}  # fmt: skip
#: files that may name others, and bytes beyond which they are data
_MAY_NAME_FILES, _LONGEST = (
    re.compile(r".*\.(py|toml|cfg|ini|json|ya?ml|xml|urdf|xacro|feature|txt)"),
    1 << 20,
)
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
        if not _MAY_NAME_FILES.fullmatch(name):
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
