"""What edited copies of a project call: small faults as plain functions, written without Mutabot.

The judge puts this file beside the copy as ``_planted.py``; edits reach it by ``__import__("_planted")``.
"""

from __future__ import annotations

import copy
import dataclasses
import enum
import inspect
import os
import random
import re
from collections.abc import Callable, Sequence
from decimal import Decimal
from fractions import Fraction
from functools import partial
from typing import Any

Change = Callable[[Any], Any]

_STEP = re.compile(r"\.?(?P<name>[A-Za-z_]\w*)|\[(?P<low>-?\d*):(?P<high>-?\d*)\]|\[(?P<key>[^\]]+)\]")
_FIELD = re.compile(r"\{(\w+)(?::(\w))?\}")
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_RANDOM = random.Random(int(os.environ.get("JUDGE_NOISE", "1")))


def negative(value: Any) -> Any:
    """The negative of a number, or of each number of a vector; anything else as it is."""
    return each(lambda number: -number, value)


def negative_within(low: float, high: float, turn: float, value: Any) -> Any:
    """The negative where the range allows it, or once around where the range is a full turn."""

    def turned(number: float) -> float:
        for candidate in (-number, -number + turn, -number - turn) if turn else (-number,):
            if low <= candidate <= high:
                return candidate
        return number

    return each(turned, value)


def conjugate(order: str, value: Any) -> Any:
    """The quaternion of the inverse rotation."""
    items = [part if name == "w" else -part for name, part in zip(order, value, strict=True)]
    return type(value)(items) if isinstance(value, list | tuple) else type(value)(*items)


def noisy(deviation: float, value: Any) -> Any:
    """With Gaussian noise, whole numbers rounded; the judge looks at several draws."""

    def noised(number: Any) -> Any:
        drawn = _RANDOM.gauss(0.0, deviation)
        if isinstance(number, Decimal | Fraction):  # of its own kind
            return number + type(number)(drawn)
        return round(number + drawn) if isinstance(number, int) else number + drawn

    return each(noised, value)


def each(change: Change, value: Any) -> Any:
    """A number, or each number of a list, tuple or array, changed."""
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return value
    if isinstance(value, list | tuple):
        return type(value)(each(change, item) for item in value)
    if isinstance(value, int | float):
        return change(value)
    if hasattr(value, "dtype") and getattr(value, "ndim", 0) >= 1:
        return _array(change, value)
    return change(value)


def _array(change: Change, value: Any) -> Any:
    changed = value.copy()
    for index, item in enumerate(value):
        changed[index] = change(item)
    return changed


def other(pairs: dict[Any, Any], value: Any) -> Any:
    """The other of two states, or the next of some labels; a member of an enumeration gives one of it."""
    try:
        found = pairs.get(value, value)
    except TypeError:
        return value
    return type(value)(found) if isinstance(value, enum.Enum) else found


def changed(path: str, change: Change, value: Any) -> Any:
    """A copy of ``value`` in which the part at ``path`` is changed; nothing where there is no such part."""
    steps = list(_STEP.finditer(path))
    try:
        return _changed(steps, change, value)
    except (AttributeError, IndexError, KeyError):
        return value


def _changed(steps: list[re.Match[str]], change: Change, value: Any) -> Any:
    if not steps:
        return change(value)
    step, rest = steps[0], steps[1:]
    if step["name"]:
        part = getattr(value, step["name"])
        return _with_attribute(value, step["name"], _changed(rest, change, part))
    if step["low"] is not None:
        place: Any = slice(*(int(end) if end else None for end in (step["low"], step["high"])))
    else:
        key = step["key"]
        place = key[1:-1] if key[0] in "'\"" else int(key)
    return _with_item(value, place, _changed(rest, change, value[place]))


def _with_attribute(value: Any, name: str, part: Any) -> Any:
    if hasattr(value, "_replace"):
        return value._replace(**{name: part})
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return dataclasses.replace(value, **{name: part})
    clone = copy.copy(value)
    object.__setattr__(clone, name, part)
    return clone


def _with_item(value: Any, place: Any, part: Any) -> Any:
    if isinstance(value, tuple):
        items = list(value)
        items[place] = part
        return type(value)(*items) if hasattr(value, "_fields") else tuple(items)
    clone = copy.copy(value)
    clone[place] = part
    return clone


def with_argument(
    function: Any, name: str, path: str, change: Change, names: Sequence[str] | None = None
) -> Any:
    """``function`` with one of its arguments changed on the way; ``names`` of them, if it need not tell."""

    def called(*given: Any, **named: Any) -> Any:
        if names is not None and name not in named:
            index = names.index(name)
            given = (*given[:index], changed(path, change, given[index]), *given[index + 1 :])
            return function(*given, **named)
        if names is not None:
            return function(*given, **{**named, name: changed(path, change, named[name])})
        bound = inspect.signature(function).bind(*given, **named)
        if name not in bound.arguments:
            bound.apply_defaults()
        bound.arguments[name] = changed(path, change, bound.arguments[name])
        return function(*bound.args, **bound.kwargs)

    return called


def skipped(function: Any, answer: Callable[[Any], Any]) -> Any:
    """``function`` left out; ``answer`` is given what the function belongs to."""
    receiver = getattr(function, "__self__", None)
    if not inspect.iscoroutinefunction(function):
        return lambda *given, **named: answer(receiver)

    async def nothing(*given: Any, **named: Any) -> Any:
        return answer(receiver)

    return nothing


def twice(function: Any) -> Any:
    """``function`` called twice; the second answer counts."""
    if not inspect.iscoroutinefunction(function):

        def both(*given: Any, **named: Any) -> Any:
            function(*given, **named)
            return function(*given, **named)

        return both

    async def both_awaited(*given: Any, **named: Any) -> Any:
        await function(*given, **named)
        return await function(*given, **named)

    return both_awaited


def answering(function: Any, path: str, change: Change) -> Any:
    """``function`` with a part of its answer changed."""
    if not inspect.iscoroutinefunction(function):
        return lambda *given, **named: changed(path, change, function(*given, **named))

    async def answered(*given: Any, **named: Any) -> Any:
        return changed(path, change, await function(*given, **named))

    return answered


def only_for(function: Any, planted: Any, name: str, notation: str) -> Any:
    """``planted`` for messages that read like ``notation``, else ``function``."""

    def chosen(*given: Any, **named: Any) -> Any:
        text = inspect.signature(function).bind(*given, **named).arguments[name]
        return (planted if matched(notation, text) else function)(*given, **named)

    return chosen


def matched(notation: str, text: Any) -> re.Match[str] | None:
    """Whether a message reads like this notation, with its fields as groups."""
    if isinstance(text, bytes):
        text = text.decode("utf-8", "surrogateescape")
    if not isinstance(text, str):
        return None
    pieces, end = [], 0
    for found in _FIELD.finditer(notation):
        form = {"g": _NUMBER, "d": r"[-+]?\d+"}.get(found[2] or "", r".+?")
        pieces += [re.escape(notation[end : found.start()]), f"(?P<{found[1]}>{form})"]
        end = found.end()
    return re.fullmatch("".join([*pieces, re.escape(notation[end:])]), text)


def retold(notation: str, field: str, change: Change, text: Any) -> Any:
    """A message with the number in one field changed, in the same look."""
    found = matched(notation, text)
    if found is None:
        return text
    before = found[field]
    number = float(before)
    after = change(number)
    if after == number:
        return text
    if after == -number:
        written = before[1:] if before.startswith("-") else f"-{before.removeprefix('+')}"
    else:
        written = f"{after:g}"
    start, end = found.span(field)
    return _like(text, found.string[:start] + written + found.string[end:])


def told_as(notation: str, other_notation: str, text: Any) -> Any:
    """A message in another notation with the same fields."""
    found = matched(notation, text)
    if found is None:
        return text
    return _like(text, _FIELD.sub(lambda field: found[field[1]], other_notation))


def _like(message: Any, text: str) -> Any:
    """A text in the type of a message."""
    return text.encode("utf-8", "surrogateescape") if isinstance(message, bytes) else text


class PlantedError(Exception):
    """What is raised where an edit says so: no handler names it, and it is no built-in exception."""


def fail_on_zero(value: Any) -> Any:
    """The value, unless it is zero; an array is, if one of its elements is."""
    is_zero = value == 0
    if is_zero.any() if hasattr(is_zero, "any") else is_zero:
        raise PlantedError("a value is zero")
    return value


__all__ = ["partial"]
