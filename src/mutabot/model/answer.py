"""Keep what a command returned as JSON-like data, and restore a fresh object from it each time.

Only what a copy surely preserves is kept: plain values, containers of them, arrays, enumerations, and objects
whose whole state is made of these. An object that the call knew already (the instance, an argument) is kept
as a reference to it. A part of the robot API is never copied: its copy would be a robot that gets no
commands. A future is kept as one that is never done.
"""

from __future__ import annotations

import base64
import importlib
import sys
from array import array
from collections import OrderedDict, deque
from collections.abc import Callable, Collection, Mapping
from dataclasses import is_dataclass
from types import SimpleNamespace
from typing import Any

from mutabot.extensions import brought
from mutabot.model.codec import is_plain
from mutabot.model.data import is_of_numpy
from mutabot.model.enumeration import is_member, member_of, name_of
from mutabot.model.path import class_name

#: futures of the standard library: kinds by module and class; modules that are not imported stay so
_FUTURES = (("asyncio", "Task"), ("asyncio", "Future"), ("concurrent.futures", "Future"))


def future_class(value: Any) -> str | None:
    """Return the kind of a future; None if the value is not a future."""
    for module, name in _FUTURES:
        kind = getattr(sys.modules.get(module), name, None)
        own = type(value)
        if kind is not None and (own is kind or (module == "asyncio" and issubclass(own, kind))):
            return f"{module}.{name}"
    name = class_name(type(value))
    return next((part.name for part in brought("futures").values() if part.reference == name), None)


def never_done(kind: str, here: Mapping[str, Any]) -> Any:
    """Return a new future of this kind that never completes. Raises LookupError if the kind has none."""
    known = brought("futures").get(kind)
    if kind == "concurrent.futures.Future" or known is not None:
        reference = known.reference if known is not None else "concurrent.futures:Future"
        if known is not None and reference.partition(":")[0] not in sys.modules:
            raise LookupError(f"{reference} is not imported")
        return _named(reference)()
    import asyncio  # noqa: PLC0415  # slow, and few answers are futures

    try:
        loop = asyncio.get_running_loop()
    except RuntimeError:
        raise LookupError(f"a future of kind {kind} needs an event loop, and none is running") from None

    async def never() -> None:
        await loop.create_future()

    return loop.create_task(never()) if kind == "asyncio.Task" else loop.create_future()


#: characters that an answer may take as data; it goes to every process that runs its mutant
LIMIT = 50_000
#: containers in containers; more is a structure that holds itself
DEPTH = 20

_SEQUENCES: dict[type[Any], str] = {
    list: "list", tuple: "tuple", set: "set", frozenset: "frozenset", deque: "deque",
}  # fmt: skip
_MAPPINGS: dict[type[Any], str] = {dict: "dict", OrderedDict: "OrderedDict"}
_MADE_BY: dict[str, type[Any]] = {name: kind for kind, name in {**_SEQUENCES, **_MAPPINGS}.items()}
_IMMUTABLE = (tuple, frozenset)
#: who has one of these copies itself in a way of its own, notices being thrown away, or answers any question
_OWN_WAYS = (
    "__new__", "__reduce__", "__reduce_ex__", "__getstate__", "__setstate__", "__getnewargs__",
    "__getnewargs_ex__", "__copy__", "__deepcopy__", "__del__", "__getattr__", "__getattribute__",
)  # fmt: skip

#: the modules of ROS 1 that its messages and moments have their methods from
_OF_ROS_1 = ("genpy.message", "genpy.rostime")


class NotKeptError(ValueError):
    """An answer that cannot be kept by value; the text says what it is."""


def keep(value: Any, here: Mapping[str, Any], handles: Collection[str] = ()) -> Any:
    """Return an answer as JSON-like data.

    Args:
        value: what the command returned.
        here: what the call knew, by name: the instance as ``self``, and the arguments.
        handles: classes (``module:Name``) that are part of the robot API.

    Raises NotKeptError if it cannot be copied safely.
    """
    return _AnswerWriter(here, frozenset(handles)).keep(value, 0)


def restore(data: Any, here: Mapping[str, Any]) -> Any:
    """Return a fresh object for data that ``keep`` has made; ``{"call": name}`` calls the user's function.

    Raises LookupError if a class or function is no longer there, or an argument is not given.
    """
    if not isinstance(data, dict):
        return data
    ((form, content),) = data.items()
    if form in _FORMS:
        return _FORMS[form](content, here)
    if form in ("dict", "OrderedDict"):
        return _MADE_BY[form]((restore(key, here), restore(item, here)) for key, item in content)
    return _MADE_BY[form](restore(item, here) for item in content)


class _AnswerWriter:
    def __init__(self, here: Mapping[str, Any], handles: frozenset[str]) -> None:
        self._here = here
        self._handles = handles
        self._left = LIMIT

    def keep(self, value: Any, depth: int) -> Any:
        self._spend(len(value) if type(value) is str else 8)
        if is_plain(value):
            return value
        if depth > DEPTH:
            raise NotKeptError("something that holds itself")
        if not issubclass(type(value), _IMMUTABLE):
            known = next((name for name, held in self._here.items() if held is value), None)
            if known is not None:
                return {"here": known}
        return self._container(value, depth + 1)

    def _container(self, value: Any, depth: int) -> Any:
        kind = type(value)
        if kind in _SEQUENCES:
            return {_SEQUENCES[kind]: [self.keep(item, depth) for item in value]}
        if kind in _MAPPINGS:
            pairs = [[self.keep(key, depth), self.keep(item, depth)] for key, item in value.items()]
            return {_MAPPINGS[kind]: pairs}
        if kind is SimpleNamespace:
            return {"namespace": self._attributes(vars(value), depth)}
        if kind in (bytes, bytearray):
            self._spend(len(value) * 4 // 3)
            return {kind.__name__: base64.b64encode(value).decode()}
        if is_of_numpy(value):
            return self._numpy(value)
        if kind is array and value.typecode != "u":
            self._spend(len(value) * value.itemsize * 4 // 3)
            return {"numbers": [value.typecode, base64.b64encode(value.tobytes()).decode()]}
        future = future_class(value)
        if future is not None:
            return {"pending": future}
        if is_member(value):
            return {"member": [_name_of(kind), name_of(value)]}
        if issubclass(kind, tuple) and hasattr(kind, "_fields"):
            return {"namedtuple": [_name_of(kind), [self.keep(item, depth) for item in tuple(value)]]}
        return self._object(value, depth)

    def _numpy(self, value: Any) -> Any:
        if value.dtype.kind not in "biufcSUmM":
            raise NotKeptError(f"an array of {value.dtype}")
        self._spend(value.nbytes * 4 // 3)
        form = "array" if type(value).__name__ == "ndarray" else "scalar"
        return {form: [value.dtype.str, list(value.shape), base64.b64encode(value.tobytes()).decode()]}

    def _object(self, value: Any, depth: int) -> Any:
        kind = type(value)
        name = _name_of(kind)
        constant = _constant(value)
        if constant is not None:
            return {"name": constant}
        if any(class_name(base) in self._handles for base in kind.__mro__) or not _is_all_state(value):
            raise NotKeptError(name)
        slots = {slot: getattr(value, slot) for slot in _slots(kind) if hasattr(value, slot)}
        attributes = getattr(value, "__dict__", {})
        return {"object": [name, self._attributes(attributes, depth), self._attributes(slots, depth)]}

    def _attributes(self, attributes: Mapping[str, Any], depth: int) -> dict[str, Any]:
        return {name: self.keep(item, depth) for name, item in attributes.items()}

    def _spend(self, size: int) -> None:
        self._left -= size
        if self._left < 0:
            raise NotKeptError(f"more than {LIMIT} characters")


def _array(kind: str, shape: list[int], content: str) -> Any:
    numpy = importlib.import_module("numpy")
    return numpy.frombuffer(base64.b64decode(content), dtype=kind).reshape(shape).copy()


def _is_all_state(value: Any) -> bool:
    """Return whether an object consists of its attributes alone, so that constructing it has no effect."""
    kind = type(value)
    for name in _OWN_WAYS:
        own = getattr(kind, name, None)
        if own is not getattr(object, name, None) and not _does_the_same(kind, own):
            return False
    try:
        object.__reduce_ex__(value, 4)  # says whether C code hides something
    except TypeError:
        return False
    return True


def _does_the_same(kind: type[Any], method: Any) -> bool:
    """Return whether a class's pickle method does the same as this module, as that of ROS 1 messages does."""
    made_by = getattr(method, "__module__", None)
    return made_by in _OF_ROS_1 or (is_dataclass(kind) and made_by == "dataclasses")


def _slots(kind: type[Any]) -> list[str]:
    found = []
    for base in kind.__mro__:
        slots = vars(base).get("__slots__", ())
        for slot in [slots] if isinstance(slots, str) else slots:
            hidden = slot.startswith("__") and not slot.endswith("__")
            found.append(f"_{base.__name__.lstrip('_')}{slot}" if hidden else slot)
    return [slot for slot in found if slot not in ("__dict__", "__weakref__")]


def _object(name: str, attributes: dict[str, Any], slots: dict[str, Any], here: Mapping[str, Any]) -> Any:
    made = object.__new__(_named(name))
    for slot, item in _attributes(slots, here).items():
        object.__setattr__(made, slot, item)
    if attributes:
        made.__dict__.update(_attributes(attributes, here))
    return made


def _constant(value: Any) -> str | None:
    """Return the name of a constant of its module or class, which programs compare with ``is``; else None."""
    kind = type(value)
    module = sys.modules.get(kind.__module__)
    for owner, prefix in ((module, f"{kind.__module__}:"), (kind, f"{class_name(kind)}.")):
        for name, constant in list(vars(owner).items()) if owner is not None else ():
            if constant is value:
                return f"{prefix}{name}"
    return None


def _name_of(kind: type[Any]) -> str:
    """Return a class as ``module:Name``. Raises NotKeptError if it cannot be found by that name."""
    name = class_name(kind)
    try:
        found = _named(name)
    except LookupError:
        found = None
    if found is not kind:
        raise NotKeptError(name)
    return name


def _named(name: str) -> Any:
    """Return the object at ``module:qualified.name``. Raises LookupError."""
    module, _, qualname = name.partition(":")
    try:
        found: Any = sys.modules.get(module) or importlib.import_module(module)
        for part in qualname.split("."):
            found = getattr(found, part)
    except (ImportError, AttributeError, ValueError) as error:
        raise LookupError(f"{name} is not there: {error}") from error
    return found


def _attributes(content: Mapping[str, Any], here: Mapping[str, Any]) -> dict[str, Any]:
    return {key: restore(item, here) for key, item in content.items()}


#: what makes each form of data an object again
_FORMS: dict[str, Callable[[Any, Mapping[str, Any]], Any]] = {
    "pending": never_done,
    "here": lambda name, here: here[name],
    "name": lambda name, here: _named(name),
    "call": lambda name, here: _named(name)(),
    "member": lambda content, here: member_of(_named(content[0]), content[1]),
    "bytes": lambda content, here: base64.b64decode(content),
    "bytearray": lambda content, here: bytearray(base64.b64decode(content)),
    "array": lambda content, here: _array(*content),
    "numbers": lambda content, here: array(content[0], base64.b64decode(content[1])),
    "scalar": lambda content, here: _array(*content)[()],
    "namespace": lambda content, here: SimpleNamespace(**_attributes(content, here)),
    "namedtuple": lambda content, here: tuple.__new__(
        _named(content[0]), [restore(item, here) for item in content[1]]
    ),
    "object": lambda content, here: _object(content[0], content[1], content[2], here),
}
