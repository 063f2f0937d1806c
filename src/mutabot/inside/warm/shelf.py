"""The shelf: modules that are imported already, put away until the program of a new process imports them.

So the process finds the modules that a fresh one would find, in the order in which it imports them. What its
program imports beyond the shelf is noted, for the next process.
"""

from __future__ import annotations

import importlib
import importlib.machinery
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from types import ModuleType
from typing import Any

_Finder = importlib.machinery.PathFinder


class Shelf:
    """The shelf of a process, and a finder of modules.

    Args:
        bare: names of the modules that every fresh process has.
        folders: the folders of the interpreter's own libraries.
        notes: the file in which names of modules are noted.
        imports: module to what it imports, which goes with it.

    Attributes:
        known: names that need not be noted again.
    """

    def __init__(
        self, bare: Iterable[str], folders: Sequence[str], notes: str, imports: Mapping[str, Iterable[str]]
    ) -> None:
        self._bare = frozenset(bare)
        self.folders = tuple(folders)
        self._notes = notes
        self.known: set[str] = set()
        self._modules: dict[str, ModuleType] = {}
        self._imports = imports
        self._closures: dict[str, frozenset[str]] = {}

    def put_away(self) -> None:
        """Leave the modules that a fresh process has; all others go on the shelf."""
        self._modules = {
            name: sys.modules[name] for name in self._imported() if sys.modules[name] is not None
        }
        for name in self._modules:
            del sys.modules[name]

    def drop(self, name: str) -> None:
        """Do not offer a module."""
        self._modules.pop(name, None)

    def spare_ours(self) -> None:
        """Let pytest not load our own modules anew to rewrite their asserts."""
        rewrite = self._modules.get("_pytest.assertion.rewrite")
        if rewrite is None:
            return
        hook: Any = rewrite.AssertionRewritingHook
        plain = hook.find_spec

        def find_spec(finder: Any, name: str, path: Any = None, target: Any = None) -> Any:
            if name in self._modules and name.partition(".")[0] == "mutabot":
                return None
            return plain(finder, name, path, target)

        hook.find_spec = find_spec

    def _imported(self) -> list[str]:
        return [name for name in sys.modules if name not in self._bare and name != "__main__"]

    @property
    def top_names(self) -> set[str]:
        """What is imported already: names that no file or folder beside the program must have."""
        return {name.partition(".")[0] for name in self._imported()} - {"mutabot"}

    def get(self, name: str) -> Any:
        """A module, wherever it is; None if it has not been imported."""
        return sys.modules.get(name) or self._modules.get(name)

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> Any:
        """For the import system: how to take a module from the shelf."""
        module = self._modules.get(name)
        if module is None:
            self._note(name)
            return None
        if ("." not in name and self._is_hidden(name, module)) or self._has_other(name):
            return None
        found = module.__spec__
        loader: Any = _Loader(self, found)
        spec = importlib.machinery.ModuleSpec(name, loader, origin=getattr(found, "origin", None))
        if found is not None:
            spec.submodule_search_locations = found.submodule_search_locations
            spec.has_location = found.has_location
            spec.loader_state = found
        return spec

    def _is_hidden(self, name: str, module: ModuleType) -> bool:
        """Whether the program has put another module of that name in front of it."""
        file = getattr(module, "__file__", None)
        if file is None:
            return False
        before: list[str] = []
        for entry in sys.path:
            if entry in self.folders and file.startswith(entry.rstrip("/") + "/"):
                break
            if entry not in self.folders:
                before.append(entry)
        return bool(before) and _Finder.find_spec(name, before) is not None

    def take(self, name: str) -> ModuleType:
        """A module that is about to be imported; what it brings with it is there as well."""
        return self._modules[name]

    def bring(self, name: str) -> None:
        """Put what a module brings with it where it belongs.

        Whoever has put a finder before this one wants to see each module come.
        """
        if sys.meta_path[0] is self:
            self._bring_at_once(name)
            return
        for other in self._imports.get(name, ()):
            parts = other.split(".")
            for count in range(1, len(parts) + 1):
                self._bring_one(".".join(parts[:count]))

    def _bring_one(self, name: str) -> None:
        """Import a module; its package goes on to mean what it has meant by the module's name."""
        if name not in self._modules or name in sys.modules:
            return
        above, _, own = name.rpartition(".")
        names = getattr(self._modules.get(above), "__dict__", {})
        meant = names.get(own, self)
        importlib.import_module(name)
        if meant is not self and names.get(own) is not meant:
            names[own] = meant

    def _bring_at_once(self, name: str) -> None:
        for one in self._brought(name):
            if one in self._modules:
                sys.modules.setdefault(one, self._modules[one])

    def _brought(self, name: str) -> frozenset[str]:
        """A module and all that it brings with it, directly or not."""
        found = self._closures.get(name)
        if found is None:
            waiting = [name]
            done: set[str] = set()
            while waiting:
                one = waiting.pop()
                if one not in done:
                    done.add(one)
                    waiting += self._imports.get(one, ())
                    if "." in one:
                        waiting.append(one.rpartition(".")[0])
            found = self._closures[name] = frozenset(done)
        return found

    def look_up(self) -> None:
        """Find out now, once for all processes, what each module brings with it."""
        self._closures.clear()
        for name in self._imported():
            self._brought(name)

    def _has_other(self, name: str) -> bool:
        """Whether anything that a module has imported is another object here: somebody loaded it anew."""
        for one in self._brought(name):
            module = sys.modules.get(one)
            if module is not None and module is not self._modules.get(one, module):
                return True
        return False

    def _note(self, name: str) -> None:
        if name in self.known or not self._notes:
            return
        self.known.add(name)
        try:
            descriptor = os.open(self._notes, os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC, 0o600)
        except OSError:
            self._notes = ""
            return
        try:
            os.write(descriptor, f"{name}\n".encode())
        except OSError:
            self._notes = ""
        finally:
            os.close(descriptor)


class _Loader:
    """Takes a module from the shelf."""

    def __init__(self, shelf: Shelf, found: Any) -> None:
        self._shelf, self._found = shelf, found

    def create_module(self, spec: Any) -> ModuleType:
        """The module as it is."""
        return self._shelf.take(spec.name)

    def __getattr__(self, name: str) -> Any:
        """Whatever else is asked of it, the loader that loaded the module answers."""
        return getattr(self._found.loader, name)

    def exec_module(self, module: ModuleType) -> None:
        """It has run already: only what it was loaded by is put back."""
        stub: Any = module.__spec__
        name = stub.name
        module.__spec__ = stub.loader_state
        self._shelf.bring(name)
