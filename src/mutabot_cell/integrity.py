"""Checks that the code that computes physics and motions is the code that was imported.

What processes of a campaign remember together holds only for that: a test may put something else in the place
of a step of the physics, of a function of numpy or of a class that plans. So all that the code in question
depends on is noted when it is imported, and compared, by identity, whenever something is to be remembered.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from operator import attrgetter, is_, itemgetter
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

_code_of = attrgetter("__code__")
_CONSTANT = (int, float, str, bytes, tuple, frozenset)
_NamedValues = Mapping[str, Any]


class CodeRecord:
    """Records what the code of some modules depends on, and compares it later.

    Args:
        modules: names of modules, and of packages with a dot behind, of which all that is loaded counts.
        libraries: whatever the code mentions of these counts as well.
    """

    def __init__(self, modules: Iterable[str], libraries: Iterable[ModuleType]) -> None:
        self._names: list[tuple[_NamedValues, itemgetter[Any], tuple[Any, ...]]] = []
        self._functions: list[FunctionType] = []
        self._codes: list[CodeType] = []
        self._methods: set[str] = set()
        mentioned: set[str] = set()
        for module in _loaded(tuple(modules)):
            self._note(vars(module))
            for kind in [owner for owner in vars(module).values() if _is_class_of(owner, module)]:
                self._note(vars(kind))
                self._methods.update(name for name, value in vars(kind).items() if callable(value))
        for code in self._codes:
            mentioned.update(_names_in(code))
        for library in libraries:
            names = vars(library)
            self._note({name: names[name] for name in mentioned & names.keys()}, names)
        self._is_of_library = all(_is_native(library) for library in libraries)

    def are_unchanged(self, *objects: object) -> bool:
        """Return whether neither that code nor a method of these objects has been replaced."""
        try:
            return (
                self._is_of_library
                and all(all(map(is_, get(names), values)) for names, get, values in self._names)
                and all(map(is_, map(_code_of, self._functions), self._codes))
                and all(vars(object_).keys().isdisjoint(self._methods) for object_ in objects)
            )
        except KeyError:  # something was taken away
            return False

    def _note(self, found: _NamedValues, names: _NamedValues | None = None) -> None:
        kept = {name: value for name, value in found.items() if _counts(name, value)}
        if not kept:
            return
        several = [*kept, next(iter(kept))]  # for one name, it would give no tuple
        values = tuple(found[name] for name in several)
        self._names.append((found if names is None else names, itemgetter(*several), values))
        for value in kept.values():
            function = getattr(value, "__func__", value)
            function = function.fget if type(function) is property else function
            if type(function) is FunctionType:
                self._functions.append(function)
                self._codes.append(function.__code__)


#: what looks at stretches of the physics, and what plans motions. What programs call is none of it
STRETCHES = tuple(f"{__package__}.{name}" for name in ("stretch", "lookahead", "guard"))
MOTIONS = (*(f"{__package__}.{name}" for name in ("motion.", "models.", "geometry", "fingerprint")), "mink.")
#: what is known of these; nothing before all of it is imported
_known: dict[tuple[str, ...], CodeRecord] = {}


def note(*libraries: ModuleType) -> None:
    """Record all code, once it is imported, and what it uses of these libraries."""
    for names in (STRETCHES, MOTIONS):
        _known[names] = CodeRecord(names, libraries)


def are_original(names: tuple[str, ...], *objects: object) -> bool:
    """Return whether ``STRETCHES`` or ``MOTIONS``, and the methods of these objects, are unchanged."""
    known = _known.get(names)
    return known is not None and known.are_unchanged(*objects)


def _loaded(names: tuple[str, ...]) -> Iterator[ModuleType]:
    for name, module in sorted(sys.modules.items()):
        is_named = any(
            name == entry or (entry.endswith(".") and f"{name}.".startswith(entry)) for entry in names
        )
        if is_named and isinstance(module, ModuleType):
            yield module


def _counts(name: str, value: Any) -> bool:
    is_constant = isinstance(value, _CONSTANT) and not name.startswith("__")
    return (
        is_constant
        or callable(value)
        or isinstance(value, ModuleType | property | staticmethod | classmethod)
    )


def _is_class_of(value: Any, module: ModuleType) -> bool:
    return isinstance(value, type) and value.__module__ == module.__name__


def _names_in(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names_in(constant)


def _is_native(library: ModuleType) -> bool:
    """Return whether MuJoCo's functions are its own; a test may have replaced them before."""
    if library.__name__ != "mujoco":
        return True
    steps = ("mj_step", "mj_getState", "mj_setState", "mj_copyData", "mj_saveModel", "mj_forward")
    return all(type(getattr(library, name, None)) is BuiltinFunctionType for name in steps)
