"""What edited copies of a project call for faults of the catalogue: plain functions, without Mutabot.

The judge puts this file beside the copy as ``_planted_catalogue.py``. What a fault remembers it remembers for
one test, by the name that pytest gives it.
"""

from __future__ import annotations

import copy
import importlib
import inspect
import math
import os
import random
from collections.abc import Callable, Sequence
from typing import Any

from _planted import changed, each, skipped  # type: ignore[import-not-found]

Change = Callable[[Any], Any]

_RANDOM = random.Random(int(os.environ.get("JUDGE_NOISE", "1")))
_STATES: dict[tuple[str, str], list[Any]] = {}


def state(key: str) -> list[Any]:
    """What is remembered under a key in the running test."""
    test = os.environ.get("PYTEST_CURRENT_TEST", "").rpartition(" (")[0]
    return _STATES.setdefault((test, key), [])


# changes of one value


def scaled(factor: float, value: Any) -> Any:
    """So many times a number."""
    return each(lambda number: _like(number, number * factor), value)


def added(amount: float, value: Any) -> Any:
    """So much more than a number."""
    return each(lambda number: _like(number, number + amount), value)


def limited(low: float, high: float, value: Any) -> Any:
    """A number within limits."""
    return each(lambda number: _like(number, min(max(number, low), high)), value)


def half_of_the_way(low: float, high: float, value: Any) -> Any:
    """Half way between a number and the end that is farther off."""
    far = low if abs(value - low) >= abs(value - high) else high
    return _like(value, (value + far) / 2)


def if_allowed(low: float, high: float, change: Change, value: Any) -> Any:
    """A change that is made only where it stays within limits."""
    after = change(value)
    parts = after if isinstance(after, list | tuple) else [after]
    return after if all(low <= part <= high for part in parts) else value


def moved_scalar(is_scalar_first: bool, numbers: Any) -> Any:
    """A quaternion whose scalar part is taken to be at the other end."""
    parts = list(numbers)
    parts = [parts[-1], *parts[:-1]] if is_scalar_first else [*parts[1:], parts[0]]
    return _filled(numbers, parts)


def turned_along(numbers: Any) -> Any:
    """Degrees about the axes x, y and z, one after the other, as if the axes turned along."""
    a, b, c = (math.radians(number) for number in numbers)
    # of the product of the turns about x, y and z, in this order, what tells its angles about fixed axes
    first = (math.cos(b) * math.cos(c), -math.cos(b) * math.sin(c), math.sin(b))
    second = math.sin(a) * math.sin(b) * math.cos(c) + math.cos(a) * math.sin(c)
    third = (
        -math.cos(a) * math.sin(b) * math.cos(c) + math.sin(a) * math.sin(c),
        math.cos(a) * math.sin(b) * math.sin(c) + math.sin(a) * math.cos(c),
        math.cos(a) * math.cos(b),
    )
    angles = (math.atan2(third[1], third[2]), math.asin(-third[0]), math.atan2(second, first[0]))
    return _filled(numbers, [math.degrees(angle) for angle in angles])


def with_signs(signs: Sequence[int], numbers: Any) -> Any:
    """Numbers of which some have the other sign."""
    return _filled(numbers, [sign * number for sign, number in zip(signs, numbers, strict=True)])


def _filled(like: Any, parts: Sequence[float]) -> Any:
    if isinstance(like, list | tuple):
        return type(like)(parts)
    clone = copy.copy(like)
    clone[:] = parts
    return clone


def nothing(value: Any) -> Any:
    """No number."""
    return each(lambda _: math.nan, value)


def old(key: str, age: int, value: Any) -> Any:
    """The value of so many calls ago, if there were so many."""
    seen = state(key)
    seen.append(copy.copy(value))
    return seen[-1 - age] if len(seen) > age else value


def stuck(key: str, value: Any) -> Any:
    """The first value."""
    seen = state(key)
    seen.append(copy.copy(value))
    return seen[0]


def saturated(key: str, value: Any) -> Any:
    """Not more than 80 % of the size of the first value."""
    seen = state(key)
    seen.append(0.8 * abs(value))
    return min(max(value, -seen[0]), seen[0])


def spiked(limits: tuple[float, float] | None, value: Any) -> Any:
    """Ten times a number, or the end of its range that is farther off."""
    if limits is None:
        return each(lambda number: _like(number, 10 * number), value)
    low, high = limits
    return each(lambda number: low if number - low > high - number else high, value)


def now_and_then(share: float, change: Change, value: Any) -> Any:
    """A change that is made by chance."""
    return change(value) if _RANDOM.random() < share else value


def _like(before: Any, after: Any) -> Any:
    whole = isinstance(before, int) and not isinstance(before, bool) and float(after).is_integer()
    return int(after) if whole else after


# changes of several values: from a list of them to another


def exchanged(values: list[Any]) -> list[Any]:
    """Two values in each other's place."""
    return [values[1], values[0]]


def negated(values: list[Any]) -> list[Any]:
    """All of them with the other sign."""
    return [each(lambda number: -number, value) for value in values]


def all_if_allowed(limits: Sequence[Any], change: Change, values: list[Any]) -> list[Any]:
    """A change that is made only where all values stay within their limits."""
    after = change(values)
    ranges = zip(after, limits, strict=True)
    allowed = all(limit is None or limit[0] <= value <= limit[1] for value, limit in ranges)
    return after if allowed else values  # type: ignore[no-any-return]


def along_tool(pose: Callable[[], Any]) -> Change:
    """A move whose components are along the axes of a tool with this pose."""

    def turned(values: list[float]) -> list[float]:
        here = pose()
        a, b, c = (math.radians(angle) for angle in (here.theta_x, here.theta_y, here.theta_z))
        x, y, z = values
        y, z = y * math.cos(a) - z * math.sin(a), y * math.sin(a) + z * math.cos(a)
        x, z = x * math.cos(b) + z * math.sin(b), -x * math.sin(b) + z * math.cos(b)
        x, y = x * math.cos(c) - y * math.sin(c), x * math.sin(c) + y * math.cos(c)
        return [x, y, z]

    return turned


# changes of functions


def around(function: Any, prepare: Change, finish: Change) -> Any:
    """``function`` with its arguments changed on the way there and its answer on the way back.

    ``prepare`` gets and gives the bound arguments.
    """

    def prepared(given: Any, named: Any) -> Any:
        bound = inspect.signature(function).bind(*given, **named)
        bound.apply_defaults()
        return prepare(bound)

    if not inspect.iscoroutinefunction(function):

        def called(*given: Any, **named: Any) -> Any:
            bound = prepared(given, named)
            return finish(function(*bound.args, **bound.kwargs))

        return called

    async def awaited(*given: Any, **named: Any) -> Any:
        bound = prepared(given, named)
        return finish(await function(*bound.args, **bound.kwargs))

    return awaited


def rewriting(function: Any, paths: Sequence[tuple[str, str]], change: Change) -> Any:
    """``function`` with several of its arguments, or parts of them, changed together."""

    def prepare(bound: Any) -> Any:
        before = [_part(bound.arguments[root], path) for root, path in paths]
        if any(value is None for value in before):
            return bound
        for (root, path), value in zip(paths, change(before), strict=True):
            bound.arguments[root] = changed(path, lambda _, new=value: new, bound.arguments[root])
        return bound

    return around(function, prepare, lambda answer: answer)


def rereading(function: Any, paths: Sequence[str], change: Change) -> Any:
    """``function`` with several parts of its answer changed together."""

    def finish(answer: Any) -> Any:
        before = [_part(answer, path) for path in paths]
        if any(value is None for value in before):
            return answer
        for path, value in zip(paths, change(before), strict=True):
            answer = changed(path, lambda _, new=value: new, answer)
        return answer

    return around(function, lambda bound: bound, finish)


def noted(key: str, function: Any, paths: Sequence[tuple[str, str]]) -> Any:
    """``function``, of which the next call knows what this one was told."""

    def prepare(bound: Any) -> Any:
        state(key).append([copy.copy(_part(bound.arguments[root], path)) for root, path in paths])
        return bound

    return around(function, prepare, lambda answer: answer)


def again(key: str, function: Any, paths: Sequence[tuple[str, str]]) -> Any:
    """``function`` told once more what the call before was told."""

    def prepare(bound: Any) -> Any:
        said = state(key)
        before = said[-1] if said else None
        said.append([copy.copy(_part(bound.arguments[root], path)) for root, path in paths])
        for (root, path), value in zip(paths, before or (), strict=before is not None):
            if value is not None:
                bound.arguments[root] = changed(path, lambda _, new=value: new, bound.arguments[root])
        return bound

    return around(function, prepare, lambda answer: answer)


def _part(value: Any, path: str) -> Any:
    found: list[Any] = []
    changed(path, lambda part: found.append(part) or part, value)
    return found[0] if found else None


def by_chance(share: float, function: Any, planted: Any) -> Any:
    """``planted`` by chance, else ``function``."""

    def called(*given: Any, **named: Any) -> Any:
        return (planted if _RANDOM.random() < share else function)(*given, **named)

    return called


def after_waiting(function: Any, wait: Callable[[], Any]) -> Any:
    """``function`` after a wait."""

    def prepare(bound: Any) -> Any:
        wait()
        return bound

    return around(function, prepare, lambda answer: answer)


def before_waiting(function: Any, wait: Callable[[], Any]) -> Any:
    """``function`` with a wait after it."""

    def finish(answer: Any) -> Any:
        wait()
        return answer

    return around(function, lambda bound: bound, finish)


def raising(function: Any, name: str) -> Any:
    """``function`` that raises an exception in the stead of its answer."""
    module, _, kind = name.partition(":")

    def finish(answer: Any) -> Any:
        raise getattr(importlib.import_module(module), kind)("planted")

    return around(function, lambda bound: bound, finish)


def swallowing(function: Any, names: Sequence[str], answer: Callable[[Any], Any]) -> Any:
    """``function`` that answers where it would raise one of these exceptions."""

    def called(*given: Any, **named: Any) -> Any:
        try:
            return function(*given, **named)
        except Exception as error:
            kinds = {f"{kind.__module__}:{kind.__qualname__}" for kind in type(error).__mro__}
            if not kinds & {*names}:
                raise
            return answer(getattr(function, "__self__", None))

    return called


# commands that are made after the next one


def held(function: Any, answer: Callable[[Any], Any]) -> Any:
    """``function`` that is only called after the next command."""
    later = skipped(function, answer)

    def called(*given: Any, **named: Any) -> Any:
        if state("due"):
            return then(function)(*given, **named)
        given, named = copy.deepcopy((given, named))
        state("due").append(lambda: function(*given, **named))
        return later(*given, **named)

    return called


def taken_back(function: Any, back: Callable[[Any, Any], Callable[[], Any] | None]) -> Any:
    """``function`` after whose next command ``back`` is done; ``back`` gets its arguments."""

    def called(*given: Any, **named: Any) -> Any:
        if state("due"):
            return then(function)(*given, **named)
        result = function(*given, **named)
        undo = back(given, named)
        if undo is not None:
            state("due").append(undo)
        return result

    return called


def then(function: Any) -> Any:
    """``function`` after which what is due is done."""

    def called(*given: Any, **named: Any) -> Any:
        result = function(*given, **named)
        due = state("due")
        waiting, due[:] = list(due), []
        for call in waiting:
            call()
        return result

    return called
