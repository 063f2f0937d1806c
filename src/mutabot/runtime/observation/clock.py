"""The program's time, and the objects of a class that the running test uses.

The time is read at every call that advances the simulation, or counted in fixed steps. A probe on a method
or attribute is read from those objects that are ``self`` of an intercepted call in the running test, in the
order of their first call. Where there is none, one object: the last that was made in this test, else one that
its fixtures hold, else the last that was made before any test or while a module was imported. An object that
another test made is never taken. Objects are noted when they are made, by their class's ``__init__``, and
when they are used, by the interception.
"""

from __future__ import annotations

import contextlib
import inspect
import reprlib
import sys
import weakref
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from math import isfinite
from sys import _getframe
from types import CoroutineType, ModuleType
from typing import Any

import wrapt

from mutabot.errors import PathError
from mutabot.model import Clock, Path, Vocabulary
from mutabot.model.signature import ANYTHING, signature_of
from mutabot.model.units import convert
from mutabot.runtime.interception.adapter import Invocation
from mutabot.runtime.meter import Meter
from mutabot.runtime.targets.target import NotFoundError, resolve
from mutabot.runtime.targets.wrapper import bound

#: objects per class and test that are read
MOST = 20
#: modules that run others
_IMPORTERS = ("importlib._bootstrap", "importlib._bootstrap_external", "_pytest.assertion.rewrite")


class Instances:
    """The objects of certain classes, by the classes' names ``module:qualified.name``.

    Attributes:
        is_watching: whether there is a class to watch.
    """

    def __init__(self) -> None:
        self.is_watching = False
        self._classes: dict[type, str] = {}
        self._names: set[str] = set()
        self._known: dict[type, tuple[str, ...]] = {}
        self._used: dict[str, dict[int, Callable[[], Any]]] = {}
        # by whether they belong to one test, rather than to all
        self._made: dict[bool, dict[str, dict[int, weakref.ref[Any]]]] = {False: {}, True: {}}
        self._fixtures: Callable[[], Iterable[Any]] | None = None

    def watch(self, names: Iterable[str]) -> None:
        """Note, from now on, the objects of those of these names that are classes."""
        for name in names:
            if name and name not in self._names:
                self.is_watching = True
                self._names.add(name)
                self._watch(name)

    def _watch(self, name: str) -> None:
        module_name, _, qualname = name.partition(":")

        def imported(module: ModuleType) -> None:
            with contextlib.suppress(NotFoundError, TypeError):  # the inspection of the vocabulary reports it
                owner, last, _ = resolve(module, qualname)
                found = getattr(owner, last)
                if isinstance(found, type) and found not in self._classes:
                    self._classes[found] = name
                    self._known.clear()
                    _note_made(found, self._note_made)
                    for value in list(vars(module).values()):  # made while the module was imported
                        if issubclass(type(value), found):  # to ask a proxy makes what it stands for
                            self._note(value, is_of_test=False)

        wrapt.register_post_import_hook(imported, module_name)

    def start(self, fixtures: Callable[[], Iterable[Any]] | None = None) -> None:
        """Begin a new test, which has used no object yet.

        ``fixtures`` returns the objects that its fixtures hold. None in a process below the tests, which goes
        on with what it has made.
        """
        self._used.clear()
        self._fixtures = fixtures
        if fixtures is not None:
            self._made[True].clear()

    def let_go(self) -> None:
        """Release the objects that the running test used, as it is over."""
        self._used.clear()

    def used(self, instance: Any) -> None:
        """Note an object that is ``self`` of an intercepted call."""
        for name in self._names_of(type(instance)):
            used = self._used.setdefault(name, {})
            if id(instance) not in used and len(used) < MOST:
                used[id(instance)] = _held(instance, self._references_to(instance))

    def _references_to(self, instance: Any) -> int:
        """Return how many weak references to an object are kept here."""
        made = (by_id for by_name in self._made.values() for by_id in by_name.values())
        return sum(id(instance) in by_id for by_id in made)

    def of(self, name: str) -> list[Any]:
        """Return the current objects of this class from which a probe is read."""
        return _alive(self._used.get(name, {})) or self._made_last(name, True) or self._held_by_fixtures(name)

    def _made_last(self, name: str, is_of_test: bool) -> list[Any]:
        return _alive(self._made[is_of_test].get(name, {}))[-1:]

    def _held_by_fixtures(self, name: str) -> list[Any]:
        given = self._fixtures() if self._fixtures is not None else ()
        held = [value for value in given if name in self._names_of(type(value))]
        return held[-1:] or self._made_last(name, False)

    def _names_of(self, kind: type) -> tuple[str, ...]:
        names = self._known.get(kind)
        if names is None:
            names = tuple(name for base, name in self._classes.items() if issubclass(kind, base))
            self._known[kind] = names
        return names

    def _note_made(self, instance: Any) -> None:
        self._note(instance, is_of_test=self._fixtures is not None and not _is_importing())

    def _note(self, instance: Any, *, is_of_test: bool) -> None:
        for name in self._names_of(type(instance)):
            made = self._made[is_of_test].setdefault(name, {})
            key = id(instance)
            with contextlib.suppress(TypeError):  # of a class without weak references
                made.pop(key, None)
                made[key] = weakref.ref(instance, partial(_forget, made, key))


def _alive(holds: dict[int, Any]) -> list[Any]:
    return [found for found in (hold() for hold in holds.values()) if found is not None]


def _is_importing() -> bool:
    """Return whether a module is being imported, whose objects exist for all later tests."""
    frame = _getframe(1)
    while frame.f_back is not None:
        if frame.f_code.co_name == "<module>" and frame.f_back.f_globals.get("__name__") in _IMPORTERS:
            return True
        frame = frame.f_back
    return False


def _forget(made: dict[int, weakref.ref[Any]], key: int, gone: weakref.ref[Any]) -> None:
    if made.get(key) is gone:
        del made[key]


def _held(instance: Any, known: int) -> Callable[[], Any]:
    """Return a reference to an object that keeps it alive until its test ends, if that is not noticeable.

    ``known``: the weak references to it that are kept here.
    """
    parts: dict[str, Any] = {}
    with contextlib.suppress(AttributeError):  # of an object without a dictionary
        parts = object.__getattribute__(instance, "__dict__")
    kinds = map(type, (instance, *list(parts.values())))
    ends = any(hasattr(kind, "__del__") for kind in kinds)  # such as an open port
    if weakref.getweakrefcount(instance) <= known and not ends:
        return lambda: instance
    try:
        return weakref.ref(instance)
    except TypeError:
        return lambda: None


def _note_made(owner: type, note: Callable[[Any], None]) -> None:
    """Call ``note`` with each object of a class once it has been made."""

    def handle(wrapped: Any, instance: Any, args: Any, kwargs: Any) -> Any:
        __tracebackhide__ = True
        result = wrapped(*args, **kwargs)
        note(instance)
        return result

    with contextlib.suppress(AttributeError, TypeError):  # a type written in C
        original = vars(owner).get("__init__") or _inherited(owner)
        setattr(owner, "__init__", wrapt.FunctionWrapper(original, handle))  # noqa: B010  # mypy: unsound


def _inherited(owner: Any) -> Callable[..., None]:
    """Return an ``__init__`` for a class without one, which calls the next in the resolution order."""

    def __init__(self: Any, *args: Any, **kwargs: Any) -> None:  # noqa: N807
        __tracebackhide__ = True
        kind: Any = type(self)
        following = super(owner, self).__init__
        if getattr(following, "__objclass__", None) is not object:
            following(*args, **kwargs)
        elif (args or kwargs) and kind.__new__ is object.__new__:
            raise TypeError(f"{kind.__name__}() takes no arguments")

    return __init__


class ClockReader:
    """Passes the calls of the clock's tick on to a meter.

    Args:
        clock: what the vocabulary says.
        meter: the meter of the running test; None between tests.
        on_problem: called with (key, text) where a call gives no time.
        on_tick: called with the simulated seconds of the running test after each call.
    """

    def __init__(
        self,
        clock: Clock,
        meter: Callable[[], Meter | None],
        on_problem: Callable[[str, str], None],
        on_tick: Callable[[float], None],
    ) -> None:
        self._clock, self._meter, self._on_problem, self._on_tick = clock, meter, on_problem, on_tick
        self._path = Path.parse(clock.time, rooted=clock.rooted)
        self._step = None if clock.step is None else convert(clock.step, clock.unit, "s")
        self._is_direct = not clock.time and self._step is None and clock.unit == "s"

    def handle(self, wrapped: Callable[..., Any], instance: Any, args: Any, kwargs: Any) -> Any:
        """Handle a call of the tick."""
        __tracebackhide__ = True
        result = wrapped(*args, **kwargs)
        if self._is_direct and type(result) is float and isfinite(result):  # the way of most simulators
            meter = self._meter()
            if meter is not None:
                meter.tick(result)
                self._on_tick(meter.simulated or 0.0)
        elif type(result) is CoroutineType:  # nothing has happened yet
            return self._awaited(result, wrapped, instance, args, kwargs)
        else:
            self._observe(result, wrapped, instance, args, kwargs)
        return result

    async def _awaited(self, result: Any, *call: Any) -> Any:
        __tracebackhide__ = True
        result = await result
        self._observe(result, *call)
        return result

    def _observe(self, result: Any, *call: Any) -> None:
        __tracebackhide__ = True
        meter = self._meter()
        if meter is None:
            return
        if self._step is not None:
            meter.advance(self._step)
        elif (time := self._time(result, *call)) is not None:
            meter.tick(time)
        else:
            return
        self._on_tick(meter.simulated or 0.0)

    def _time(self, result: Any, *call: Any) -> float | None:
        """Return simulated time (s) after the call; None, with a problem reported, if there is none."""
        try:
            value = self._path.get(self._start(*call) if self._path.root is not None else result)
        except PathError as error:
            self._wrong(str(error))
            return None
        try:
            number = float(value)
        except Exception:  # an object of the user's may fail in any way
            number = float("nan")
        if not isfinite(number):
            where = (
                f"the path {self._clock.time!r}" if self._clock.time else f"what {self._clock.tick} returns"
            )
            self._wrong(f"{where} gives {reprlib.repr(value)}, which is not a number")
            return None
        return convert(number, self._clock.unit, "s")

    def _start(self, *call: Any) -> Any:
        """Return the object or argument at which the path begins. Raises PathError if there is none."""
        wrapped, instance, args, kwargs = call
        invocation = Invocation(bound(wrapped, instance), instance, args, kwargs)
        invocation.bind(signature_of(invocation.wrapped) or ANYTHING)
        start, known = invocation.start_of(self._path), tuple(invocation.values or ())
        root = self._path.root or ""
        if start is None and root not in known:
            of_call = f"has no argument {root!r}; it has {', '.join(known)}"
            why = "is not a method, so it has no self" if root == "self" else of_call
            raise PathError(f"{self._clock.tick} {why}", step=root, known=known)
        return start

    def _wrong(self, text: str) -> None:
        self._on_problem(
            "time", f"{text}; name a path that gives the time as a number, or write step = … instead"
        )


@dataclass(slots=True)
class ProgramTime:
    """The time of the running test.

    Attributes:
        vocabulary: names the clock, and what lets time pass.
        meter: the meter of the running test; None between tests.
        instances: the objects that the program uses.
    """

    vocabulary: Vocabulary
    meter: Callable[[], Meter | None]
    instances: Instances

    def now(self) -> float:
        """Return simulated seconds since the test's first tick, 0 before. Raises LookupError."""
        meter = self.meter()
        if self.vocabulary.clock is None or meter is None:
            raise LookupError("the vocabulary names no clock")
        return meter.simulated or 0.0

    def now_if_known(self) -> float | None:
        """Return the simulated time in seconds; None without a clock."""
        return self.now() if self.vocabulary.clock is not None and self.meter() is not None else None

    async def wait(self, seconds: float) -> None:
        """Let some seconds pass. Raises LookupError if the vocabulary does not say how."""
        wait = self.vocabulary.wait
        if wait is None:
            raise LookupError("the vocabulary does not say what lets the program's time pass (wait = …)")
        module, _, qualname = wait.target.partition(":")
        found: Any
        if module not in sys.modules:
            raise LookupError(f"{module}, which lets the program's time pass, is not imported")
        owner, name, found = resolve(sys.modules[module], qualname)
        if isinstance(owner, type):
            objects = self.instances.of(of := wait.target.rpartition(".")[0])
            if not objects:
                raise LookupError(f"the program has no object of {of}, which lets its time pass")
            found = getattr(objects[-1], name)
        waited = found(convert(seconds, "s", wait.unit))
        if inspect.isawaitable(waited):
            await waited
