"""Private files: a process, and all it starts, sees the project as it is on disk, and its own changes to it.

The process enters a mount namespace of its own and lays an overlay over each folder: what it writes, renames
or deletes there goes into a layer that nobody else sees. An ordinary user needs a user namespace for that,
which some systems and most containers refuse. Mount flags: <linux/mount.h>; clone flags: <linux/sched.h>.
"""

from __future__ import annotations

import ctypes
import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress

_CLONE_NEWNS, _CLONE_NEWUSER = 0x00020000, 0x10000000
_MS_BIND, _MS_REC, _MS_PRIVATE, _MNT_DETACH = 4096, 16384, 1 << 18, 2
#: the layers of a process lie in its own folder
_LAYERS = "files"


def private_folders(root: str) -> tuple[str, ...]:
    """The folders that become private: the project, and that of temporary files."""
    folders = [os.path.realpath(root)]
    temporary = os.path.realpath(tempfile.gettempdir())
    if not is_below(folders[0], temporary) or temporary != folders[0]:
        folders.append(temporary)
    outer = [one for one in folders if any(is_below(other, one) for other in folders if other != one)]
    return tuple(dict.fromkeys([*outer, *folders]))


def make_private(root: str, home: str, shared: str) -> str | None:
    """Make this process's files private.

    Args:
        root: absolute path of the project.
        home: the process's own folder, beside those of other processes, which it cannot touch.
        shared: the folder that stays common to all processes, but for those folders.

    Returns why that is not possible, in words, and nothing has changed then, bar the namespace; None if it is
    done.
    """
    folders = [folder for folder in private_folders(root) if not is_below(folder, shared)]
    beside = os.path.dirname(home)
    covered: list[str] = []
    try:
        _enter_namespace()
        _mount("none", "/", None, _MS_REC | _MS_PRIVATE)
        with _opened([*folders, shared, beside, home]) as (*lowers, common, others, own):
            below = _mounts_below(folders, shared)
            with _opened(below) as kept:
                again = [*zip(below, kept, strict=True), (shared, common)]
                for number, (folder, lower) in enumerate(zip(folders, lowers, strict=True)):
                    _lay_over(folder, lower, own, number)
                    covered.append(folder)
                    # what is mounted in it comes back before the next folder, which may lie in such a one
                    for inner, descriptor in again:
                        if inner != folder and is_below(inner, folder):
                            _mount(_path(descriptor), inner, None, _MS_BIND | _MS_REC)
                            covered.append(inner)
            if beside != shared:
                _lay_over(beside, others, own, len(folders))
                covered.append(beside)
                _mount(_path(own), home, None, _MS_BIND | _MS_REC)
                covered.append(home)
    except OSError as error:
        _uncover(covered)
        return f"{error.strerror or error}"
    with suppress(OSError):  # the same folder, but seen through its new layers
        os.chdir(os.getcwd())
    return None


def _enter_namespace() -> None:
    user, group = os.geteuid(), os.getegid()
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.unshare(_CLONE_NEWNS) == 0:
        return
    if libc.unshare(_CLONE_NEWNS | _CLONE_NEWUSER) != 0:
        raise _last_error("this system allows no private mounts")
    for name, text in (
        ("setgroups", "deny"),
        ("uid_map", f"{user} {user} 1"),
        ("gid_map", f"{group} {group} 1"),
    ):
        with open(f"/proc/self/{name}", "w", encoding="ascii") as file:
            file.write(text)


def _lay_over(folder: str, lower: int, own: int, number: int) -> None:
    """Cover a folder by an overlay whose upper layer lies in the process's own folder."""
    layers = f"{_path(own)}/{_LAYERS}/{number}"
    for name in ("upper", "work"):
        os.makedirs(f"{layers}/{name}", exist_ok=True)
    status = os.fstat(lower)
    os.chmod(f"{layers}/upper", status.st_mode & 0o7777)
    with _opened([f"{layers}/upper", f"{layers}/work"]) as (upper, work):
        options = f"lowerdir={_path(lower)},upperdir={_path(upper)},workdir={_path(work)}"
        try:
            _mount("overlay", folder, options + ",redirect_dir=on", 0, kind="overlay")
        except OSError:  # without privileges, folders that were there cannot be renamed
            _mount("overlay", folder, options + ",userxattr", 0, kind="overlay")


def _mounts_below(folders: list[str], shared: str) -> list[str]:
    """File systems that are mounted below these folders, the outer ones first: an overlay would hide them."""
    with open("/proc/self/mountinfo", "rb") as file:
        points = [mount_point(line) for line in file]
    found = dict.fromkeys(
        point
        for point in sorted(points)
        if not is_below(point, shared)
        and any(point != folder and is_below(point, folder) for folder in folders)
    )
    return list(found)


def mount_point(line: bytes) -> str:
    """Where a file system is mounted, by a line of ``/proc/self/mountinfo``: in bytes, some of them octal."""
    field = line.split(b" ")[4]
    return os.fsdecode(re.sub(rb"\\([0-7]{3})", lambda match: bytes([int(match[1], 8)]), field))


def _uncover(folders: list[str]) -> None:
    """Take back what was laid over these folders, the last first."""
    libc = ctypes.CDLL(None, use_errno=True)
    for folder in reversed(folders):
        libc.umount2(os.fsencode(folder), _MNT_DETACH)


@contextmanager
def _opened(paths: list[str]) -> Iterator[list[int]]:
    """Descriptors that stand for these folders, whatever is mounted over their names meanwhile."""
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
    libc = ctypes.CDLL(None, use_errno=True)
    data = options.encode() if options is not None else None
    if libc.mount(os.fsencode(source), os.fsencode(target), kind.encode() or None, flags, data) != 0:
        raise _last_error(f"{target} cannot be covered")


def _last_error(what: str) -> OSError:
    number = ctypes.get_errno()
    return OSError(number, f"{what} ({os.strerror(number)})")


def is_below(path: str, folder: str) -> bool:
    """Whether a path is a folder or lies in it."""
    return path == folder or path.startswith(folder.rstrip("/") + "/")
