"""The bundle of a project for workers: a tar of the files sent, named by a hash of its contents.

Also descriptions of what goes to workers and what stays here.
"""

from __future__ import annotations

import hashlib
import io
import os
import stat
import tarfile
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

from .environment import decided
from .shipping import Shipment

if TYPE_CHECKING:
    from mutabot.api.processes import Request


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
        """Pack the files that are sent."""
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
        """Return the tar in parts that messages can carry."""
        return [self.data[start : start + CHUNK] for start in range(0, len(self.data), CHUNK)]


def _packed(path: Path, shipment: Shipment) -> tuple[tarfile.TarInfo, bytes] | None:
    """Return the tar entry of a file or link, and its content; None for one that leads out of the project."""
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
    """Return the final target of a link, relative to it; None if it is outside or cannot be resolved."""
    try:
        folder, target = link.parent.resolve(), link.resolve()
    except (OSError, RuntimeError):
        return None  # it leads back to itself
    if folder != link.parent or not target.is_relative_to(limit):
        return None
    return os.path.relpath(target, folder)


#: names that a sentence shows
_SHOWN = 8
_ADVICE = "`git add` what workers need, or name it under `cluster.files`"


def summary(bundle: Bundle) -> str:
    """Return a summary of how much is sent."""
    return f"{_files(bundle.files)}, {len(bundle.data) / 1000:.0f} kB"


def warnings(shipment: Shipment, bundle: Bundle) -> Iterator[str]:
    """Yield warnings for the user before anything is sent."""
    if shipment.left_out:
        why = (
            "that git does not track"
            if shipment.is_tracked
            else "(there is no repository of git to say more)"
        )
        verb = "stays" if len(shipment.left_out) == 1 else "stay"
        yield f"{_files(len(shipment.left_out))} {why} {verb} on this machine: {listed(shipment.left_out)}"
    if bundle.outside:
        yield f"not sent, since it leads out of the project or cannot be read: {listed(bundle.outside)}"
    if shipment.suspicious:
        why = "git tracks it, or `cluster.files` names it"
        yield f"sent though it is named like a secret, since {why}: {listed(shipment.suspicious)}"


@dataclass(frozen=True, slots=True)
class BundlePreview:
    """The preview of what workers will be sent; see ``Preview`` of the core."""

    shipment: Shipment

    @classmethod
    def of(cls, request: Request) -> BundlePreview:
        """Make the bundle of a project. Raises UsageError if git cannot list its files."""
        return cls(Shipment.of(request))

    @property
    def folders_left_out(self) -> set[str]:
        """The folders with files that are not sent; see ``Preview``."""
        return self.shipment.folders_left_out

    def lacking(self, opened: Collection[str] | None) -> str | None:
        """Return which opened files are not sent; see ``Preview``."""
        missed = self.shipment.missed(opened or ())
        return f"tests open files that workers will not have: {listed(missed)}; {_ADVICE}" if missed else None

    def check(self, opened: Collection[str] | None) -> tuple[list[str], Mapping[str, Any]]:
        """Return what ``mutabot check`` says of the bundle; see ``Preview``."""
        shipment = self.shipment
        bundle = Bundle.make(shipment)
        variables = sorted(decided())
        missed = self.lacking(opened)
        lines = [
            f"workers are sent {summary(bundle)}",
            f"and the variables {', '.join(variables)}",
            *warnings(shipment, bundle),
            *([missed] if missed is not None else []),
        ]
        names = {
            "files": [os.path.relpath(path, shipment.root) for path in shipment.files],
            "left_out": shipment.left_out,
            "outside": bundle.outside,
            "secret_names": shipment.suspicious,
            "opened_but_left_out": shipment.missed(opened or ()),
        }
        data = {key: [_printable(name) for name in value] for key, value in names.items()}
        lines = [f"cluster   {text}" for text in lines]
        return lines, {**data, "bytes": len(bundle.data), "variables": variables}


def listed(names: Collection[str]) -> str:
    """Return a few names, and the number of others."""
    shown = [_printable(name) for name in list(names)[:_SHOWN]]
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(shown) + more


def _files(count: int) -> str:
    return "1 file" if count == 1 else f"{count} files"


def _printable(name: str) -> str:
    text = os.fsencode(name).decode("utf-8", "backslashreplace")
    return text if text.isprintable() else ascii(text)[1:-1]
