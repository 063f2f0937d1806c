"""Separate a forked process from its parent: open files, output, random state, and private files.

A process with private files, and all that it starts, sees the project as it is on disk, and its own changes.

The process enters a mount namespace of its own and lays an overlay over each folder: what it writes, renames
or deletes there goes into a layer that no other process sees. An ordinary user needs a user namespace for
that, which some systems and most containers refuse. Mount flags: <linux/mount.h>; clone flags:
<linux/sched.h>.
"""

from __future__ import annotations

import fcntl
import os
import re
import shutil
import stat
import tempfile
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import lru_cache

from mutabot.model.event_file import FOLDER, FORKS
from mutabot.model.files import real_open
from mutabot.runtime.isolation.forkable import descriptors, own_event_loops
from mutabot.runtime.isolation.namespaces import asks_for_id, call, keeps_ids
from mutabot.runtime.paths import is_below

_CLONE_NEWNS, _CLONE_NEWUSER = 0x00020000, 0x10000000
_MS_BIND, _MS_REC, _MS_PRIVATE = 4096, 16384, 1 << 18
_NO_MOUNTS = "this system allows no private mounts"
_SHARED_MEMORY = "/dev/shm"
#: where a process keeps what it prints, in its home
LOG = "log.txt"
#: the layers of a process lie in its own folder; of folders in memory, and of those that hardly any process
#: writes to, in a file system in memory that ends with the process, since to make them on a disk takes longer
_LAYERS, _IN_MEMORY, _UPPER = "files", "memory", "upper"
#: attributes that an overlay gives to a file of its upper layer, and that hold for no copy of it
_OF_THE_LAYER = (".overlay.origin", ".overlay.uuid", ".overlay.impure", ".overlay.nlink")


def private_folders(root: str) -> tuple[str, ...]:
    """Return the folders that become private: the project, temporary files, and shared memory."""
    return _private_folders(root, tempfile.gettempdir())


@lru_cache(maxsize=8)  # each fork asks several times
def _private_folders(root: str, temporary: str) -> tuple[str, ...]:
    folders = [os.path.realpath(root), os.path.realpath(temporary)]
    if os.path.isdir(_SHARED_MEMORY):
        folders.append(os.path.realpath(_SHARED_MEMORY))
    outer = [
        folder for folder in folders if any(is_below(other, folder) for other in folders if other != folder)
    ]
    return tuple(dict.fromkeys([*outer, *folders]))


@dataclass(slots=True)
class PrivateFiles:
    """The private files of a process.

    Args:
        root: absolute path of the project.
        home: the process's own folder, in one of the campaign's in that of mutabot, which is private as well.

    Attributes:
        why_not: why its files are not private; None if they are.
    """

    root: str
    home: str
    why_not: str | None = "private_files is switched off"
    _own: str = ""
    _is_privileged: bool = False
    _below: list[str] | None = None
    _bare: int = -1

    def __post_init__(self) -> None:
        self._own = self.home

    def make(self) -> str | None:
        """Make files private in this process.

        Returns why that is not possible, and nothing but the namespace has changed then; None if
        it is done.
        """
        place, self.why_not = os.getcwd(), None
        try:
            self._is_privileged = _enter_namespace()
            _mount("none", "/", None, _MS_REC | _MS_PRIVATE)
            # forks begin where nothing is covered: to uncover it again takes as long as to cover it
            self._bare = os.open("/proc/self/ns/mnt", os.O_RDONLY | os.O_CLOEXEC)
            call("unshare", _CLONE_NEWNS, what=_NO_MOUNTS)
            self._mount_overlays()
        except OSError as error:
            if self._bare >= 0:
                self._go_back()
                os.chdir(place)
            self.why_not = f"{error.strerror or error}"
        else:
            with suppress(OSError):  # the same folder, but seen through its new layers
                os.chdir(place)
        return self.why_not

    def forbids_fork(self) -> str | None:
        """Return why open files or missing namespaces forbid a fork right now; None if they do not."""
        if self.why_not is not None:
            return f"its files are not private: {self.why_not}"
        folders = private_folders(self.root)
        for path, mode in _written():
            if is_below(path, self.home):
                continue
            if mode == os.O_RDWR:  # a database knows which file it has opened, and a fork has another one
                return f"{path} is open for reading and writing"
            if not any(is_below(path, folder) for folder in folders):
                return f"{path} is open for writing"
        if not keeps_ids() and (file := asks_for_id(self.root)) is not None:
            return f"{file} asks for the process id, and a fork of an ordinary user has one of its own"
        return None

    def change(self, path: str, content: bytes) -> None:
        """Change a file of the project, given by its path there, for this process and its children.

        Raises OSError if these files are not private, or the file is none of the project's.
        """
        file = os.path.realpath(os.path.join(self.root, path))
        if self.why_not is not None:
            raise PermissionError(f"{path} cannot be changed, as its files are not private: {self.why_not}")
        if not is_below(file, self.root):
            raise PermissionError(f"{path} cannot be changed: it is not a file of the project")
        before = os.stat(file).st_mtime if os.path.exists(file) else 0.0
        with real_open(file, "wb") as opened:
            opened.write(content)
        # Python takes bytecode for that of a text if it has its size, and its time in seconds
        after = max(os.stat(file).st_mtime, before + 2.0)
        os.utime(file, (after, after))

    def enter(self, name: str) -> str:
        """Separate a process that was just forked from its parent, which waits.

        ``name`` is unlike that of any other fork. Returns the folder of the process. Raises OSError if it
        cannot be kept apart.
        """
        folder, log = os.path.join(self.home, FORKS, name), os.stat(os.path.join(self.home, LOG))
        processes = os.path.join(folder, FOLDER)
        os.makedirs(processes)
        self.continue_separately(folder)
        # by the name that its environment has: whatever it starts finds its own folder, and not the parent's
        _mount(processes, os.path.join(self.home, FOLDER), None, _MS_BIND)
        isolate_files(log)  # what leads to the parent's log leads nowhere
        own_event_loops()
        return folder

    def _go_back(self) -> None:
        """Return to the mounts without overlays; the working folder is the root then."""
        call("setns", self._bare, _CLONE_NEWNS, what="there is no way back to the files on disk")

    def continue_separately(self, folder: str) -> None:
        """Continue with private files in a process that was just forked, while its parent waits.

        What the parent did to its files is copied. ``folder`` lies in the home, which both have. Raises
        OSError if that is not possible.
        """
        place = os.getcwd()
        for layers in (os.path.join(self._own, name) for name in (_LAYERS, _IN_MEMORY)):
            for number in os.listdir(layers) if os.path.isdir(layers) else ():
                upper = os.path.join(layers, number, _UPPER)
                if os.listdir(upper):
                    copied = os.path.join(folder, _LAYERS, number)
                    os.makedirs(copied)
                    _copy(upper, os.path.join(copied, _UPPER), {})
        self._go_back()
        call("unshare", _CLONE_NEWNS, what=_NO_MOUNTS)
        if keeps_ids():
            _mount("proc", "/proc", None, 0, kind="proc")  # that of its process namespace
        self._own = folder
        self._mount_overlays()
        os.chdir(place)

    def _mount_overlays(self) -> None:
        """Mount an overlay over each private folder."""
        folders = (*private_folders(self.root), os.path.dirname(os.path.dirname(self.home)))
        if self._below is None:  # the same in all forks, and the list is long
            self._below = _mounts_below(folders)
        below = self._below
        numbers = [n for n, folder in enumerate(folders) if not _is_part(folder, folders, below)]
        in_memory = self._has_memory()
        with _opened([*folders, self.home, self._own]) as opened:
            *lowers, home, own = opened
            with _opened(below) as kept:
                again = [*zip(below, kept, strict=True), (self.home, home)]
                for number in numbers:
                    folder, lower = folders[number], lowers[number]
                    is_memory = in_memory and folder == os.path.realpath(_SHARED_MEMORY)
                    _mount_overlay(folder, lower, _layers(own, number, in_memory=is_memory))
                    # what is mounted in it comes back before the next folder, which may lie in such a one
                    for inner, descriptor in again:
                        if inner != folder and is_below(inner, folder):
                            _mount(_path(descriptor), inner, None, _MS_BIND | _MS_REC)

    def _has_memory(self) -> bool:
        """Mount a file system in memory in the process's folder. Return whether it can hold layers."""
        if not self._is_privileged:  # many kernels keep no attributes there for ordinary users
            return False
        folder = os.path.join(self._own, _IN_MEMORY)
        os.makedirs(folder, exist_ok=True)
        try:
            _mount("tmpfs", folder, "mode=700", 0, kind="tmpfs")
        except OSError:
            return False
        return True


def may_be_private() -> bool:
    """Return whether this system allows private files, by trying it in a child."""
    pid = os.fork()
    if pid == 0:
        try:
            _enter_namespace()
            os._exit(0)
        finally:
            os._exit(1)
    return os.waitpid(pid, 0)[1] == 0


def _copy(source: str, target: str, links: dict[tuple[int, int], str]) -> None:
    """Copy the upper layer of an overlay, with deletions, owners, times and rights.

    ``links`` takes files that have several names, by device and inode.
    """
    status = os.lstat(source)
    identity = (status.st_dev, status.st_ino)
    if identity in links:
        os.link(links[identity], target, follow_symlinks=False)
        return
    if stat.S_ISDIR(status.st_mode):
        os.mkdir(target)
        with os.scandir(source) as entries:
            for entry in entries:
                _copy(entry.path, f"{target}/{entry.name}", links)
    elif stat.S_ISLNK(status.st_mode):
        os.symlink(os.readlink(source), target)
    elif stat.S_ISREG(status.st_mode):
        with real_open(source, "rb") as old, real_open(target, "wb") as new:
            shutil.copyfileobj(old, new)
    elif stat.S_ISCHR(status.st_mode) or stat.S_ISFIFO(status.st_mode):  # what was deleted is such a device
        os.mknod(target, status.st_mode, status.st_rdev)
    else:  # a socket without a peer
        return
    if status.st_nlink > 1 and not stat.S_ISDIR(status.st_mode):
        links[identity] = target
    _copy_status(source, target, status)


def _copy_status(source: str, target: str, status: os.stat_result) -> None:
    if os.geteuid() == 0:
        with suppress(PermissionError, OSError):
            os.chown(target, status.st_uid, status.st_gid, follow_symlinks=False)
    if stat.S_ISLNK(status.st_mode):
        return
    if not stat.S_ISCHR(status.st_mode):
        for name in os.listxattr(source):
            if not name.endswith(_OF_THE_LAYER):
                with suppress(OSError):
                    os.setxattr(target, name, os.getxattr(source, name))
        os.chmod(target, stat.S_IMODE(status.st_mode))
    os.utime(target, ns=(status.st_atime_ns, status.st_mtime_ns))


def _enter_namespace() -> bool:
    """Enter a mount namespace. Return whether that needed no user namespace."""
    user, group = os.geteuid(), os.getegid()
    try:
        call("unshare", _CLONE_NEWNS)
    except OSError:
        call("unshare", _CLONE_NEWNS | _CLONE_NEWUSER, what=_NO_MOUNTS)
    else:
        return True
    for name, text in (
        ("setgroups", "deny"),
        ("uid_map", f"{user} {user} 1"),
        ("gid_map", f"{group} {group} 1"),
    ):
        with real_open(f"/proc/self/{name}", "w", encoding="ascii") as file:
            file.write(text)
    return False


def _is_part(folder: str, folders: Collection[str], mounted: list[str]) -> bool:
    """Return whether the overlay over another folder covers this one."""
    between = [point for point in mounted if is_below(folder, point)]
    return any(
        is_below(folder, other) and not any(point != other and is_below(point, other) for point in between)
        for other in folders
        if other != folder
    )


def _layers(own: int, number: int, *, in_memory: bool) -> str:
    """Return the path of the layers of a folder; those copied from the parent are on disk."""
    on_disk = f"{_path(own)}/{_LAYERS}/{number}"
    return f"{_path(own)}/{_IN_MEMORY}/{number}" if in_memory and not os.path.isdir(on_disk) else on_disk


def _mount_overlay(folder: str, lower: int, layers: str) -> None:
    """Mount an overlay with these layers over a folder."""
    os.makedirs(f"{layers}/work")
    with suppress(FileExistsError):  # it was copied
        os.mkdir(f"{layers}/{_UPPER}")
    status = os.fstat(lower)
    os.chmod(f"{layers}/upper", status.st_mode & 0o7777)
    with _opened([f"{layers}/upper", f"{layers}/work"]) as (upper, work):
        options = f"lowerdir={_path(lower)},upperdir={_path(upper)},workdir={_path(work)}"
        try:
            _mount("overlay", folder, options + ",redirect_dir=on", 0, kind="overlay")
        except OSError:  # without privileges, folders that were there cannot be renamed
            _mount("overlay", folder, options + ",userxattr", 0, kind="overlay")


def _mounts_below(folders: Collection[str]) -> list[str]:
    """Return the mount points below these folders, outermost first, as an overlay would hide them."""
    with real_open("/proc/self/mountinfo", "rb") as file:
        points = [mount_point(line) for line in file]
    found = dict.fromkeys(
        point
        for point in sorted(points)
        if any(point != folder and is_below(point, folder) for folder in folders)
    )
    return list(found)


def mount_point(line: bytes) -> str:
    """Return the mount point in a line of ``/proc/self/mountinfo``, in which some bytes are octal."""
    field = line.split(b" ")[4]
    return os.fsdecode(re.sub(rb"\\([0-7]{3})", lambda match: bytes([int(match[1], 8)]), field))


@contextmanager
def _opened(paths: list[str]) -> Iterator[list[int]]:
    """Open descriptors of these folders, which stay valid when something is mounted over them."""
    descriptors: list[int] = []
    try:
        descriptors.extend(os.open(path, os.O_PATH | os.O_CLOEXEC) for path in paths)
        yield descriptors
    finally:
        for descriptor in descriptors:
            os.close(descriptor)


def _path(descriptor: int) -> str:
    return f"/proc/self/fd/{descriptor}"


def _mount(source: str, target: str, options: str | None, flags: int, kind: str = "") -> None:
    paths, data = (os.fsencode(source), os.fsencode(target)), options.encode() if options else None
    call("mount", *paths, kind.encode() or None, flags, data, what=f"{target} cannot be covered")


_CHUNK = 1 << 16
#: device, inode, position and flags of an open file: descriptors that agree in them share one opening
_Shared = tuple[int, int, int, int]


def _written() -> Iterator[tuple[str, int]]:
    """Yield the paths of named files that are open for writing, and how they are open."""
    for descriptor, status in descriptors():
        is_named = stat.S_ISREG(status.st_mode) and status.st_nlink > 0
        mode = fcntl.fcntl(descriptor, fcntl.F_GETFL) & os.O_ACCMODE
        if is_named and mode != os.O_RDONLY:
            yield os.readlink(f"/proc/self/fd/{descriptor}"), mode


def isolate_files(log: os.stat_result, instead: int | None = None) -> None:
    """Give open files positions of their own, in a process that was just forked.

    An open file has one position for parent and child; the child opens its own. Of a deleted temporary file,
    such as those that pytest captures output in, it makes a copy. What leads to the parent's log leads
    elsewhere.

    Args:
        log: the parent's log.
        instead: descriptor of the child's own log; None for nowhere.
    """
    found = list(descriptors())  # before any is opened here
    nowhere = os.open(os.devnull, os.O_WRONLY)
    copies: dict[_Shared, int] = {}
    for descriptor, status in found:
        if os.path.samestat(status, log):
            target = nowhere if instead is None else instead
            os.dup2(target, descriptor, inheritable=os.get_inheritable(descriptor))
        elif stat.S_ISREG(status.st_mode):
            _renew(descriptor, status, copies)
    for descriptor in (nowhere, *copies.values()):
        os.close(descriptor)


def _renew(descriptor: int, status: os.stat_result, copies: dict[_Shared, int]) -> None:
    """Replace a descriptor by a new opening of the same file, with a position of its own."""
    try:
        position = os.lseek(descriptor, 0, os.SEEK_CUR)
    except OSError:  # a namespace, which has no positions
        return
    flags = fcntl.fcntl(descriptor, fcntl.F_GETFL)
    shared = (status.st_dev, status.st_ino, position, flags)
    if shared not in copies:
        is_deleted = status.st_nlink == 0
        if is_deleted and flags & os.O_ACCMODE == os.O_RDONLY:
            return
        opened = _in_memory(descriptor, position) if is_deleted else _reopened(descriptor, position, flags)
        if opened is None:
            return
        copies[shared] = opened
    os.dup2(copies[shared], descriptor, inheritable=os.get_inheritable(descriptor))


def _reopened(descriptor: int, position: int, flags: int) -> int | None:
    """Open a file a second time; return None if it is mutabot's own, in a folder hidden from tests."""
    path = os.readlink(f"/proc/self/fd/{descriptor}")
    try:
        opened = os.open(path, flags & ~(os.O_CREAT | os.O_EXCL | os.O_TRUNC) | os.O_CLOEXEC)
    except FileNotFoundError:
        return None
    os.lseek(opened, position, os.SEEK_SET)
    return opened


def _in_memory(descriptor: int, position: int) -> int:
    """Return a private copy of a file in memory, at the same position."""
    copied, offset = os.memfd_create("copy"), 0
    while chunk := os.pread(descriptor, _CHUNK, offset):
        offset += os.pwrite(copied, chunk, offset)
    os.lseek(copied, position, os.SEEK_SET)
    return copied
