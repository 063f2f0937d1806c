"""What a test leaves behind in the process: state of modules and classes that was otherwise before it.

The state of a module is the digest of all that its names lead to. What nobody can look into is named, so that
the tests which may have changed it are known.
"""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from .digests import Known, Look
from .shared_fixtures import is_plain

#: variables of the environment that pytest itself changes in every test
_PYTESTS_OWN = "PYTEST_CURRENT_TEST"


@dataclass(slots=True)
class Leftovers:
    """State of the process from test to test.

    Args:
        is_project: whether a file belongs to the project.
        targets: modules of the robot API, wherever they lie.
    """

    is_project: Callable[[str], bool]
    targets: frozenset[str]
    _state: dict[str, str] = field(default_factory=dict)
    _objects: dict[str, Any] = field(default_factory=dict)
    _unseen: list[str] = field(default_factory=list)
    _sorted: dict[str, Any] = field(default_factory=dict)
    _ours: dict[str, Any] = field(default_factory=dict)
    _native: list[str] = field(default_factory=list)
    _inert: dict[str, Any] = field(default_factory=dict)
    _classes: dict[type, Known] = field(default_factory=dict)

    def start(self) -> None:
        """Note the state before the first test."""
        self._look()

    def since(self) -> tuple[list[str], list[str], list[str]]:
        """What has changed since the last look: names; those that stand for another object; unseen ones."""
        state, objects = self._state, self._objects
        self._look()
        left = [name for name, digest in self._state.items() if state.get(name) != digest]
        left += state.keys() - self._state.keys()
        replaced = [name for name in left if self._is_new(name, objects)]
        return left, replaced, self._unseen

    def _is_new(self, name: str, before: dict[str, Any]) -> bool:
        """Whether a name stands for an object that was made since; a value that was counted on is none."""
        now = self._objects.get(name)
        return now is not None and now is not before.get(name) and not is_plain(now)

    def _look(self) -> None:
        before = self._state
        self._state = {"the working directory": _folder(), "os.environ": _digest_of_environment()}
        self._objects, self._unseen = {}, []
        for known in self._classes.values():
            known.is_fresh = False
        for name, module in list(sys.modules.items()):
            if self._sorted.get(name, self) is not module:  # it is new, or was imported anew
                self._sort(name, module)
        for name, module in self._ours.items():
            self._look_at(name, module, before)
        self._unseen += self._native

    def _sort(self, name: str, module: Any) -> None:
        """Note whose module it is."""
        self._sorted[name] = module
        file = getattr(module, "__file__", None)
        if not isinstance(file, str) or not file.endswith(".py"):
            if name in self.targets:
                self._native.append(name)
        elif name in self.targets or self.is_project(file):
            self._ours[name] = module

    def _look_at(self, module: str, names: Any, before: dict[str, str]) -> None:
        for variable, value in _names(names).items():
            name = f"{module}.{variable}"
            self._objects[name] = value
            if self._inert.get(name, self) is value and name in before:  # nobody can have changed it
                self._state[name] = before[name]
                continue
            look = Look(self._owns, self._classes)
            self._state[name] = look.digest(value)
            if not look.is_mutable:
                self._inert[name] = value
            self._unseen += [f"{name} ({what})" for what in look.unseen]

    def _owns(self, module: str) -> bool:
        """Whether classes of this module are the project's, so that their attributes count."""
        if module in self.targets:
            return True
        file = getattr(sys.modules.get(module), "__file__", None)
        return isinstance(file, str) and self.is_project(file)


def _folder() -> str:
    try:
        return os.getcwd()
    except OSError:  # it was deleted
        return "gone"


def _digest_of_environment() -> str:
    items = sorted((name, value) for name, value in os.environ.items() if name != _PYTESTS_OWN)
    return hashlib.blake2b(repr(items).encode("utf-8", "surrogateescape"), digest_size=8).hexdigest()


def _names(module: Any) -> dict[str, Any]:
    """The names of a module that are the user's: Python's and pytest's own are left out."""
    return {
        name: value
        for name, value in vars(module).items()
        if not (name.startswith(("__", "@")) and name != "__all__")
    }
