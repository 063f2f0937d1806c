"""The project on its way to workers: a tar of the files that are sent, named by what they hold."""

from __future__ import annotations

import hashlib
import io
import os
import stat
import tarfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from .shipping import Shipment

#: bytes of a bundle that go with one message
CHUNK = 4 << 20


@dataclass(frozen=True, slots=True)
class Bundle:
    """The files of a project.

    Attributes:
        digest: what they hold, in short.
        inner: the project's folder in it.
        data: the tar.
        files: how many files it has.
        outside: files, relative to the project, that are not in it: links that lead out of the project, and
            files behind such links.
    """

    digest: str
    inner: str
    data: bytes
    files: int
    outside: tuple[str, ...]

    @classmethod
    def make(cls, shipment: Shipment) -> Bundle:
        """Pack what is to be sent."""
        base = shipment.top.parent
        digest = hashlib.blake2b(digest_size=12)
        buffer = io.BytesIO()
        count, outside = 0, []
        with tarfile.open(fileobj=buffer, mode="w:gz", compresslevel=1) as tar:
            for folder in shipment.folders:
                info = tarfile.TarInfo(folder.relative_to(base).as_posix())
                info.type, info.mode = tarfile.DIRTYPE, 0o755
                digest.update(os.fsencode(info.name) + b"\0folder\0")
                tar.addfile(info)
            for path in shipment.files:
                packed = _packed(path, shipment)
                if packed is None:
                    outside.append(Path(os.path.relpath(path, shipment.root)).as_posix())
                    continue
                info, content = packed
                info.name = path.relative_to(base).as_posix()
                about = f"\0{info.mode:o}\0{info.type!r}\0{info.linkname}\0{len(content)}\0"
                digest.update(os.fsencode(info.name) + os.fsencode(about) + content)
                tar.addfile(info, io.BytesIO(content))
                count += 1
        inner = PurePosixPath(shipment.root.relative_to(base)).as_posix()
        return cls(digest.hexdigest(), inner, buffer.getvalue(), count, tuple(outside))

    def chunks(self) -> list[bytes]:
        """The tar in parts that messages can carry."""
        return [self.data[start : start + CHUNK] for start in range(0, len(self.data), CHUNK)]


def _packed(path: Path, shipment: Shipment) -> tuple[tarfile.TarInfo, bytes] | None:
    """The entry of a file or a link, and what it holds; None for what leads out of the project."""
    info = tarfile.TarInfo()
    if path.is_symlink():
        target = _target(path, shipment.root if path.is_relative_to(shipment.root) else shipment.top)
        if target is None:
            return None
        info.type, info.linkname, info.mode = tarfile.SYMTYPE, target, 0o777
        return info, b""
    content = None
    with suppress(OSError), open(_opened(path), "rb") as file:
        # what was opened counts, not what the path says meanwhile: no folder on the way may be a link
        status = os.fstat(file.fileno())
        if stat.S_ISREG(status.st_mode) and Path(f"/proc/self/fd/{file.fileno()}").readlink() == path:
            content = file.read()
            info.mode, info.mtime = 0o644 | (status.st_mode & 0o111), int(status.st_mtime)
            info.size = len(content)
    return (info, content) if content is not None else None


def _opened(path: Path) -> int:
    return os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC)


def _target(link: Path, limit: Path) -> str | None:
    """What a link leads to in the end, relative to it; None if that is outside, or cannot be told."""
    try:
        folder, target = link.parent.resolve(), link.resolve()
    except (OSError, RuntimeError):
        return None  # it leads back to itself
    if folder != link.parent or not target.is_relative_to(limit):
        return None
    return os.path.relpath(target, folder)
