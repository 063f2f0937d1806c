"""Read probes, turn the user's values into plain data, and record the running test.

Probes are readings that mutabot itself takes to compare a mutant's world with the original's. During a test
they are read after its commands: first after every ``stride``-th command; once there are many, after every
second of these, and so on. So the original and its mutants are read at the same moments, however busy the
machine is.
"""

from __future__ import annotations

import hashlib
import inspect
import random
import re
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from enum import Enum
from functools import cached_property
from itertools import islice
from json import dumps
from types import FunctionType
from typing import TYPE_CHECKING, Any

from mutabot.errors import error_text, nearest_name, text_of
from mutabot.evidence import recorder as recorders
from mutabot.evidence.recording import RecordedCall, to_text
from mutabot.model.clocks import monotonic, thread_time
from mutabot.model.data import data_of, fields_of, is_of_numpy, is_textual, items_of
from mutabot.model.path import class_name, opaque
from mutabot.runtime.targets.target import resolve
from mutabot.runtime.targets.wrapper import Method

if TYPE_CHECKING:
    from mutabot.evidence.recorder import PictureWriter, WorldRecorder
    from mutabot.model import Probe
    from mutabot.model.job import Pictures
    from mutabot.runtime.observation.clock import Instances

#: parts reported per probe; a probe is meant to be a handful of numbers
LIMIT = 200
_MISSING = object()
_PLAIN = frozenset({float, int, str, bool, type(None)})


class UnreadableError(Exception):
    """A probe cannot be read; the text says why, and what would be needed."""


@dataclass(slots=True)
class Reading:
    """The values of all probes at one moment.

    Attributes:
        values: flat, ``target.part`` to number, text or truth value; a probe of the second object of its
            class is ``target#2``.
        unread: target to why it could not be read, for the others.
        seconds: of processor time that it takes to read them once more; None if they cannot be read along the
            way.
        not_along: why not, or None.
    """

    values: dict[str, Any] = field(default_factory=dict)
    unread: dict[str, str] = field(default_factory=dict)
    seconds: float | None = None
    not_along: str | None = None


def take(probes: tuple[Probe, ...], instances: Instances) -> Reading:
    """Read all probes. An error of the user's probe does not change the test's outcome."""
    reading = Reading()
    for probe in probes:
        try:
            for name, found in _read(probe.target, instances):
                reading.values.update(flatten(found, name) if found is not None else {})
        except UnreadableError as error:
            reading.unread[probe.target] = str(error)
        except Exception as error:  # as above
            reading.unread[probe.target] = error_text(error)
    return reading


def _read(target: str, instances: Instances) -> Iterator[tuple[str, Any]]:
    """Yield the probe's values, each under its name."""
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
    """Return whether a class attribute is read from objects, rather than from the class."""
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
        near = nearest_name(name, [attribute for attribute in dir(owner) if not attribute.startswith("_")])
        of = owner.__name__ if hasattr(owner, "__name__") else type(owner).__name__
        hint = f"; did you mean {near!r}?" if near else ""
        raise UnreadableError(f"{of} has no {name!r}{hint}") from None


def _value(found: Any) -> Any:
    """Return the result of a callable without arguments; anything else is a value itself."""
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
    """Return the arguments that must be given."""
    if _needs_none(found):
        return []
    try:
        parameters = inspect.signature(found).parameters.values()
    except (TypeError, ValueError):  # a native function: its call will say
        return []
    variable = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    return [
        parameter.name
        for parameter in parameters
        if parameter.default is parameter.empty and parameter.kind not in variable
    ]


def _needs_none(found: Callable[..., Any]) -> bool:
    """Return whether a callable clearly needs no arguments; fast, as signatures are slow to read."""
    function = getattr(found, "__func__", found)
    if type(function) is Method:
        function = function.__wrapped__
    if type(function) is not FunctionType or hasattr(function, "__wrapped__"):
        return False
    given = len(function.__defaults__ or ()) + (function is not found)
    code = function.__code__
    return code.co_argcount <= given and code.co_kwonlyargcount <= len(function.__kwdefaults__ or ())


def flatten(value: Any, name: str) -> dict[str, Any]:
    """Return a nested value as flat parts. Raises UnreadableError if it is no plain data."""
    return dict(islice(_parts(value, name), LIMIT))


def _parts(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    if type(value) in _PLAIN:  # the most of them
        yield name, value
        return
    value = _fields_of(value.tolist() if hasattr(type(value), "tolist") else value)
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
            f"it reads an object of {kind}, which is not plain data: numbers, texts, lists, dataclasses"
        )
    else:
        yield name, repr(value)


def _fields_of(value: Any) -> Any:
    """Return the fields of a dataclass or named tuple by name; any other value unchanged."""
    if hasattr(type(value), "_asdict"):
        return value._asdict()
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: getattr(value, field.name, None) for field in fields(value)}
    return value


#: readings before the first thinning, and between any later two
FIRST, NEXT = 100, 50
#: seconds beyond which a reading is too slow to be repeated
_SLOW = 0.05
#: how often a reading is timed
_TIMED = 3


@dataclass(slots=True)
class Along:
    """The readings during the running test.

    Attributes:
        read: reads the probes.
        entries: number of the call after which it was read, parts that differ from the reading before, and
            whether these are all parts there are.
        step: number of commands after which it is read again; 0 for never.
    """

    read: Callable[[], Reading]
    entries: list[tuple[int, dict[str, Any], bool]] = field(default_factory=list)
    step: int = 0
    _commands: int = 0
    _thins_at: int = FIRST
    _last: dict[str, Any] | None = None

    def start(self, stride: int) -> None:
        """Begin a new test; it is read only at its end if ``stride`` is 0."""
        self.entries, self._last = [], None
        self.step, self._commands, self._thins_at = stride, 0, FIRST

    def stop(self) -> None:
        """Stop reading, as the test is over."""
        self.step = 0

    def after(self, call: int) -> None:
        """Read the probes, if due, after the test's ``call``-th call, a command."""
        self._commands += 1
        is_main = threading.current_thread() is threading.main_thread()
        if not self.step or self._commands % self.step or not is_main:
            return
        values, last = self.read().values, self._last or {}
        is_whole = self._last is None or last.keys() != values.keys()
        changed = {key: value for key, value in values.items() if is_whole or value != last[key]}
        self.entries.append((call, changed, is_whole))
        self._last = values
        if len(self.entries) >= self._thins_at:
            self._thins_at += NEXT
            self.step *= 2


def first_reading(read: Callable[[], Reading]) -> Reading:
    """Read the probes, and note why they cannot be read along the way as well, if so."""
    first = read()
    if not first.values:
        return first
    drawn, walls, used = _random_state(), [], []
    for _ in range(_TIMED):  # the system may do other things meanwhile: the least counts
        began = monotonic(), thread_time()
        again = read()
        walls.append(monotonic() - began[0])
        used.append(thread_time() - began[1])
        if walls[-1] > _SLOW and len(walls) > 1:
            break
    # NaN is as good as NaN
    differing = (
        key
        for key in first.values.keys() | again.values.keys()
        if repr(first.values.get(key)) != repr(again.values.get(key))
    )
    if min(walls) > _SLOW:
        first.not_along = f"reading them takes {1e3 * min(walls):.0f} ms"
    elif drawn != _random_state():
        first.not_along = "reading them draws random numbers"
    elif (key := next(differing, None)) is not None:
        first.not_along = f"{key} changes when it is read twice"
    else:
        first.seconds = min(used)
    return first


def _random_state() -> Any:
    numpy = sys.modules.get("numpy.random")
    state = numpy.get_state() if numpy is not None and hasattr(numpy, "get_state") else ()
    return random.getstate(), [part.tobytes() if hasattr(part, "tobytes") else part for part in state]


#: characters of a value as JSON, and of a text, beyond which a digest stands for it
LONGEST, _CHARACTERS = 4000, 300
#: items of a container beyond which it is not looked at, and how deep
MOST, _DEPTH = 20_000, 20
_AS_TEXT = (complex, range, slice)
#: what differs between equal runs in different processes
_ACCIDENTS = re.compile(r"0x[0-9a-fA-F]{6,}|pytest-\d+")


def json_data(value: Any) -> Any:
    """Return the value as JSON-like data.

    What is no plain data becomes ``{"opaque": type}``, so that two of them are equal whatever they hold. A
    digest stands for what is large.
    """
    found = _data_of(value, 0)
    text = dumps(found, sort_keys=True) if isinstance(found, list | dict) else ""
    return {"digest": _digest(text.encode())} if len(text) > LONGEST else found


def text_of_error(error: BaseException) -> str:
    """Return an exception as text, without parts that differ between equal runs, such as addresses."""
    kind = class_name(type(error))
    return f"{kind.removeprefix('builtins:')}: {_ACCIDENTS.sub('…', text_of(error))[:_CHARACTERS]}"


def _data_of(value: Any, depth: int) -> Any:
    kind = type(value)
    if value is None or kind is bool:
        return value
    if issubclass(kind, Enum):
        return f"{kind.__name__}.{value.name}"
    if type(value) in _AS_TEXT or is_textual(value):
        return repr(value)
    if is_of_numpy(value):
        return _array(value, depth)
    items = items_of(value) if (stored := fields_of(value)) is None else stored
    if items is None:
        data = data_of(value)
        if isinstance(data, int | float):
            return data
        if issubclass(kind, int):  # too large to be one
            return _text(hex(value))
        if isinstance(data, str | bytes | bytearray):
            return _text(data)
        items = items_of(data)
    if depth > _DEPTH or items is None or len(items) > MOST:
        return opaque(value)
    if isinstance(items, dict):
        return {_key(key): _data_of(item, depth + 1) for key, item in items.items()}
    parts = [_data_of(item, depth + 1) for item in items]
    return sorted(parts, key=dumps) if type(value) in (set, frozenset) else parts


def _array(value: Any, depth: int) -> Any:
    if value.dtype.hasobject:
        return opaque(value)
    if getattr(value, "size", 1) <= LIMIT:
        return _data_of(value.tolist(), depth + 1)
    return {"array": list(value.shape), "digest": _digest(value.tobytes())}


def _key(key: Any) -> str:
    return key if type(key) is str else dumps(_data_of(key, 0))


def _text(value: str | bytes | bytearray) -> Any:
    if len(value) <= _CHARACTERS:
        return value if isinstance(value, str) else repr(bytes(value))
    return {"digest": _digest(value.encode("utf-8", "replace") if isinstance(value, str) else bytes(value))}


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]


class TestRecording:
    """The recording of the running test, if recordings are asked for.

    Args:
        clock: returns its simulated time, s, as long as no feed does.
        aside: what feeds read in this context is none of the program's calls.
        is_simulated: whether it is known that there is such a time.
    """

    __test__ = False

    def __init__(
        self, clock: Callable[[], float | None], aside: Callable[[], Any], is_simulated: bool
    ) -> None:
        self._clock, self._aside, self._is_simulated = clock, aside, is_simulated
        self._recorder: WorldRecorder | None = None
        self._film: PictureWriter | None = None
        self._filmed: str | None = None

    def film(self, pictures: Pictures) -> None:
        """Film a later test."""
        from pkgutil import resolve_name  # noqa: PLC0415  # no campaign films

        self._film, self._filmed = resolve_name(pictures.writer)(pictures.file), pictures.test

    def start(self, test: str, *, is_wanted: bool) -> None:
        """Begin to record a test."""
        recorders.stop()
        film = self._film if test == self._filmed else None
        self._recorder = recorders.begin(film) if is_wanted else None
        if self._recorder is not None:
            self._recorder.clock, self._recorder.aside = self._clock, self._aside
            self._recorder.is_simulated = self._is_simulated

    def stop(self) -> None:
        """End the recording of a test, before its teardown."""
        recorder = recorders.running()
        if recorder is not None:
            recorder.finish()
        recorders.stop()

    def since(self, moment: float) -> float | None:
        """Convert a value of ``time.monotonic`` to a time of the recording; None without one."""
        return self._recorder.at_wall(moment) if self._recorder is not None else None

    def note_fault(self, calls: int, time: float | None) -> None:
        """Note that the mutant has changed something, first or again, after ``calls`` calls."""
        if self._recorder is not None and self._recorder.recording.faulty_call is None:
            self._recorder.recording.faulty_call = calls
            self._recorder.recording.fault = time

    def text(self, calls: Sequence[RecordedCall]) -> str | None:
        """Return the recording and the calls as a text for ``TestEnd.recording``; None without one."""
        if self._recorder is None:
            return None
        recorder, recording = self._recorder, self._recorder.recording
        recording.is_simulated = recorder.is_simulated
        recording.fault = recorder.seconds(recording.fault)
        timed = (
            call._replace(began=recorder.seconds(call.began), ended=recorder.seconds(call.ended))
            for call in calls
        )
        recording.calls = sorted(timed, key=lambda call: call.began or 0.0)
        try:
            return to_text(recording)
        except (TypeError, ValueError, RecursionError) as error:  # values of the user's may be anything
            recorder.problem(f"the calls of a test cannot be recorded: {error_text(error)}")
            recording.calls = []
            return to_text(recording)
