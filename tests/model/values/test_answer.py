"""Answers by value: what comes back is equal, of the same type, and nobody else's."""

from __future__ import annotations

import array
import asyncio
import concurrent.futures
import enum
import json
import math
import threading
from collections import OrderedDict, deque, namedtuple
from collections.abc import Callable
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, ClassVar

import mujoco
import numpy as np
import pytest

from mutabot.model.answer import LIMIT, NotKeptError, keep, restore

Stamped = namedtuple("Stamped", "time pose")  # as users write them


class Colour(enum.Enum):
    RED = "r"


class Light(enum.Flag):
    RED = 1
    GREEN = 2
    BLUE = 4


@dataclass(frozen=True)
class Pose:
    x: float
    y: float = 0.0


@dataclass(frozen=True, slots=True)
class Small:
    x: float


@dataclass
class Made:
    parts: list[Pose] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.parts.append(Pose(9.0))  # must not happen once more


class Point:
    def __init__(self, x: float) -> None:
        self.x = x

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Point) and vars(self) == vars(other)

    __hash__ = None  # type: ignore[assignment]


class Slotted:
    __slots__ = ("__hidden", "x")

    def __init__(self) -> None:
        self.x, self.__hidden = 1, [2]

    @property
    def hidden(self) -> list[int]:
        return self.__hidden


class Arm:
    def __init__(self) -> None:
        self.x = 0.0


class Poses(list[Pose]):
    pass


class Guarded:
    def __copy__(self) -> Guarded:
        return self


class Proxy:
    """Answers to every name, as clients of remote calls do."""

    asked: ClassVar[list[str]] = []

    def __getattr__(self, name: str) -> Any:
        self.asked.append(name)
        return lambda *_: self


OK = Point(0.0)
VALUES = [
    None, True, 3, 0.1, "grün", b"\x00\xff", bytearray(b"ab"), (), (1, (2.5, "a")), [[1], []], {1, 2},
    frozenset({"a"}), deque([1, 2]), {"a": [1], 2: None, (1, 2): "b"}, OrderedDict(b=1, a=2),
    Stamped(0.5, Pose(1.0)), Colour.RED, [Pose(1.0, 2.0)], Small(3.0), Made(), Point(4.0),
    mujoco.mjtGeom.mjGEOM_BOX, Light.RED | Light.BLUE, SimpleNamespace(x=[1]),
    array.array("d", [0.5, -1.0]), array.array("B"),
]  # fmt: skip


def copied(value: Any, here: dict[str, Any] | None = None, there: dict[str, Any] | None = None) -> Any:
    data = json.loads(json.dumps(keep(value, here or {})))
    return restore(data, here or {} if there is None else there)


@pytest.mark.parametrize("value", VALUES, ids=lambda value: repr(value).partition(" at 0x")[0])
def test_a_value_comes_back_equal_and_of_the_same_type(value: Any) -> None:
    found = copied(value)
    assert found == value
    assert type(found) is type(value)
    assert list(found) == list(value) if isinstance(value, OrderedDict) else True


def test_a_future_comes_back_as_one_that_is_never_done() -> None:
    done: concurrent.futures.Future[int] = concurrent.futures.Future()
    done.set_result(1)
    found, number = copied((done, 3))
    assert type(found) is concurrent.futures.Future
    assert (found.done(), number) == (False, 3)
    with pytest.raises(TimeoutError):
        found.result(timeout=0.01)


def test_a_future_of_an_event_loop_comes_back_in_the_running_one() -> None:
    async def made() -> Any:
        return asyncio.get_running_loop().create_future()

    async def again(data: Any) -> None:
        found = restore(data, {})
        assert isinstance(found, asyncio.Future)
        assert found.get_loop() is asyncio.get_running_loop()
        assert not found.done()

    data = keep(asyncio.run(made()), {})
    asyncio.run(again(data))
    with pytest.raises(LookupError, match="needs an event loop, and none is running"):
        restore(data, {})


def test_each_time_it_is_another_object() -> None:
    value = [[1], Point(1.0)]
    data = keep(value, {})
    first, second = restore(data, {}), restore(data, {})
    first[0].append(2)
    first[1].x = 5.0
    assert second == value == [[1], Point(1.0)]


def test_not_a_number_and_infinity_come_back() -> None:
    found = copied([math.nan, math.inf])
    assert math.isnan(found[0])
    assert found[1] == math.inf


@pytest.mark.parametrize(
    "array",
    [
        np.arange(6, dtype=np.float32).reshape(2, 3),
        np.arange(6).reshape(2, 3).T,
        np.array(["a", "bc"]),
        np.zeros((0, 3), dtype=bool),
    ],
)
def test_an_array_comes_back_with_its_type_and_shape_and_can_be_changed(array: Any) -> None:
    found = copied((array, 1))[0]
    assert found.dtype == array.dtype
    assert np.array_equal(found, array)
    found[...] = found
    assert found.flags.writeable


@pytest.mark.parametrize("scalar", [np.float32(0.1), np.int64(3), np.bool_(True)], ids=repr)
def test_a_scalar_of_numpy_comes_back_as_one(scalar: Any) -> None:
    found = copied(scalar)
    assert found == scalar
    assert type(found) is type(scalar)


def test_slots_come_back_private_ones_too() -> None:
    found = copied(Slotted())
    assert (found.x, found.hidden) == (1, [2])


def test_the_instance_and_arguments_are_themselves() -> None:
    here = {"self": Arm(), "target": [1]}
    there = {"self": Arm(), "target": [1]}
    found = copied((here["self"], [here["target"]]), here, there)
    assert found[0] is there["self"]
    assert found[1][0] is there["target"]


def test_an_empty_tuple_is_not_taken_for_an_argument() -> None:
    assert copied((), {"path": ()}, {"path": (1, 2)}) == ()


def test_a_constant_of_its_module_is_itself() -> None:
    assert copied([OK])[0] is OK


def local() -> Any:
    @dataclass
    class Local:
        x: int = 1

    return Local()


def round_about() -> Any:
    value: list[Any] = []
    value.append(value)
    return value


@pytest.mark.parametrize(
    ("make", "what"),
    [
        (threading.Lock, "_thread:lock"),
        (lambda: lambda: 1, "builtins:function"),
        (lambda: Point(threading.Lock()), "_thread:lock"),  # type: ignore[arg-type]
        (lambda: (n for n in ()), "builtins:generator"),
        (Poses, f"{__name__}:Poses"),
        (Guarded, f"{__name__}:Guarded"),
        (local, f"{__name__}:local.<locals>.Local"),
        (round_about, "something that holds itself"),
        (lambda: "a" * (LIMIT + 1), f"more than {LIMIT} characters"),
        (lambda: np.zeros(LIMIT), f"more than {LIMIT} characters"),
        (lambda: ValueError("no"), "builtins:ValueError"),
        (lambda: np.array([object()]), "an array of object"),
    ],
)
def test_what_cannot_be_copied_safely_is_refused_by_name(make: Callable[[], Any], what: str) -> None:
    with pytest.raises(NotKeptError) as caught:
        keep([make()], {})
    assert str(caught.value) == what


def test_a_part_of_the_robot_api_is_never_copied() -> None:
    handles = {f"{__name__}:Arm"}
    with pytest.raises(NotKeptError, match="Arm"):
        keep({"arm": Arm()}, {}, handles)
    assert copied(Arm()).x == 0.0


def test_a_proxy_is_asked_nothing() -> None:
    with pytest.raises(NotKeptError, match="Proxy"):
        keep(Proxy(), {})
    assert Proxy.asked == []


def test_a_class_that_is_gone_is_reported() -> None:
    with pytest.raises(LookupError, match="nowhere:Pose"):
        restore({"object": ["nowhere:Pose", {}, {}]}, {})
