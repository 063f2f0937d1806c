"""Gives the project and rclpy a simulated `time`, `threading` and so on, and other modules the real ones.

The module with the import statement decides. So pytest, its plug-ins and libraries are as they were.
"""

from __future__ import annotations

import builtins
import importlib.util
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from types import ModuleType
from typing import Any

from ros_in_process.settings import PACKAGES

#: what a module that shall see simulated modules may have among its globals
MARK = "__sees_simulation__"

_builders: dict[str, Callable[[], ModuleType]] = {}
_built: dict[str, ModuleType] = {}
_refusals: dict[str, Callable[[], None]] = {}
_tops: set[str] = set()
_roots: list[str] = []
_answers: dict[str, bool] = {}
_real_import = builtins.__import__


def provide(name: str, build: Callable[[], ModuleType]) -> None:
    """Register the builder of a simulated module that replaces the module with this name."""
    _builders[name] = build
    _tops.add(name.partition(".")[0])


def refuse(name: str, refusal: Callable[[], None]) -> None:
    """Register a function to call when the project imports an installed package of this name; it raises."""
    _refusals[name] = refusal
    _tops.add(name)


def is_provided(name: str) -> bool:
    """Return whether a module of this name is simulated."""
    return name in _builders


def simulated_module(name: str) -> ModuleType:
    """Return the simulated module for a name, which is built on first use."""
    if name not in _built:
        module = _builders[name]()
        _built[name] = module
    return _built[name]


def add_root(folder: str) -> None:
    """Let modules below a folder see the simulation."""
    folder = os.path.join(os.path.realpath(folder), "")
    if folder not in _roots:
        _roots.append(folder)
        _answers.clear()


def is_of_project(file: str) -> bool:
    """Return whether a file belongs to the project: below one of its roots, and not installed there."""
    answer = _answers.get(file)
    if answer is None:
        path = os.path.realpath(file)
        is_library = "site-packages" in path and not path.startswith(_overlays())
        answer = not is_library and any(path.startswith(root) for root in _roots)
        _answers[file] = answer
    return answer


def _overlays() -> tuple[str, ...]:
    """Return where workspaces of ROS below a root install the project's own packages."""
    prefixes = [prefix for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if prefix]
    folders = [os.path.join(os.path.realpath(prefix), "") for prefix in prefixes]
    return tuple(folder for folder in folders if folder.startswith(tuple(_roots)))


def sees_simulation(module: Mapping[str, Any]) -> bool:
    """Return whether a module, given by its globals, gets simulated modules."""
    if MARK in module:
        return bool(module[MARK])
    name, file = module.get("__name__"), module.get("__file__")
    decided = _decided(name) if isinstance(name, str) else None
    return (isinstance(file, str) and is_of_project(file)) if decided is None else decided


def is_decided(name: str) -> bool:
    """Return whether a module's name alone decides what it sees, since it is not the project's."""
    return _decided(name) is not None


def _decided(name: str) -> bool | None:
    """Return what `PACKAGES` says of a module or of the nearest package around it; None if nothing."""
    while name:
        if name in PACKAGES:
            return PACKAGES[name]
        name = name.rpartition(".")[0]
    return None


def _import(
    name: str,
    globals: Mapping[str, Any] | None = None,
    locals: Mapping[str, Any] | None = None,
    fromlist: Sequence[str] | None = (),
    level: int = 0,
) -> ModuleType:
    if level or globals is None or name.partition(".")[0] not in _tops or not sees_simulation(globals):
        return _real_import(name, globals, locals, fromlist or (), level)
    if (top := name.partition(".")[0]) in _refusals:
        spec = importlib.util.find_spec(top)
        if spec is not None and not is_of_project(spec.origin or ""):
            _refusals[top]()
        return _real_import(name, globals, locals, fromlist or (), level)
    if name not in _builders:
        real = _real_import(name, globals, locals, ("*",), 0)
        return real if fromlist else simulated_module(name.partition(".")[0])
    if not fromlist:
        simulated_module(name)
        return simulated_module(name.partition(".")[0])
    return simulated_module(name)


# a warning about an import is to name the module that imports: Python passes over frames of its own machinery
_import.__code__ = _import.__code__.replace(co_filename=f"<importlib._bootstrap, {__name__}>")


def install() -> None:
    """From now on, give each importing module the real or simulated modules meant for it."""
    builtins.__import__ = _import


def catch_up() -> None:
    """Give the project's modules that have already imported real modules the simulated ones."""
    for module in [module for name, module in list(sys.modules.items()) if _decided(name)]:
        for name, value in list(vars(module).items()):
            if isinstance(value, ModuleType) and value.__name__ in _builders:
                setattr(module, name, simulated_module(value.__name__))


def second_copy(name: str, without: Sequence[str] = ()) -> ModuleType:
    """Return a second copy of a standard library module that sees simulated modules; not in `sys.modules`."""
    real = sys.modules.get(name) or _real_import(name, None, None, ("*",), 0)
    file = real.__file__
    if file is None or real.__spec__ is None or real.__spec__.loader is None:
        raise ImportError(f"the module {name} has no source to copy")
    module = ModuleType(name, real.__doc__)
    module.__dict__.update(
        {MARK: True, "__file__": file, "__package__": real.__package__, "__spec__": real.__spec__}
    )
    _built.setdefault(name, module)  # before its code runs: modules may import each other
    code = real.__spec__.loader.get_code(name)  # type: ignore[attr-defined]  # loaders of source files have it
    exec(code, module.__dict__)
    for attribute in without:
        module.__dict__.pop(attribute, None)
    return module


def with_replacements(name: str, **changes: object) -> ModuleType:
    """Return a copy of a module with some attributes replaced."""
    real = sys.modules.get(name) or _real_import(name, None, None, ("*",), 0)
    module = ModuleType(name, real.__doc__)
    module.__dict__.update(real.__dict__)
    module.__dict__.update(changes)
    module.__dict__[MARK] = True
    module.__dict__.setdefault("__getattr__", partial(getattr, real))  # parts that are imported later
    return module
