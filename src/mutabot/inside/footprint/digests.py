"""The digest of all that an object leads to: equal digests mean equal states.

Containers, objects with their attributes, arrays, classes and closures of the project's own are walked
through. Objects that tell their state only to ``pickle`` are asked that way. What nobody can look into is
named.
"""

from __future__ import annotations

import gc
import hashlib
import io
import operator
import sys
import types
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from functools import cache
from pathlib import PurePath
from typing import Any

from mutabot.extensions import packages

#: objects looked at before a module counts as too large to look at
LIMIT = 200_000
_ATOMS = (type(None), bool, int, float, complex, str, bytes, type(...), type(NotImplemented), range)
#: what tells nothing about the world, or is looked at elsewhere
_IGNORED = (
    types.ModuleType,
    types.BuiltinFunctionType,
    types.CodeType,
    types.FrameType,
    types.TracebackType,
    types.GetSetDescriptorType,
    types.MemberDescriptorType,
    types.MethodDescriptorType,
    types.WrapperDescriptorType,
    types.GenericAlias,
)
#: packages whose objects are part of the machinery, not of the world
_MACHINERY = (
    "_pytest", "pytest", "pluggy", "logging", "typing", "abc", "_abc", "_thread", "threading", "_weakref",
    "weakref", "importlib", "_frozen_importlib", "ctypes", "_ctypes", "unittest.mock", "warnings", "re",
    "__future__", "mutabot.inside", "mutabot.languages", "mutabot.model", "mutabot.operators", "_asyncio",
    "_contextvars",
)  # fmt: skip
#: what Python, and ``unittest`` as it runs, keep in a class
_OF_CLASS = {
    "__dict__", "__weakref__", "__doc__", "__module__", "__abstractmethods__", "_abc_impl",
    "tearDown_exceptions", "_class_cleanups", "_classSetupFailed", "__annotations__", "__dataclass_fields__",
    "__dataclass_params__", "_member_map_", "_value2member_map_", "_member_names_",
    "__slotnames__",  # which copying any of its objects leaves on a class
}  # fmt: skip


def _is_stateless(value: Any) -> bool:
    """Whether a value tells all that it is by its ``repr``: most names of a module do."""
    kind = type(value)
    if kind is types.FunctionType:
        return not (value.__closure__ or value.__defaults__ or value.__kwdefaults__ or value.__dict__)
    return kind in _ATOM_TYPES or kind is types.ModuleType


@dataclass(slots=True)
class Known:
    """What was seen of a class of the project.

    Attributes:
        parts: its attributes, as they were then.
        digest: their digest.
        is_mutable: whether any of them can change without being replaced.
        is_fresh: whether it was looked at in this look.
    """

    parts: tuple[Any, ...]
    digest: str = ""
    is_mutable: bool = True
    is_fresh: bool = True


class Look:
    """One walk over all that a module's names lead to.

    Args:
        owns: whether classes and functions of a module count, by the module's name.
        classes: classes that were looked at before, since many names lead to the same ones.

    Attributes:
        unseen: types of objects that cannot be looked into.
        is_mutable: whether anything that was met can change without being replaced.
    """

    def __init__(self, owns: Callable[[str], bool], classes: dict[type, Known]) -> None:
        self._owns, self._classes = owns, classes
        self._machinery = (*_MACHINERY, *packages() - {"mutabot"})
        self._owned: dict[str, bool] = {}
        self._hash = hashlib.blake2b(digest_size=8)
        self._seen: dict[int, int] = {}
        self._kept: list[Any] = []
        self.unseen: dict[str, None] = {}
        self.is_mutable = False

    def digest(self, top: Any) -> str:
        """The digest of everything that an object leads to."""
        stack: list[Any] = [top]
        feed, seen = self._hash.update, self._seen
        while stack:
            value = stack.pop()
            kind = type(value)
            if kind in _ATOM_TYPES:
                feed(repr(value).encode("utf-8", "surrogatepass"))
                continue
            number = seen.get(id(value))
            if number is not None:
                feed(b"@%d" % number)
                continue
            if len(seen) >= LIMIT:
                self.unseen["more objects than can be looked at"] = None
                break
            seen[id(value)] = len(seen)
            self._kept.append(value)  # what is made on the way must keep its id
            feed(b"(" + kind.__qualname__.encode("utf-8", "replace"))
            stack.extend(self._parts(value, kind))
        return self._hash.hexdigest()

    def _parts(self, value: Any, kind: type) -> Iterator[Any]:
        """What an object consists of."""
        if kind is dict or kind is types.MappingProxyType:
            self.is_mutable = True
            for key, item in value.items():
                yield item
                yield key
        elif kind in _SEQUENCES:
            self.is_mutable = self.is_mutable or kind is list
            yield len(value)
            yield from value
        elif kind in (set, frozenset):
            self.is_mutable = self.is_mutable or kind is set
            yield len(value)
            yield from sorted(value, key=lambda item: repr(item) if type(item) in _ATOM_TYPES else "")
        elif isinstance(value, PurePath | Enum):  # they remember what they have been asked
            yield str(value)
        elif isinstance(value, type):
            yield from self._of_class(value)
        elif isinstance(value, types.FunctionType):
            yield from self._of_function(value)
        elif isinstance(value, types.MethodType):
            self.is_mutable = True
            yield value.__self__
            yield value.__func__.__qualname__
        elif isinstance(value, _IGNORED) or self._is_machinery(kind):
            yield getattr(value, "__name__", None) if isinstance(value, types.ModuleType) else None
        elif isinstance(value, staticmethod | classmethod):
            yield value.__func__
        elif isinstance(value, property):
            yield from (value.fget, value.fset, value.fdel)
        else:
            yield from self._of_object(value, kind)

    def _of_class(self, cls: type) -> Iterator[Any]:
        yield f"{cls.__module__}.{cls.__qualname__}"
        if not self._is_owned(cls.__module__):
            return
        self.is_mutable = True
        parts = tuple(vars(cls).values())
        known = self._classes.get(cls)
        is_same = (
            known is not None
            and len(parts) == len(known.parts)
            and all(map(operator.is_, parts, known.parts))
        )
        if known is None or not is_same or (known.is_mutable and not known.is_fresh):
            known = self._classes[cls] = Known(parts)  # it may lead to itself
            own = {name: item for name, item in vars(cls).items() if name not in _OF_CLASS}
            look = Look(self._owns, self._classes)
            rest = [f"{name}={item!r}" for name, item in own.items() if type(item) in _ATOM_TYPES]
            stateful = tuple((name, item) for name, item in own.items() if not _is_stateless(item))
            known.digest = look.digest((tuple(own), tuple(rest), stateful))
            known.is_mutable = look.is_mutable
            self.unseen.update(look.unseen)
        yield known.digest

    def _of_function(self, function: types.FunctionType) -> Iterator[Any]:
        yield f"{function.__module__}.{function.__qualname__}"
        if self._is_owned(function.__module__ or "") and not _is_stateless(function):
            self.is_mutable = True
            yield function.__defaults__
            yield function.__kwdefaults__
            yield function.__dict__
            for cell in function.__closure__ or ():
                try:
                    yield cell.cell_contents
                except ValueError:  # it is empty
                    yield None

    def _of_object(self, value: Any, kind: type) -> Iterator[Any]:
        self.is_mutable = True
        yield kind
        if hasattr(kind, "__array_interface__") or hasattr(kind, "tobytes"):
            yield from self._of_array(value)
            return
        for name, item in _attributes(value, kind):
            yield item
            yield name
        if isinstance(value, dict | list | tuple | set | frozenset):
            yield from (value.items() if isinstance(value, dict) else value)
        elif isinstance(value, io.IOBase) and not isinstance(value, io.BytesIO | io.StringIO):
            yield from _of_file(value)
        elif isinstance(value, types.GeneratorType):
            yield from _of_generator(value)
        elif _is_native(kind):
            yield from self._of_opaque(value, kind)
        else:  # a part that C code of a Python class holds, such as what a cache remembers
            own = getattr(value, "__dict__", None)
            yield from (part for part in gc.get_referents(value) if part is not kind and part is not own)

    def _of_array(self, value: Any) -> Iterator[Any]:
        try:
            yield getattr(value, "shape", None)
            if getattr(getattr(value, "dtype", None), "hasobject", False):
                yield value.tolist()
            else:
                yield bytes(value.tobytes())
        except Exception as error:  # whatever array-like it is: what it does not tell is not known
            yield from self._unknown(type(value), error)

    def _of_opaque(self, value: Any, kind: type) -> Iterator[Any]:
        """A type written in C: what it tells to pickle and to the garbage collector."""
        try:
            reduced = value.__reduce_ex__(4)
        except Exception as error:  # many refuse
            children = gc.get_referents(value)
            if not children:
                yield from self._unknown(kind, error)
            yield from (child for child in children if child is not kind)
            return
        if isinstance(reduced, tuple):
            yield from reduced[1:3]
            yield from (list(part) for part in reduced[3:5] if part is not None)

    def _unknown(self, kind: type, error: Exception) -> Iterator[Any]:
        self.unseen[f"{kind.__module__}.{kind.__qualname__}"] = None
        yield None

    def _is_owned(self, module: str) -> bool:
        found = self._owned.get(module)
        if found is None:
            found = self._owned[module] = self._owns(module)
        return found

    def _is_machinery(self, kind: type) -> bool:
        module = kind.__module__
        return isinstance(module, str) and any(
            module == name or module.startswith(f"{name}.") for name in self._machinery
        )


_ATOM_TYPES = frozenset(_ATOMS)
_SEQUENCES = frozenset({list, tuple})


def _of_generator(generator: types.GeneratorType[Any, Any, Any]) -> Iterator[Any]:
    """How far a generator has come, and with what."""
    frame = generator.gi_frame
    if frame is not None:
        yield frame.f_lasti
        yield dict(frame.f_locals)


def _of_file(file: Any) -> Iterator[Any]:
    """How far an open file has been read or written."""
    yield getattr(file, "name", None)
    try:
        yield file.tell()
    except Exception:  # it is closed, or has no position
        yield None


@cache
def _is_native(kind: type) -> bool:
    """Whether a part of such an object lies in memory of C code."""
    return any(_is_of_native_module(cls.__module__) for cls in kind.__mro__[:-1])


def _is_of_native_module(name: str) -> bool:
    module = sys.modules.get(name)
    file = getattr(module, "__file__", None)
    return module is not None and name != "__main__" and not (isinstance(file, str) and file.endswith(".py"))


def _attributes(value: Any, kind: type) -> Iterator[tuple[str, Any]]:
    """Attributes of an object: of its dictionary and its slots. No code of its class runs."""
    try:
        own = object.__getattribute__(value, "__dict__")
    except AttributeError:
        own = None
    if isinstance(own, dict):
        yield "__dict__", len(own)
        yield from list(own.items())
    for cls in kind.__mro__:
        slots = cls.__dict__.get("__slots__", ())
        for name in (slots,) if isinstance(slots, str) else slots:
            descriptor = cls.__dict__.get(name)
            if isinstance(descriptor, types.MemberDescriptorType):
                try:
                    yield name, descriptor.__get__(value, kind)
                except AttributeError:  # it was never set
                    yield name, None
