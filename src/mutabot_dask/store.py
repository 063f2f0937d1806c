"""Bundles on a worker's machine: each unpacked once, by whichever worker there comes first.

Who uses one holds a lock on it, which the system takes back when that process dies. What nobody holds is
removed by the next to come, and by the last to leave.
"""

from __future__ import annotations

import fcntl
import io
import os
import shutil
import tarfile
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_LOCK = ".lock"


class Store:
    """The bundles in a folder of ours.

    Args:
        folder: where they are; made if it is not there.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if folder.stat().st_uid != os.getuid():
            raise PermissionError(f"{folder} belongs to somebody else")
        self._held: dict[str, int] = {}
        self._parts: dict[str, dict[int, bytes]] = {}

    def place(self, digest: str) -> Path:
        """Where a bundle is."""
        return self._folder / digest

    def has(self, digest: str) -> bool:
        """Whether a bundle is there; from now on this process uses it."""
        self.hold(digest)
        return self.place(digest).is_dir()

    def hold(self, digest: str) -> None:
        """Use a bundle, and no other any more."""
        for other in set(self._held) - {digest}:
            self.leave(other)
        if digest not in self._held:
            self._held[digest] = _shared(self._folder / (digest + _LOCK))
        self._sweep()

    def leave(self, digest: str) -> None:
        """Use a bundle no longer."""
        descriptor = self._held.pop(digest, None)
        if descriptor is not None:
            os.close(descriptor)
        self._sweep()

    def take(self, digest: str, index: int, count: int, part: bytes) -> None:
        """Take a part of a bundle, and unpack it with the last one."""
        parts = self._parts.setdefault(digest, {})
        parts[index] = part
        if len(parts) < count:
            return
        del self._parts[digest]
        data = b"".join(parts[number] for number in range(count))
        made = Path(tempfile.mkdtemp(prefix="new-", dir=self._folder))
        try:
            with tarfile.open(fileobj=io.BytesIO(data), mode="r:gz") as tar:
                tar.extractall(made, filter="data")
            made.rename(self.place(digest))
        except OSError:
            if not self.place(digest).is_dir():  # another worker of this machine was first
                raise
        finally:
            shutil.rmtree(made, ignore_errors=True)

    def _sweep(self) -> None:
        """Remove bundles that nobody uses."""
        for lock in self._folder.glob("*" + _LOCK):
            digest = lock.name.removesuffix(_LOCK)
            if digest not in self._held:
                with _alone(lock) as is_alone:
                    if is_alone:
                        shutil.rmtree(self.place(digest), ignore_errors=True)
                        lock.unlink(missing_ok=True)


def _shared(lock: Path) -> int:
    """A descriptor that holds a lock with others; of the file that is there, not of one just removed."""
    while True:
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        fcntl.flock(descriptor, fcntl.LOCK_SH)
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(descriptor), lock.stat()):
                return descriptor
        os.close(descriptor)


@contextmanager
def _alone(lock: Path) -> Iterator[bool]:
    """Whether nobody else holds a lock, which is held meanwhile."""
    try:
        descriptor = os.open(lock, os.O_RDWR | os.O_CLOEXEC)
    except OSError:
        yield False
        return
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            yield False
        else:
            yield True
    finally:
        os.close(descriptor)
