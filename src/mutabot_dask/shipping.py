"""Selects the project's files that are sent to workers: those tracked by git, and those configured.

Nothing else leaves this machine, since a project's folder also holds what is not to be given away: keys,
passwords, the robot's own addresses. Where there is no repository, it is unknown what may be given away;
then it is program text and the kinds of files that robots are described in, without hidden ones and those
named like secrets.
"""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from .settings import ClusterTable

if TYPE_CHECKING:
    from mutabot.api.processes import Request

#: what is sent of a project that lies in no repository
_KINDS = {
    ".py", ".pyi", ".feature", ".urdf", ".xacro", ".srdf", ".sdf", ".mjcf", ".xml", ".stl", ".obj", ".dae",
    ".msg", ".srv", ".action", ".launch", ".rviz", ".sh", ".png", ".jpg", ".npy", ".npz", ".csv",
}  # fmt: skip


@dataclass(frozen=True)
class Shipment:
    """The files that are sent to workers.

    Attributes:
        root: the project's folder.
        top: the highest folder with a file that goes along; the project's own, or one above it.
        files: paths of files and links, below ``top``.
        folders: folders without any of these, which tests may write to.
        left_out: files of the project, relative to it, that stay here.
        is_tracked: whether git says what the project consists of.
    """

    root: Path
    top: Path
    files: tuple[Path, ...]
    folders: tuple[Path, ...]
    left_out: tuple[str, ...]
    is_tracked: bool

    @classmethod
    def of(cls, request: Request) -> Shipment:
        """Return the files to send for a project. Raises UsageError if git cannot list its tracked files."""
        listing, root = request.files(), request.root
        chosen = {*listing.tracked, *listing.named}
        if listing.tracked:
            chosen.update(name for name in listing.unignored if _is_below(name, listing.programs))
        else:
            chosen.update(name for name in listing.files if _is_usual(name))
        patterns = ClusterTable.of(request.configuration.tables.get("cluster")).files
        chosen.update(_further(root, listing.files, patterns))
        home = request.journal_path.parent.relative_to(root).as_posix()
        chosen = {name for name in chosen if not _is_below(name, [home])}
        holding = {parent.as_posix() for name in chosen for parent in PurePosixPath(name).parents}
        return cls(
            root,
            min((path.parent for path in listing.above), key=lambda path: len(path.parts), default=root),
            tuple(sorted([*(root / name for name in chosen), *listing.above])),
            tuple(root / name for name in listing.folders if name not in holding and name != "."),
            tuple(sorted({*listing.files} - chosen)),
            bool(listing.tracked),
        )

    @cached_property
    def suspicious(self) -> tuple[str, ...]:
        """The files to send whose names look like secrets, relative to the project."""
        names = (Path(os.path.relpath(path, self.root)).as_posix() for path in self.files)
        return tuple(name for name in names if may_be_secret(name))

    @property
    def folders_left_out(self) -> set[str]:
        """The folders with files that are not sent, relative to the project."""
        return {PurePosixPath(name).parent.as_posix() for name in self.left_out}

    def missed(self, opened: Iterable[str]) -> list[str]:
        """Return the files that tests open but that are not sent."""
        return sorted(set(self.left_out) & set(opened))


def _further(root: Path, files: Collection[str], patterns: Iterable[str]) -> Iterator[str]:
    """Yield the files that patterns name, and the targets of those that are links within the project."""
    for pattern in patterns:
        for path in [root / pattern] if os.path.lexists(root / pattern) else sorted(root.glob(pattern)):
            yield from _files_of(root, files, path)
            if path.is_symlink() and path.resolve().is_relative_to(root):
                yield from _files_of(root, files, path.resolve())


def _files_of(root: Path, files: Collection[str], path: Path) -> Iterator[str]:
    """Yield a file or link, or all files below a folder, except hidden ones and those named like secrets.

    ``files``: those of the project. A hidden folder, which has none of them, goes where it is named.
    """
    name = path.relative_to(root).as_posix()
    if path.is_symlink() or not path.is_dir():
        yield name
        return
    found = [listed_file for listed_file in files if _is_below(listed_file, [name])]
    for file in found or (
        below.relative_to(root).as_posix() for below in path.rglob("*") if not below.is_dir()
    ):
        inner = PurePosixPath(file).relative_to(name).as_posix()
        if not _is_hidden(inner) and not may_be_secret(inner):
            yield file


def _is_usual(name: str) -> bool:
    """Return whether a file's kind is usual for robot descriptions, and it is not hidden or like a secret."""
    return PurePosixPath(name).suffix.lower() in _KINDS and not _is_hidden(name) and not may_be_secret(name)


def _is_hidden(name: str) -> bool:
    return any(part.startswith(".") for part in PurePosixPath(name).parts)


def _is_below(name: str, folders: Iterable[str]) -> bool:
    path = PurePosixPath(name)
    return any(path.is_relative_to(folder) for folder in folders)


_NAMES = re.compile(
    r"""
      (\.env|\.envrc)(\..*)? | .*\.env
    | [._]netrc | \.(pypirc|npmrc|yarnrc|pgpass|htpasswd|git-credentials|my\.cnf|s3cfg|boto|dockercfg)
    | id_(rsa|dsa|ecdsa|ed25519)(_sk)? | .*\.(pem|key|p12|pfx|jks|keystore|kdbx|ppk|asc|gpg|ovpn)
    | \.?(secrets?|credentials?|passwords?|passwd)([._-].*)?
    | .*[._-](secrets?|credentials?|passwords?)(\..*)?
    | service[_-]?account.*\.json | rootkey\.csv | kubeconfig
    """,
    re.VERBOSE | re.IGNORECASE,
)
#: folders in which tools keep what lets them in
_FOLDERS = {".ssh", ".aws", ".gnupg", ".kube", ".azure", ".gcloud", ".docker", ".config"}
#: what is meant to be filled in
_SAMPLES = re.compile(r".*\.(example|sample|template|dist|pub)", re.IGNORECASE)


def may_be_secret(name: str) -> bool:
    """Return whether a file's name, relative to the project, suggests that it contains secrets."""
    *folders, last = PurePosixPath(name).parts
    if _SAMPLES.fullmatch(last):
        return False
    return bool(_NAMES.fullmatch(last)) or not _FOLDERS.isdisjoint(folders)
