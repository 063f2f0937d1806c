"""Observes the calls in some files of a process: which callables, middleware names and values.

Every call, and every attribute that is read, comes here first. Nothing changes that the program can see.
"""

from __future__ import annotations

import inspect
import os
import re
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass, field, is_dataclass, replace
from fnmatch import fnmatchcase
from functools import cache, cached_property, lru_cache, partial
from types import BuiltinFunctionType, FunctionType, ModuleType
from typing import Any

from mutabot.api.processes import CallOrigin, Observer
from mutabot.api.values import Form
from mutabot_init.observations import Command, Use, Values, WatchedCallable, WatchedCalls
from mutabot_init.proposers import brought_proposers
from mutabot_init.watching.callee import (
    Callee,
    any_method,
    assigned_by,
    class_name,
    described,
    function_of,
    method_of,
    replaced_method,
)
from mutabot_init.watching.values import look, plain
from mutabot_init.words import words_of

#: calls of one callable whose values are looked at; more are only counted
MOST_CALLS = 300
#: functions of which it is remembered what they are
_MOST_FUNCTIONS = 1000
#: packages that talk to no robot
_NO_ROBOTS = frozenset(
    {
        "_pytest", "pytest", "pluggy", "mutabot", "numpy", "scipy", "pandas", "matplotlib", "hypothesis",
        "yaml", "loguru", "attr", "attrs", "pydantic", "typing_extensions", "torch", "jax", "sympy", "rich",
        "networkx", "click", "typer", "PIL", "casadi", "ikpy", "kinpy", "math3d", "modern_robotics",
        "pinocchio", "pyquaternion", "pytransform3d", "quaternion", "ruckig", "spatialmath",
        "tf_transformations", "toppra", "transformations", "transforms3d", "trimesh",
    }
)  # fmt: skip
#: names of arguments that distinguish commands
_DISTINGUISHING = frozenset(
    {
        "node", "node_id", "nodeid", "name", "address", "register", "tag", "channel", "signal", "topic",
        "variable", "topic_name", "service", "service_name", "url", "endpoint",
    }
)  # fmt: skip
_TALKS = frozenset({"read", "write", "get", "set", "send", "publish", "call", "post", "put", "patch"})
#: how addresses in a controller look: ``Y10``, ``%MW4``, ``DB1.DBX0.2``
_ADDRESS = re.compile(r"%?[A-Z]{1,3}\d[\w.:,]*")
#: a measure in the text of an object, which is its state: ``<Motor elbow pos=12.5>``, unlike ``DB1.DBX0.2``
_DECIMAL = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.])")
#: more commands than these, and longer texts, are no list of commands
_MOST_COMMANDS, _LONGEST = 24, 60
#: a larger key is the address of something, and no index
_MOST_ELEMENTS = 255


@dataclass(slots=True)
class _Seen:
    """A callable and its observations."""

    callee: Callee
    call: WatchedCallable
    #: how many calls each path distinguishes, and their commands
    counts: Counter[str] = field(default_factory=Counter)
    commands: dict[str, dict[str, Command]] = field(default_factory=dict)
    has_no_commands: bool = False


#: the calls that are under way here, the outermost first
_under_way: ContextVar[tuple[_Seen, ...]] = ContextVar("mutabot_watched_calls", default=())


#: uses of one name whose messages are looked at; more are only counted
_MOST_USES = 300
#: forms that bring no answer
_UNANSWERED = frozenset({Form.PUBLISH, Form.GOAL})


class Watch(Observer):
    """The observations of the calls in some files, and of uses of middleware names."""

    def __init__(self, libraries: Sequence[str], is_test: Callable[[str], bool | None]) -> None:
        super().__init__(libraries, is_test)
        self._seen: dict[tuple[str, bool, bool], _Seen] = {}
        self._method_of = cache(method_of)
        self._function_of = lru_cache(_MOST_FUNCTIONS)(function_of)
        self._classes_named = cache(_classes_named)
        self._is_fake_class = cache(self._is_of_test_side)
        self._is_property = cache(_is_property)
        self._uses: dict[tuple[Form, str, bool, bool], Use] = {}
        self._lock = threading.RLock()
        self._beside = {name: proposer.watch() for name, proposer in brought_proposers().items()}

    def called(self, name: str, found: Any, receiver: Any, caller: CallOrigin) -> Any:
        """Return what is called in the place of ``found``, which was read from ``receiver``."""
        if isinstance(found, type):
            return found
        with suppress(Exception):  # looking at objects must not disturb the program
            callee = self._function(found) if receiver is None else self._method(receiver, name)
            if receiver is not None and not caller.is_test:
                callee = self._replaced_callee(receiver, name, callee, found)
            seen = self._of(callee, caller)
            if not caller.is_test and (_is_mock(found) or _is_mock(receiver) or self._is_fake(receiver)):
                for one in (*_under_way.get(), *filter(None, [seen])):
                    one.call.reaches = True
            return self._wrapped(found, seen, caller)
        return found

    def read(self, name: str, found: Any, receiver: Any, caller: CallOrigin) -> None:
        """Record that an attribute was read from ``receiver``."""
        with suppress(Exception):  # as above
            kind: Any = type(receiver)
            if self._is_property(kind, name):
                seen = self._of(method_of(receiver, name), caller)
                if seen is not None and self._counts(seen, caller):
                    self._answer(seen, found)

    def assigned(self, name: str, receiver: Any, values: Sequence[Any], caller: CallOrigin) -> None:
        """Record what is assigned to a property, or to an item of an object that is no plain container."""
        with suppress(Exception):  # as above
            seen = self._of(assigned_by(receiver, name), caller)
            if seen is not None and self._counts(seen, caller):
                known = self._arguments(seen, tuple(values), {}, receiver)
                _command(seen, receiver, known)

    def used(
        self, form: Form, name: str, caller: CallOrigin | None, written: Sequence[Any], *, is_callback: bool
    ) -> Callable[[Any], None] | None:
        """Record a use of a name and the calls that lead to it; return a function for the value read."""
        for seen in _under_way.get():
            seen.call.leads_to_names = True
        if caller is None:
            return None
        with self._lock:
            key = (form, name, caller.is_test, is_callback)
            use = self._uses.setdefault(key, Use(*key))
            where = f"{caller.file}:{caller.line}"
            use.sites[where] = use.sites.get(where, 0) + 1
            if sum(use.sites.values()) > _MOST_USES:
                return None
        for message in written:
            self._look(use.written, message)
        return None if form in _UNANSWERED else partial(self._look, use.read)

    def _look(self, values: Values, value: Any) -> None:
        with self._lock, suppress(Exception):  # looking at values must not disturb the program
            look(values, value, message=True)

    def data(self) -> WatchedCalls:
        """Return the observations: callables, uses of names, and what other packages observed."""
        calls = [self._call(seen) for seen in list(self._seen.values())]
        beside = {name: seen() for name, seen in self._beside.items()}
        return WatchedCalls(calls, list(self._uses.values()), beside)

    def _is_of_tests(self, callee: Callee) -> bool:
        return self.is_test(callee.file) is True

    def _is_fake(self, value: Any) -> bool:
        """Return whether an object's class, or a class itself, is one of the tests."""
        return self._is_fake_class(value if isinstance(value, type) else type(value))

    def _is_of_test_side(self, kind: type) -> bool:
        module = sys.modules.get(kind.__module__)
        return self.is_test(os.path.realpath(getattr(module, "__file__", None) or "")) is True

    def _is_test_class(self, callee: Callee) -> bool:
        """Return whether it is a method of a class of tests, which the program may call back."""
        owner: Any = callee.owner
        unittest = sys.modules.get("unittest")
        if unittest is not None and issubclass(owner, unittest.TestCase):
            return True
        is_plain = owner.__init__ is object.__init__  # pytest collects no other class
        return is_plain and owner.__name__.startswith("Test") and self._is_of_tests(callee)

    def _method(self, value: Any, name: str) -> Callee | None:
        """Return a method by its name; cached for each class."""
        if inspect.ismodule(value) or isinstance(value, super) or name in getattr(value, "__dict__", ()):
            return method_of(value, name)
        return self._method_of(value if isinstance(value, type) else type(value), name)

    def _function(self, found: Any) -> Callee | None:
        """Return a function by its name; cached for those that are the same object at each call."""
        is_of_module = isinstance(found, BuiltinFunctionType) and isinstance(found.__self__, ModuleType)
        is_same = is_of_module or (isinstance(found, FunctionType) and found.__closure__ is None)
        return self._function_of(found) if is_same else function_of(found)

    def _replaced_callee(self, value: Any, name: str, callee: Callee | None, found: Any) -> Callee | None:
        """Return what a mock or fake replaces: the robot's callable, or any callable with its name."""
        if _is_mock(value):
            spelt = re.split(r"\W", value._extract_mock_name())[0]
            kinds = self._classes_named(spelt, name)
            if kinds and all(_is_no_robot(kind.__module__.partition(".")[0]) for kind in kinds):
                return None  # of an event, a thread, a socket
            kind = vars(value).get("_spec_class") or (kinds[0] if len(kinds) == 1 else None)
            return (replaced_method(kind, name) if kind is not None else None) or any_method(name)
        if _is_mock(found) and isinstance(value, type | ModuleType):
            where = f"{value.__name__}:" if isinstance(value, ModuleType) else f"{class_name(value)}."
            is_class = name[:1].isupper()
            return None if is_class else Callee(f"{where}{name}", None, None, "", stands_in=True)
        if callee is None and _is_mock(found):  # an attribute of an object that a test replaced
            kind = value if isinstance(value, type) else type(value)
            return replaced_method(kind, name) or any_method(name)
        if callee is None or callee.owner is None or not self._is_of_tests(callee):
            return callee
        if _is_no_robot(callee.owner.__module__.partition(".")[0]):
            return None  # a method of the standard library, which a test replaces
        meant = (replaced_method(kind, name) for kind in callee.owner.__mro__[1:-1])
        robots = next(
            (candidate for candidate in meant if candidate is not None and not self._is_of_tests(candidate)),
            None,
        )
        return robots or any_method(name, callee)

    def _of(self, callee: Callee | None, caller: CallOrigin) -> _Seen | None:
        """Return this side's observations of a callable; None if it is not a robot's."""
        if callee is None or (callee.owner is not None and self._is_test_class(callee)):
            return None
        key = (callee.target, caller.is_test, callee.is_set)
        known = self._seen.get(key)
        if known is None or (known.callee.raw is None and callee.raw is not None):
            top = callee.target.partition(":")[0].partition(".")[0]
            if _is_no_robot(top) or any(fnmatchcase(top, name) for name in self.libraries):
                return None
            call = described(callee, of_tests=key[1], own=self.is_test(callee.file) is False)
            call.sites = known.call.sites if known is not None else {}  # a mock has no others
            known = self._seen[key] = _Seen(callee, call)
        return known

    def _wrapped(self, function: Any, seen: _Seen | None, caller: CallOrigin) -> Any:
        if seen is None or not self._counts(seen, caller):
            return function

        instance = getattr(function, "__self__", None)

        def watched(*args: Any, **kwargs: Any) -> Any:
            command: Command | None = None
            with suppress(Exception):  # looking at values must not disturb the program
                values = self._arguments(seen, args, kwargs, instance)
                command = _command(seen, instance, values)
            with _making(seen):
                result = function(*args, **kwargs)
            if inspect.iscoroutine(result):
                self._check_coroutine(seen)
                return self._awaited(seen, command, result)
            self._answer(seen, result, command)
            return result

        return watched

    async def _awaited(self, seen: _Seen, command: Command | None, waiting: Any) -> Any:
        with _making(seen):
            result = await waiting
        self._answer(seen, result, command)
        return result

    def _check_coroutine(self, seen: _Seen) -> None:
        raw = seen.callee.raw
        if not seen.call.stands_in and not inspect.iscoroutinefunction(getattr(raw, "__func__", raw)):
            text = "it returns a coroutine but is not a coroutine function: name the one behind it"
            seen.call.problem = text

    def _counts(self, seen: _Seen, caller: CallOrigin) -> bool:
        """Count a call; return whether its values are to be recorded."""
        if seen.call.of_tests and (seen.call.own or self._is_of_tests(seen.callee)):
            return False
        where = f"{caller.file}:{caller.line}"
        seen.call.sites[where] = seen.call.sites.get(where, 0) + 1
        return seen.call.count <= MOST_CALLS

    def _arguments(
        self, seen: _Seen, args: tuple[Any, ...], kwargs: dict[str, Any], instance: Any
    ) -> dict[str, Any]:
        """Record the arguments of a call, and return those that it is given under a known name."""
        values, signature, call = dict(kwargs), seen.callee.signature, seen.call
        given = {*kwargs}
        if signature is None:
            for index, value in enumerate(args):
                look(call.positional, value, f"#{index}")
        else:
            try:
                bound = signature.bind(*args, **kwargs)
            except TypeError:
                return {}
            given.update(bound.arguments)
            bound.apply_defaults()
            values = dict(bound.arguments)
            for name, parameter in signature.parameters.items():
                if parameter.kind is inspect.Parameter.VAR_KEYWORD:
                    values.update(values.pop(name, {}))
        for name, value in values.items():
            known = call.arguments.setdefault(name, Values())
            look(known, value, name)
            limits = _limits(value, instance) if "step" in call.name else None
            for part in known.parts.values():
                if part.length is not None and limits is not None and len(limits) == part.length:
                    part.limits = limits
        return {name: value for name, value in values.items() if name in given}

    def _answer(self, seen: _Seen, result: Any, command: Command | None = None) -> None:
        with suppress(Exception):
            look(seen.call.result, result)
            if command is not None:
                look(command.result, result)

    def _call(self, seen: _Seen) -> WatchedCallable:
        """Return a callable with the exceptions it raised on either side: tests make robots refuse."""
        sides = (self._seen.get((seen.call.target, of_tests, seen.call.is_set)) for of_tests in (False, True))
        raised = dict.fromkeys(
            name for side in (seen, *sides) if side is not None for name in side.call.raised
        )
        return replace(seen.call, raised=list(raised))


@contextmanager
def _making(seen: _Seen) -> Iterator[None]:
    """Record that a call is in progress, and what it raises."""
    token = _under_way.set((*_under_way.get(), seen))
    try:
        yield
    except Exception as error:
        name = class_name(type(error))
        if name not in seen.call.raised:
            seen.call.raised.append(name)
        raise
    finally:
        with suppress(ValueError):  # a coroutine that is closed from elsewhere
            _under_way.reset(token)


def _is_property(kind: type, name: str) -> bool:
    return isinstance(inspect.getattr_static(kind, name, None), property | cached_property)


def _classes_named(name: str, method: str) -> list[type]:
    """Return the classes that a mock with this name may replace: those so named with such a method."""
    kinds = {
        id(kind): kind
        for module in list(sys.modules.values())
        for kind in [getattr(module, "__dict__", {}).get(name)]
        if isinstance(kind, type) and kind.__name__ == name and callable(getattr(kind, method, None))
    }
    return list(kinds.values())


def _limits(value: Any, instance: Any) -> list[list[float]] | None:
    """Return the limits of an action, as the environment or the simulated model gives them."""
    space: Any = getattr(instance, "action_space", None)
    if hasattr(space, "low") and hasattr(space, "high"):
        pairs = zip(plain(space.low), plain(space.high), strict=True)
        return [[float(low), float(high)] for low, high in pairs]
    model = getattr(value, "model", None) if type(value).__name__ == "MjData" else None
    return plain(model.actuator_ctrlrange) if model is not None else None


def _command(seen: _Seen, instance: Any, values: Mapping[str, Any]) -> Command | None:
    """Return a call's command, by the node, register or name that identifies it; None if nothing does."""
    call = seen.call
    if seen.has_no_commands:
        return None
    by, text, beside = _identify_command(call, instance, values)
    seen.counts[by] += 1
    commands = seen.commands.setdefault(by, {})
    if len(text) > _LONGEST or len(commands) > _MOST_COMMANDS:
        seen.has_no_commands, call.discriminator, call.commands = True, "", {}
        return None
    # a list of several names, where most calls have one, does not hide what these write
    most = max(seen.counts, key=seen.counts.__getitem__)
    is_clear = 2 * seen.counts[most] > seen.counts.total()
    call.discriminator, call.commands = (most, seen.commands[most]) if most and is_clear else ("", {})
    call.other_commands = seen.counts.total() - seen.counts[most]
    if not by:
        return None
    command = commands.setdefault(text, Command())
    for path, value in beside.items():
        look(command.arguments.setdefault(path, Values()), value, path)
    return command


#: what distinguishes a command: its path and text, and the values beside it by their paths
_CallFacts = tuple[str, str, Mapping[str, Any]]


def _identify_command(call: WatchedCallable, instance: Any, values: Mapping[str, Any]) -> _CallFacts:
    """Return what identifies a command; an empty path if nothing does."""
    is_item = call.name == "__setitem__"
    if not (is_item or call.is_set or _TALKS & set(words_of(call.name))):
        return "", "", {}
    for name, value in values.items():
        beside = {key: known_value for key, known_value in values.items() if key != name}
        if is_item:
            return (name, str(value), beside) if _is_address(value) else ("", "", {})
        is_plain = isinstance(value, str | int) and not isinstance(value, bool)
        is_address = isinstance(value, str) and _ADDRESS.fullmatch(value) is not None
        if is_address or (_distinguishes(name.lower()) and (is_plain or _has_distinct_name(value))):
            return name, str(value), beside
        pair = _pair(name, value)
        if pair is not None:
            path, text, written = pair
            return f"{path}[0]", text, {f"{path}[1]": written}
    return ("self", str(instance), values) if _has_distinct_name(instance) else ("", "", {})


def _distinguishes(name: str) -> bool:
    return name in _DISTINGUISHING or name.endswith(("address", "register", "topic"))


def _is_address(key: Any) -> bool:
    """Return whether a key names a tag or an object, rather than an element of a list."""
    return isinstance(key, str) or (type(key) is int and key > _MOST_ELEMENTS)


def _pair(path: str, value: Any) -> tuple[str, str, Any] | None:
    """Return the first pair of a name and a value written under it: its path, the name and the value."""
    if not isinstance(value, tuple | list) or not value:
        return None
    if len(value) == 2 and isinstance(value[0], str) and not isinstance(value[1], str | tuple):
        return path, value[0], value[1]
    return _pair(f"{path}[0]", value[0])


def _has_distinct_name(value: Any) -> bool:
    """Return whether an object is printed as a distinct name, as a node is by its id."""
    kind: Any = type(value)
    prints = kind.__str__ is not object.__str__ or kind.__repr__ is not object.__repr__
    if value is None or not prints or not hasattr(value, "__dict__") or is_dataclass(value):
        return False
    text = str(value)
    return "\n" not in text and " object at " not in text and _DECIMAL.search(text) is None


def _is_mock(value: Any) -> bool:
    """Return whether a value is a mock, whatever class it claims to have."""
    module = sys.modules.get("unittest.mock")
    return module is not None and issubclass(type(value), module.NonCallableMock)


def _is_no_robot(top: str) -> bool:
    """Return whether nothing of a top-level package is a call of a robot."""
    return top in sys.stdlib_module_names or top in _NO_ROBOTS or top.startswith("pytest")
