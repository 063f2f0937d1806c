"""Records readings in a test, by lines that ``mutabot suggest`` adds to a copy of it.

A probe on ``values`` carries it out of the process. Nothing here ever lets a test fail.
"""

from __future__ import annotations

import functools
import inspect
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from . import tick_recorder
from .mocks import calls_of

#: parts that are noted of one reading, how deep, and how long a sequence may be
_PARTS, _DEPTH, _LENGTH = 24, 3, 8
#: characters of a text that may be a label
_LABEL = 60
#: s since 1970 of this century: when something ran is no reading of it
_DATES = 9e8, 4e9
_PLAIN = (bool, int, float, str, type(None))

_noted: dict[str, dict[str, Any]] = {}
#: what checks of the suite compared when they ran last in the running test, as in ``compared``
_compared: dict[str, dict[str, Any]] = {}


def note(
    names: Mapping[str, Any],
    readings: Sequence[tuple[str, Callable[[], Any]]] = (),
    classes: Sequence[str] = (),
    checks: Sequence[tuple[str, Callable[[], Any]]] = (),
) -> None:
    """Record all current readings.

    Args:
        names: what is at hand in the test, by name.
        readings: expressions of the program text, each with what evaluates it.
        classes: readings of objects, ``module:Class.name``: taken of each object at hand.
        checks: checks of other tests, by a key each, with the function that checks whether they hold: it
            raises AssertionError or returns a false value if they do not.
    """
    found: dict[str, Any] = dict(_compared.get(_test(), {}))
    for text, read in readings:
        found.update(_parts_of(text, read))
    for text, value in _at_hand(names):
        found.update(_parts_of(text, lambda value=value: value))  # type: ignore[misc]
        for more, read in _of_object(text, value, classes):
            found.update(_parts_of(more, read))
    for key, holds in checks:
        found.update(_held(key, holds))
    found.update(tick_recorder.recordings())
    for text, value in _held_by_own(names):  # last: a probe carries a limited number of parts
        found.update((key, part) for key, part in _state_of(text, value) if key not in found)
    for text, value in _at_hand(names):
        for call, given in _read(calls_of(text, value)):
            found.update(_parts_of_value(call, given))
    _noted.clear()
    _noted[_test()] = found


def _held(key: str, holds: Callable[[], Any]) -> dict[str, bool]:
    try:
        result = holds()
    except AssertionError:
        return {key: False}
    except Exception:  # what cannot be asked here is no check
        return {}
    return {key: result is None or bool(result)}


def compared(key: str, role: str, value: Any) -> Any:
    """Record a value that a check of the suite compares, and return it; ``role`` is its part in ``key``."""
    try:
        parts = [(f"{key}.{role}{text}", part) for text, part in _parts("", value, 1)]
    except Exception:  # only plain values can be compared with readings
        parts = []
    test = _test()
    if test not in _compared:
        _compared.clear()
    _compared.setdefault(test, {}).update(parts)
    return value


def tolerance_of(key: str) -> Any:
    """Return the tolerance that a check of the suite had in the running test. Raises KeyError."""
    return _compared[_test()][f"{key}.tolerance"]


def around(
    test: Callable[..., Any],
    begin: Callable[[Callable[[str], Any]], None],
    end: Callable[[Callable[[str], Any]], None],
    early: Mapping[str, str],
) -> Callable[..., Any]:
    """Wrap a test function with calls before and after it, which get the values of the test's fixtures.

    For tests that another tool makes, which have no text to add to.

    Args:
        begin: has only the fixtures that are watched; they are made before the test.
        end: has those that the test had.
        early: classes of fixtures by their names, as the module of the test names them.
    """
    own = inspect.signature(test)
    asks = [inspect.Parameter("request", inspect.Parameter.KEYWORD_ONLY)]
    if "request" in own.parameters:
        asks = []

    @functools.wraps(test)
    def with_end(**given: Any) -> None:
        request = given.pop("request") if asks else given["request"]
        module = vars(request.module)
        watched = {name for name, of in early.items() if tick_recorder.is_watched(module.get(of))}
        begin(lambda name: request.getfixturevalue(name) if name in watched else None)
        test(**given)
        had = request._fixture_defs  # no other fixture is to be made now
        end(lambda name: request.getfixturevalue(name) if name in had else None)

    with_end.__signature__ = own.replace(parameters=[*own.parameters.values(), *asks])  # type: ignore[attr-defined]
    return test if inspect.iscoroutinefunction(test) else with_end


def values() -> dict[str, Any]:
    """Return the readings recorded in the running test: expression to number, text or boolean."""
    return _noted.get(_test(), {})


def _test() -> str:
    return os.environ.get("PYTEST_CURRENT_TEST", "").rpartition(" ")[0]


def _at_hand(names: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for name, value in names.items():
        if name == "self":
            yield from ((f"self.{attribute}", held) for attribute, held in _attributes(value))
        elif not name.startswith(("_", "@")) and not isinstance(value, ModuleType | type):
            yield name, value


def _attributes(value: Any) -> Iterator[tuple[str, Any]]:
    """Yield an object's own public attributes; reading these runs none of the user's code."""
    try:
        held = dict(vars(value))
    except TypeError:
        return
    yield from ((name, attribute) for name, attribute in held.items() if not name.startswith("_"))


def _held_by_own(names: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield public attributes of what is at hand and has a class of the project, such as a fake robot."""
    for text, value in _at_hand(names):
        file = getattr(sys.modules.get(type(value).__module__), "__file__", None)
        if file is not None and Path(file).is_relative_to(Path.cwd()):
            yield from ((f"{text}.{name}", attribute) for name, attribute in _attributes(value))


def _state_of(text: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Yield the parts of an attribute, but none of a part of it: logs say more than a check should hold fast.

    Of a list of plain values also how long it is.
    """
    if isinstance(value, list) and value and all(type(item) in _PLAIN for item in value):
        yield f"len({text})", len(value)
    yield from _parts_of_value(text, value, 1).items()


def _read(found: Iterator[tuple[str, Any]]) -> list[tuple[str, Any]]:
    """Return what can be read before something fails: mocks may be set up to raise."""
    read: list[tuple[str, Any]] = []
    with suppress(Exception):
        read.extend(found)
    return read


def _of_object(text: str, value: Any, targets: Sequence[str]) -> Iterator[tuple[str, Callable[[], Any]]]:
    """Yield readings that the vocabulary names, of an available object or of one that it holds."""
    for where, held in (
        (text, value),
        *((f"{text}.{name}", attribute) for name, attribute in _attributes(value)),
    ):
        for target in targets:
            module, _, qualname = target.partition(":")
            owner, _, name = qualname.rpartition(".")
            known: Any = sys.modules.get(module)
            for part in owner.split("."):
                known = getattr(known, part, None)
            if isinstance(known, type) and isinstance(held, known):
                call = "()" if callable(getattr(known, name, None)) else ""
                yield f"{where}.{name}{call}", _reader(held, name, call=bool(call))


def _reader(held: Any, name: str, *, call: bool) -> Callable[[], Any]:
    return lambda: getattr(held, name)() if call else getattr(held, name)


def _parts_of_value(text: str, value: Any, depth: int = _DEPTH) -> dict[str, Any]:
    return _parts_of(text, lambda: value, depth)


def _parts_of(text: str, read: Callable[[], Any], depth: int = _DEPTH) -> dict[str, Any]:
    found: dict[str, Any] = {}
    try:
        whole = read()
        if inspect.iscoroutine(whole):  # it is not awaited here
            whole.close()
        for key, value in _parts(text, whole, depth):
            found[key] = value
            if len(found) >= _PARTS:
                break
    except Exception:  # what cannot be read is no reading
        return {}
    return found


def _parts(text: str, value: Any, depth: int) -> Iterator[tuple[str, Any]]:
    """Yield plain values within a value, each with the expression that reads it."""
    if isinstance(value, _PLAIN) and type(value) in _PLAIN:
        is_long = isinstance(value, str) and len(value) > _LABEL
        is_date = isinstance(value, float) and _DATES[0] < value < _DATES[1] and not value.is_integer()
        if not is_long and not is_date:
            yield text, value
        return
    if hasattr(type(value), "tolist") and getattr(value, "size", 0) <= _LENGTH:
        value = value.tolist()
        if not isinstance(value, list):  # one number
            yield from _parts(text, value, depth)
            return
    if depth == 0:
        return
    for path, item in _items(value):
        yield from _parts(f"{text}{path}", item, depth - 1)


def _items(value: Any) -> Iterator[tuple[str, Any]]:
    if hasattr(type(value), "_fields"):
        yield from ((f".{name}", getattr(value, name)) for name in value._fields)
    elif is_dataclass(value) and not isinstance(value, type):
        yield from ((f".{field.name}", getattr(value, field.name)) for field in fields(value))
    elif isinstance(value, Mapping):
        yield from ((f"[{_quoted(key)}]", item) for key, item in value.items() if isinstance(key, str | int))
    elif isinstance(value, list | tuple) and len(value) <= _LENGTH:
        yield from ((f"[{index}]", item) for index, item in enumerate(value))


def _quoted(key: str | int) -> str:
    return f'"{key}"' if isinstance(key, str) and '"' not in key and "\\" not in key else repr(key)
