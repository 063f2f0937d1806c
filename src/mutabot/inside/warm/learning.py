"""What a zygote imports beforehand: modules that its processes have imported, as far as that is safe.

Each is tried in a process of its own first. One that leaves more than modules behind, such as a thread, an
open file, a changed environment, or words on the terminal, is left to those who want it; so is all that
imports it. Only libraries of the interpreter are imported, nothing of the user's own.
"""

from __future__ import annotations

import gc
import importlib
import importlib.machinery
import importlib.util
import json
import os
import signal
import sys
import sysconfig
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, Protocol

from mutabot.border.start import Start
from mutabot.inside.fork.forkable import count_threads

from .become import UnfitError
from .shelf import Shelf

#: variables that C code reads where nobody sees it, or that Python reads before all else
_SILENT = (
    "PYTHON", "LD_", "OMP_", "OPENBLAS_", "MKL_", "NUMEXPR_", "GOTO_", "BLIS_", "KMP_", "MALLOC_", "GLIBC_",
    "LC_", "RMW_", "RCUTILS_", "AMENT_", "COV_CORE_", "COVERAGE_", "MUJOCO_",
)  # fmt: skip
_SILENT_NAMES = {"LANG", "LANGUAGE", "TZ"}
#: of those, what a process may have otherwise: it is read again
_READ_AGAIN = {"PYTHONPATH"}
_BLANK = ("sitecustomize", "usercustomize")
#: names of variables by which Python goes on after a program
_LIVELY = ("PYTHONINSPECT", "PYTHONSTARTUP")
_PROBES = 20
_SUFFIXES = frozenset(importlib.machinery.all_suffixes())


class Imports(Protocol):
    """What watches imports from the very first on; it stands where nothing need be imported for it."""

    bare: tuple[str, ...]
    found: dict[str, dict[str, None]]

    def watch(self) -> None:
        """Note who imports what."""

    def stop(self) -> None:
        """Import as ever."""


class _Watched(dict[Any, Any]):
    """The environment while modules are imported: notes what is read."""

    read: set[Any]
    is_read_whole = False

    def __getitem__(self, key: Any) -> Any:
        self.read.add(key)
        return super().__getitem__(key)

    def __contains__(self, key: object) -> bool:
        self.read.add(key)
        return super().__contains__(key)

    def __iter__(self) -> Iterator[Any]:
        self.is_read_whole = True
        return super().__iter__()


class _Blocker:
    """A finder that lets nobody import certain modules."""

    def __init__(self, names: Iterable[str]) -> None:
        self._names = set(names)
        self.is_hit = False

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> None:
        if name in self._names or name.partition(".")[0] in self._names:
            self.is_hit = True
            raise ModuleNotFoundError(f"{name} is not to be imported beforehand", name=name)


class Library:
    """The modules of a zygote.

    Args:
        imports: which modules were there at the very beginning, and what each has imported since.
        notes: the file in which its processes note what they import.
        own: folders and files of the user's own.

    Attributes:
        base: the search path of modules without what the environment adds.
        shelf: where modules are put away.
    """

    def __init__(self, imports: Imports, notes: str, own: tuple[str, ...]) -> None:
        self._own = own
        self._notes = notes
        self._environment = dict(os.environb)
        added = {os.path.abspath(one) for one in os.environ.get("PYTHONPATH", "").split(os.pathsep)}
        self.base = tuple(one for one in sys.path if one and one not in added)
        folders = {sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")}
        libraries = [one for one in self.base if one in folders or _is_library(one)]
        bare = [one for one in imports.bare if one not in _BLANK]
        self.shelf = Shelf(bare, libraries, notes, imports.found)
        self._imports = imports
        self._read: set[bytes] = set()
        self._unsafe: set[str] = set()
        self._size = 0
        for name in _BLANK:
            sys.modules.pop(name, None)

    def learn(self) -> None:
        """Import what has been noted since the last time."""
        try:
            size = os.stat(self._notes).st_size
        except OSError:
            return
        if size == self._size:
            return
        self._size = size
        with open(self._notes, encoding="utf-8", errors="replace") as file:
            names = [name for name in dict.fromkeys(file.read().split("\n")[:-1]) if name]
        fresh = [one for one in names if one not in self.shelf.known and one not in sys.modules]
        self.shelf.known.update(names)
        self._import([name for name in fresh if self._is_of_library(name)])
        self.shelf.look_up()
        gc.collect()
        gc.freeze()

    def _is_of_library(self, name: str) -> bool:
        """Whether a module is not of the user's own; it is not imported to find out."""
        top = name.partition(".")[0]
        if name.rpartition(".")[2] == "__main__" or top in _BLANK:
            return False
        if top == "mutabot":
            return True
        try:
            spec = importlib.util.find_spec(top)
        except (ImportError, ValueError, AttributeError):
            return False
        origin = spec.origin if spec is not None else None
        if origin in ("built-in", "frozen"):
            return True
        if origin is None or not os.path.isabs(origin):
            return False
        origin = os.path.realpath(origin)
        is_own = any(origin == one or origin.startswith(one.rstrip("/") + "/") for one in self._own)
        in_library = any(origin.startswith(one.rstrip("/") + "/") for one in self.shelf.folders)
        return in_library and (
            not is_own or _is_library(os.path.dirname(origin)) or self._is_in_library(origin)
        )

    def _is_in_library(self, origin: str) -> bool:
        """Whether a file lies in a library, also where that library lies in a folder of the user's."""
        return any(
            origin.startswith(folder.rstrip("/") + "/")
            for folder in self.shelf.folders
            if not any(one.startswith(folder) for one in self._own)
        )

    def _import(self, names: list[str]) -> None:
        for _ in range(_PROBES):
            wanted = [name for name in names if name.partition(".")[0] not in self._unsafe]
            found = self._try_out(wanted)
            if found is None:
                return
            if found <= self._unsafe:
                break
            self._unsafe |= found
        else:
            return
        self._take_in(wanted)

    def _try_out(self, names: list[str]) -> set[str] | None:
        """In another process: which packages are not safe to import; None if that cannot be found out."""
        reading, writing = os.pipe()
        pid = os.fork()
        if pid == 0:
            try:
                signal.alarm(30)
                os.close(reading)
                os.write(writing, json.dumps(sorted(self._rehearse(names))).encode())
            finally:
                os._exit(0)
        os.close(writing)
        text = b""
        while data := os.read(reading, 1 << 16):
            text += data
        os.close(reading)
        os.waitpid(pid, 0)
        with suppress(ValueError):
            return set(json.loads(text))
        return None

    def _rehearse(self, names: list[str]) -> set[str]:
        """Import one after the other until one is not safe."""
        output = os.memfd_create("output")
        for number in (1, 2):
            os.dup2(output, number)
        blocker = _Blocker(self._unsafe)
        sys.meta_path.insert(0, blocker)
        for name in names:
            if name in sys.modules:
                continue
            before = _traces(output)
            blocker.is_hit = False
            with self._watching() as watched, suppress(BaseException):
                importlib.import_module(name)
            if watched.is_read_whole or blocker.is_hit or _traces(output) != before:
                return {name.partition(".")[0]} | self._unsafe
        return set(self._unsafe)

    @contextmanager
    def _watching(self) -> Iterator[_Watched]:
        environment: Any = os.environ
        plain = environment._data
        watched = _Watched(plain)
        watched.read = self._read
        environment._data = watched
        try:
            yield watched
        finally:
            environment._data = plain

    def _take_in(self, names: list[str]) -> None:
        blocker = _Blocker(self._unsafe)
        sys.meta_path.insert(0, blocker)
        self._imports.watch()
        try:
            with self._watching():
                for name in names:
                    with suppress(Exception):
                        importlib.import_module(name)
        finally:
            sys.meta_path.remove(blocker)
            self._imports.stop()

    def refuse(self, start: Start) -> None:
        """Raise UnfitError for a process that would not find what it must find."""
        values: dict[bytes, bytes] = {}
        for entry in start.environment:
            name, _, value = entry.partition(b"=")
            values.setdefault(name, value)
        for name in {*values, *self._environment}:
            if values.get(name) != self._environment.get(name) and self._counts(name):
                raise UnfitError(f"{os.fsdecode(name)} is another than when modules were imported")
        if any(os.fsencode(name) in values for name in _LIVELY):
            raise UnfitError("something is to happen after the program")
        if values.get(b"PYTHONHASHSEED", b"random") == b"random":
            raise UnfitError("its hashes are to be drawn at random")

    def _counts(self, variable: bytes) -> bool:
        """Whether a variable may have had a say in what is there already."""
        name = os.fsdecode(variable)
        if name in _READ_AGAIN:
            return False
        return variable in self._read or name in _SILENT_NAMES or name.startswith(_SILENT)

    def refuse_hidden(self, start: Start) -> None:
        """Raise UnfitError if modules beside the program would be imported instead of those of a library."""
        folders = [one for one in os.environ.get("PYTHONPATH", "").split(os.pathsep) if one]
        script = os.fsdecode(start.subject)
        folders.append(os.path.dirname(os.path.realpath(script)) if start.kind == "script" else ".")
        names = self.shelf.top_names
        for folder in folders:
            with suppress(OSError):
                hidden = sorted(names.intersection(map(_module_name, os.scandir(folder))))
                if hidden:
                    raise UnfitError(f"{hidden[0]} in {folder} stands before that of a library")

    def open_to(self, start: Start) -> None:
        """In the new process: put everything on the shelf, from where it is taken when it is imported."""
        self.shelf.put_away()
        if start.kind == "module":  # it is found, but not imported
            self.shelf.drop(os.fsdecode(start.subject))
        if start.may_start:
            self.shelf.spare_ours()
        sys.meta_path.insert(0, self.shelf)


def _module_name(entry: os.DirEntry[str]) -> str:
    """The name by which a file or folder could be imported; empty if it could not."""
    top, dot, rest = entry.name.partition(".")
    return top if (dot + rest) in _SUFFIXES or (not dot and entry.is_dir()) else ""


def _is_library(folder: str) -> bool:
    return os.path.basename(folder) in ("site-packages", "dist-packages", "lib-dynload")


def _traces(output: int) -> tuple[object, ...]:
    """What an import must not change."""
    return (
        count_threads(),
        sorted(os.listdir("/proc/self/fd")),
        os.fstat(output).st_size,
        dict(os.environ),
        os.getcwd(),
        list(sys.path),
        [signal.getsignal(number) for number in range(1, 32)],
        os.umask(os.umask(0o22)),
    )
