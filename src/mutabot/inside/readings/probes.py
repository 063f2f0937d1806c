"""Probes: readings that mutabot itself takes, to compare a mutant's world with the original's.

Along the way of a test they are read after its commands: the first after every ``stride``-th command; once
there are many, after every second of these, and so on. So the original and its mutants are read at the same
moments, however busy the machine is.
"""

from __future__ import annotations

import inspect
import random
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from functools import cached_property
from time import perf_counter  # tests may replace those of the module
from types import FunctionType
from typing import Any

from mutabot.errors import nearest_name
from mutabot.frozen import frozen
from mutabot.inside.targets.target import resolve
from mutabot.model import Probe
from mutabot.model.class_name import class_name

from .instances import Instances

#: parts reported per probe; a probe is meant to be a handful of numbers
LIMIT = 200
_MISSING = object()
_PLAIN = frozenset({float, int, str, bool, type(None)})


class UnreadableError(Exception):
    """A probe cannot be read; the text says why, and what would be needed."""


@dataclass(slots=True)
class Reading:
    """All probes at one moment.

    Attributes:
        values: flat, ``target.part`` to number, text or truth value; a probe of the second object of its
            class is ``target#2``.
        unread: target to why it could not be read, for the others.
    """

    values: dict[str, Any] = field(default_factory=dict)
    unread: dict[str, str] = field(default_factory=dict)


def take(probes: tuple[Probe, ...], instances: Instances) -> Reading:
    """All probes as they are now. Whatever the user's probe does, the test's outcome stands."""
    reading = Reading()
    for probe in probes:
        try:
            for name, found in _read(probe.target, instances):
                reading.values.update(flatten(found, name) if found is not None else {})
        except UnreadableError as error:
            reading.unread[probe.target] = str(error)
        except Exception as error:  # as above
            reading.unread[probe.target] = f"{type(error).__name__}: {error}"
    return reading


def _read(target: str, instances: Instances) -> Iterator[tuple[str, Any]]:
    """The probe's values, each under its name."""
    module_name, _, qualname = target.partition(":")
    module = sys.modules.get(module_name)
    if module is None:
        raise UnreadableError(f"no test has imported its module {module_name!r}")
    parent, _, name = qualname.rpartition(".")
    owner: Any = module
    if parent:
        holder, last, _ = resolve(module, parent)
        owner = getattr(holder, last)
    if not isinstance(owner, type) or not is_bound(owner, name):
        yield target, _value(_attribute(owner, name))
        return
    found = instances.of(f"{module_name}:{parent}")
    if not found:
        raise UnreadableError(f"no object of {owner.__name__} is known: the test makes none, and calls none")
    for number, instance in enumerate(found, start=1):
        yield target if number == 1 else f"{target}#{number}", _value(_attribute(instance, name))


def is_bound(owner: type, name: str) -> bool:
    """Whether what a class has under this name is read from one of its objects."""
    raw = next((vars(base)[name] for base in owner.__mro__ if name in vars(base)), _MISSING)
    if raw is _MISSING:
        return not hasattr(owner, name)  # an attribute that its objects may have
    while hasattr(raw, "__wrapped__") and not isinstance(raw, classmethod | staticmethod):
        raw = raw.__wrapped__
    if isinstance(raw, classmethod | staticmethod):
        return False
    return isinstance(raw, FunctionType | property | cached_property) or hasattr(type(raw), "__get__")


def _attribute(owner: Any, name: str) -> Any:
    try:
        return getattr(owner, name)
    except AttributeError:
        if hasattr(type(owner), name):  # a property of its own accord
            raise
        near = nearest_name(name, [one for one in dir(owner) if not one.startswith("_")])
        of = owner.__name__ if hasattr(owner, "__name__") else type(owner).__name__
        hint = f"; did you mean {near!r}?" if near else ""
        raise UnreadableError(f"{of} has no {name!r}{hint}") from None


def _value(found: Any) -> Any:
    """What a callable without arguments returns; anything else is a value itself."""
    if not callable(found):
        return found
    needed = needed_arguments(found)
    if needed:
        raise UnreadableError(
            f"it needs {', '.join(needed)}; a probe is called without arguments: name a function, method, "
            "property or attribute that needs none"
        )
    value = found()
    if inspect.iscoroutine(value):
        value.close()
        raise UnreadableError("it is a coroutine function; a probe must be a plain function")
    return value


def needed_arguments(found: Callable[..., Any]) -> list[str]:
    """The arguments that must be given."""
    if _needs_none(found):
        return []
    try:
        parameters = inspect.signature(found).parameters.values()
    except (TypeError, ValueError):  # a native function: its call will say
        return []
    variable = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    return [one.name for one in parameters if one.default is one.empty and one.kind not in variable]


def _needs_none(found: Callable[..., Any]) -> bool:
    """Whether that can be seen at a glance: probes are read often, and signatures are slow."""
    function = getattr(found, "__func__", found)
    if type(function) is not FunctionType or hasattr(function, "__wrapped__"):
        return False
    given = len(function.__defaults__ or ()) + (function is not found)
    code = function.__code__
    return code.co_argcount <= given and code.co_kwonlyargcount <= len(function.__kwdefaults__ or ())


def flatten(value: Any, name: str) -> dict[str, Any]:
    """A nested value as flat parts. Raises UnreadableError for what is no plain data."""
    parts: dict[str, Any] = {}
    for key, part in _parts(value, name):
        parts[key] = part
        if len(parts) >= LIMIT:
            break
    return parts


def _parts(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    if type(value) in _PLAIN:  # the most of them
        yield name, value
        return
    if hasattr(value, "tolist"):
        value = value.tolist()
    if is_dataclass(value) and not isinstance(value, type):
        value = {field.name: getattr(value, field.name) for field in fields(value)}
    elif hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, Mapping | list | tuple) and not value:
        yield name, {} if isinstance(value, Mapping) else []
    elif isinstance(value, Mapping):
        for key, item in value.items():
            yield from _parts(item, f"{name}.{key}")
    elif isinstance(value, list | tuple):
        for index, item in enumerate(value):
            yield from _parts(item, f"{name}[{index}]")
    elif isinstance(value, int | float | str | bool | None):
        yield name, value
    elif "__repr__" not in {name for base in type(value).__mro__[:-1] for name in vars(base)}:
        kind = class_name(type(value))
        raise UnreadableError(
            f"it reads an object of {kind}, which is no plain data such as numbers, texts, lists, dataclasses"
        )
    else:
        yield name, repr(value)


#: readings before the first thinning, and between any later two
FIRST, NEXT = 100, 50
#: seconds beyond which a reading is too slow to be repeated
_SLOW = 0.05
#: how often a quick reading is timed once more: the least counts
_MORE = 2


@dataclass(slots=True)
class Along:
    """The readings of the running test.

    Attributes:
        read: reads the probes.
        entries: number of the call after which it was read, parts that differ from the reading before, and
            whether these are all parts there are.
    """

    read: Callable[[], Reading]
    entries: list[tuple[int, dict[str, Any], bool]] = field(default_factory=list)
    _step: int = 0
    _commands: int = 0
    _thins_at: int = FIRST
    _last: dict[str, Any] | None = None

    def start(self, stride: int) -> None:
        """A new test begins; it is not read along the way if ``stride`` is 0."""
        self.entries, self._last = [], None
        self._step, self._commands, self._thins_at = stride, 0, FIRST

    def stop(self) -> None:
        """What comes now is no more part of the test."""
        self._step = 0

    def after(self, call: int) -> None:
        """A command, the test's ``call``-th call, is over."""
        self._commands += 1
        if not self._step or self._commands % self._step:
            return
        if threading.current_thread() is not threading.main_thread():
            return
        values = self.read().values
        last = self._last
        if last is not None and last.keys() == values.keys():
            changed = {key: value for key, value in values.items() if value != last[key]}
            self.entries.append((call, changed, False))
        else:
            self.entries.append((call, values, True))
        self._last = values
        if len(self.entries) >= self._thins_at:
            self._thins_at += NEXT
            self._step *= 2


@frozen
class Rehearsal:
    """What is known of reading the probes once more.

    Attributes:
        seconds: of processor time; None if they cannot be read along the way.
        why_not: why not, or None.
    """

    seconds: float | None = None
    why_not: str | None = None


def rehearse(read: Callable[[], Reading]) -> tuple[Reading, Rehearsal]:
    """The probes, and whether they could be read along the way as well: reading them must change nothing."""
    first, took, _ = _timed(read)
    if not first.values:
        return first, Rehearsal()
    drawn = _random_state()
    second, took_again, seconds = _timed(read)
    slow = min(took, took_again)  # the system may do other things meanwhile
    if slow > _SLOW:
        return first, Rehearsal(None, f"reading them takes {1e3 * slow:.0f} ms")
    seconds = min(seconds, *(_timed(read)[2] for _ in range(_MORE)))
    if drawn != _random_state():
        return first, Rehearsal(None, "reading them draws random numbers")
    for key in first.values.keys() | second.values.keys():
        if not _is_same(first.values.get(key), second.values.get(key)):
            return first, Rehearsal(None, f"{key} changes when it is read twice")
    return first, Rehearsal(seconds)


def _timed(read: Callable[[], Reading]) -> tuple[Reading, float, float]:
    """The probes, and the seconds that reading them took: of wall clock, and of processor time."""
    began, used = perf_counter(), time.thread_time()
    reading = read()
    return reading, perf_counter() - began, time.thread_time() - used


def _is_same(one: Any, other: Any) -> bool:
    return repr(one) == repr(other)  # NaN is as good as NaN


def _random_state() -> Any:
    numpy = sys.modules.get("numpy.random")
    state = numpy.get_state() if numpy is not None and hasattr(numpy, "get_state") else ()
    return random.getstate(), [part.tobytes() if hasattr(part, "tobytes") else part for part in state]
