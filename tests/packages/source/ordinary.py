# ruff: noqa
"""What a program may do that an instrumentation could break; ``results`` says what came of it."""

from __future__ import annotations

import asyncio
import inspect
import pickle
from collections.abc import AsyncIterator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import Enum, Flag, auto

LOG: list[object] = []
HEIGHT = 0.29
PLACES = {"red": (-0.4, 0.15), "blue": (-0.4, 0.4)}
TABLE = [[row * 3 + column for column in range(3)] for row in range(3)]


def note(value, result=None):
    """Say that it is evaluated, now."""
    LOG.append(value)
    return value if result is None else result


class Colour(Enum):
    """Values that are made while the class is."""

    RED = 1
    BLUE = RED + 1


class Mode(Flag):
    SLOW = auto()
    FINE = auto()
    BOTH = SLOW | FINE


class Base:
    """A class with slots and private names."""

    __slots__ = ("__speed", "height")
    limit = 3 - 1
    limits = tuple(number * 2 for number in range(limit + 1))

    def __init__(self, height, speed=1 + 1):
        self.height = height
        self.__speed = -speed

    def speed(self):
        return self.__speed if self.height > 0 else -self.__speed


class Child(Base):
    def speed(self):
        factor = 2
        return super().speed() * factor + len([__class__ for _ in range(1)])


@dataclass(order=True)
class Point:
    x: float = 0.5 - 0.25
    y: float = field(default=-1.5, compare=False)
    count: int | None = None


def times(factor):
    def decorate(function):
        def wrapped(*args, **kwargs):
            return function(*args, **kwargs) * factor

        return wrapped

    return decorate


@times(1 + 2)
def decorated(a, b=2 * 3, *rest, c=HEIGHT > 0, **more):
    return a + b + sum(rest) + c + len(more)


def chains(a, b, c):
    return note(a) < note(b) <= note(c) != note(7), note(a) > note(b) > note(c)


def short_circuits(a, b):
    first = note("a", a) and note("b", b)
    second = note("c", a) or note("d", b) or note("e")
    return first, second, not (a and b), a if note(a < b) else b


def walrus(values):
    if (size := len(values)) > 2 and (last := values[-1]) != 0:
        return size - last, [half for value in values if (half := value // 2) > 0], half
    return size


def formatted(x, width):
    return f"{x + 1:>{width * 2}} {x!r} {-x=} {'in' + 'ner'} {x + 1:>{width * 2}} {{}} {f'{x - 1}'}"


def comprehensions(n):
    squares = [i * i for i in range(n) if i % 2 == 0]
    pairs = {i: j + n for i in range(n) for j in range(i) if i > j}
    return squares, pairs, {i ^ n for i in range(n)}, sum(i << 1 for i in range(n)), locals().keys() >= {"n"}


def generator(n) -> Iterator[int]:
    got = yield n + 1
    while (got or 0) > 0:
        got = yield -got
    yield from (i + n for i in range(2))
    return n - 1


def augmented():
    box = {"a": 1, "b": 2}
    box[note("b")] += note(5) * 2
    box["a"] <<= 3
    values = [1, 2]
    values += [3]
    values[note(0)] -= 1
    total = 10
    total //= 3
    total **= 2
    total |= 6
    return box, values, total


def scopes():
    count = 0

    def inner():
        nonlocal count
        global HEIGHT
        count += 1
        HEIGHT = HEIGHT + 0.0
        return sorted(locals())

    names = inner()
    return count, names, (lambda x, y=count + 1: x - y)(5)


def patterns(value):
    match value:
        case 0 | -1:
            return "none"
        case [first, *rest] if first > 0 and len(rest) < 3:
            return first - len(rest)
        case {"x": x, **others}:
            return x + len(others)
        case Point(x=0.25) | Colour.RED:
            return "named"
        case str() as text if not text:
            return "empty"
    return -1


def exceptions(divisor):
    found = []
    try:
        found.append(1 / divisor)
    except ZeroDivisionError as error:
        found.append(type(error).__name__ + "!")
    else:
        found.append(divisor > 0)
    finally:
        found.append(len(found) + 1)
    try:
        raise ExceptionGroup("several", [ValueError(1), KeyError(-2)])
    except* ValueError as group:
        found.append(len(group.exceptions))
    except* KeyError:
        found.append(-1)
    for number in found:
        if number is None:
            break
    else:
        found.append(not found)
    return found


@contextmanager
def held(name):
    note(f"+{name}")
    try:
        yield name * 2
    finally:
        note(f"-{name}")


def stars(*args, **kwargs):
    first, *middle, last = (*args, *[1 + 1])
    with held("a") as a, held(a + "b") as b:
        return first - last, [*middle, -last], {**kwargs, "n": len(kwargs) + 1}, b


async def waits(n):
    await asyncio.sleep(0)
    return n - 1


async def ticks(n) -> AsyncIterator[int]:
    for i in range(n):
        yield i * (await waits(n))


async def asynchronous():
    values = [value + 1 async for value in ticks(3)]
    return (await waits(3)) * 2, values, [await waits(i) for i in range(2) if await waits(i) >= 0]


def late(items):
    position = -1
    while True:
        position += 1
        if position >= len(items):
            break
        if items[position] == 0:
            continue
        del items[position]
        assert position >= 0, "never"
    return items, position


def talk(generator_):
    said = [next(generator_), generator_.send(4), generator_.send(0)]
    return said + list(generator_)


def annotated(x: int | None = None, *, y: list[int] = ()) -> dict[str, int | float]:
    z: int = -1 if x is None else x
    w: "str | None"
    return {"z": z, "hints": len(annotated.__annotations__) + len(y)}


def results():
    LOG.clear()
    return {
        "chains": (chains(1, 2, 2), chains(3, 2, 1), chains(2, 1, 0)),
        "short": [short_circuits(a, b) for a in (0, 3) for b in (0, 4)],
        "walrus": (walrus([4, 5, 6]), walrus([1])),
        "formatted": formatted(3, 4),
        "comprehensions": comprehensions(5),
        "generator": talk(generator(3)),
        "augmented": augmented(),
        "scopes": scopes(),
        "patterns": [
            patterns(value)
            for value in (0, -1, [3, 4], [0, 1], {"x": 2, "y": 3}, Point(), Colour.RED, "", "text")
        ],
        "exceptions": [exceptions(2), exceptions(0)],
        "stars": stars(5, 6, 7, k=1),
        "async": asyncio.run(asynchronous()),
        "late": late([1, 0, 2, 0]),
        "annotated": (annotated(), annotated(3, y=[1]), annotated.__annotations__),
        "classes": (
            Child(2).speed(),
            Base(0).speed(),
            Base.limits,
            [*Colour],
            Mode.BOTH.value,
            Child.__slots__ if "__slots__" in vars(Child) else None,
        ),
        "points": (Point() < Point(x=1.0), Point(), Point.__annotations__),
        "decorated": (decorated(1), decorated(1, 2, 3, c=-1, d=4)),
        "tables": (TABLE, PLACES, HEIGHT),
        "documentation": (note.__doc__, Base.__doc__, __doc__),
        "source": inspect.getsource(note),
        "lines": [function.__code__.co_firstlineno for function in (chains, late, Base.speed, waits)],
        "names": sorted(name for name in globals() if name not in ("__builtins__", "__cached__")),
        "variables": [
            (function.__code__.co_varnames, function.__code__.co_freevars, function.__code__.co_cellvars)
            for function in (chains, scopes, Child.speed, Base.__init__)
        ],
        "kinds": (inspect.isgeneratorfunction(generator), inspect.iscoroutinefunction(waits)),
        "pickle": pickle.loads(pickle.dumps(LOG[:3])),
        "log": list(LOG),
    }
