"""The project on its way to workers: a tar of the files that outcomes depend on, named by what they hold."""

from __future__ import annotations

import hashlib
import io
import os
import tarfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from mutabot.campaign.reuse.snapshot import Snapshot, _is_folder_of_project

#: files above a project by which pytest finds its bearings
_ABOVE = ("pyproject.toml", "pytest.ini", ".pytest.ini", "tox.ini", "setup.cfg", "conftest.py")
#: bytes of a bundle that go with one message
CHUNK = 4 << 20


@dataclass(frozen=True, slots=True)
class Bundle:
    """The files of a project.

    Attributes:
        digest: what they hold, in short.
        inner: the project's folder in it.
        data: the tar.
    """

    digest: str
    inner: str
    data: bytes

    @classmethod
    def make(cls, root: Path) -> Bundle:
        """Pack the project; of the folders above it, what tells pytest how to run."""
        top = _top(root)
        digest = hashlib.blake2b(digest_size=12)
        buffer = io.BytesIO()
        with tarfile.open(fileobj=buffer, mode="w:gz", compresslevel=1, dereference=True) as tar:
            for path, content in _content(root, top):
                name = path.relative_to(top.parent).as_posix()
                mode = path.stat().st_mode & 0o111
                digest.update(f"{name}\0{mode}\0{content}\n".encode())
                tar.add(path, name, recursive=False)
        inner = PurePosixPath(root.relative_to(top.parent)).as_posix()
        return cls(digest.hexdigest(), inner, buffer.getvalue())

    def chunks(self) -> list[bytes]:
        """The tar in parts that messages can carry."""
        return [self.data[start : start + CHUNK] for start in range(0, len(self.data), CHUNK)]


def _top(root: Path) -> Path:
    """The highest folder, from the project's own up, with a file that counts."""
    found = [folder for folder in root.parents if any((folder / name).is_file() for name in _ABOVE)]
    return found[-1] if found and found[-1] != found[-1].parent else root


def _content(root: Path, top: Path) -> Iterator[tuple[Path, str]]:
    """All paths to pack, with what tells of their content."""
    for name, file in sorted(Snapshot.take(root).files.items()):
        yield root / name, file.digest
    for folder in _empty_folders(root):
        yield folder, "folder"
    for folder in root.parents if top != root else ():
        for path in (folder / name for name in _ABOVE):
            if path.is_file():
                yield path, hashlib.blake2b(path.read_bytes(), digest_size=12).hexdigest()
        if folder == top:
            return


def _empty_folders(root: Path) -> Iterator[Path]:
    """Folders without files, which tests may write to."""
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(name for name in folders if _is_folder_of_project(Path(folder, name)))
        if not names and not folders and Path(folder) != root:
            yield Path(folder)
