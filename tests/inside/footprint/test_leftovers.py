"""State that a test leaves behind in the process is noticed, wherever it lies; what only looks so is not."""

from __future__ import annotations

import collections
import copy
import functools
import io
import itertools
import pathlib
import random
import sys
import types
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from mutabot.inside.footprint.leftovers import Leftovers

MODULE = "leftovers_subject"


class Arm:
    speed = 1.0

    def __init__(self) -> None:
        self.x = 0.0


class Slotted:
    __slots__ = ("x",)

    def __init__(self) -> None:
        self.x = 0.0


Arm.__module__ = Slotted.__module__ = MODULE


@pytest.fixture
def module() -> Iterator[Any]:
    """A module of the project."""
    made = types.ModuleType(MODULE)
    made.__file__ = "/project/subject.py"
    sys.modules[MODULE] = made
    yield made
    del sys.modules[MODULE]


def leftovers() -> Leftovers:
    made = Leftovers(lambda file: file == "/project/subject.py", frozenset())
    made.start()
    return made


def cached() -> Callable[[], Arm]:
    @functools.lru_cache
    def arm() -> Arm:
        return Arm()

    arm()
    return arm


def counting() -> Callable[[], int]:
    count = 0

    def step() -> int:
        nonlocal count
        count += 1
        return count

    step.__module__ = MODULE
    return step


def fill(items: Any) -> None:
    items[1] = 2.0


CHANGES: dict[str, tuple[Callable[[], Any], Callable[[Any], Any]]] = {
    "an attribute": (Arm, lambda arm: setattr(arm, "x", 1.0)),
    "a slot": (Slotted, lambda arm: setattr(arm, "x", 1.0)),
    "an object in a list": (lambda: [Arm()], lambda arms: setattr(arms[0], "x", 1.0)),
    "a key": (dict, lambda items: items.update(a=1)),
    "a set": (lambda: {1}, lambda items: items.add(2)),
    "an array": (lambda: np.zeros(3), fill),
    "what a cache holds": (cached, lambda arm: setattr(arm(), "x", 1.0)),
    "a closure": (counting, lambda step: step()),
    "a generator": (lambda: (i for i in range(3)), next),
    "a random generator": (lambda: random.Random(1), lambda one: one.random()),
    "one of numpy's": (lambda: np.random.default_rng(1), lambda one: one.random()),
    "a counter": (itertools.count, next),
    "a queue": (collections.deque, lambda queue: queue.append(1)),
    "a buffer": (io.BytesIO, lambda buffer: buffer.write(b"x")),
    "a bound method's object": (lambda: Arm().__init__, lambda bound: setattr(bound.__self__, "x", 1.0)),
}


@pytest.mark.parametrize("what", CHANGES)
def test_a_change_is_noticed(module: Any, what: str) -> None:
    make, change = CHANGES[what]
    module.THING = make()
    state = leftovers()
    assert state.since()[0] == []
    change(module.THING)
    assert state.since() == ([f"{MODULE}.THING"], [], [])
    assert state.since()[0] == []


def test_a_class_of_the_project_has_state(module: Any) -> None:
    module.Arm = Arm
    state = leftovers()
    Arm.speed = 2.0
    try:
        assert state.since()[0] == [f"{MODULE}.Arm"]
    finally:
        Arm.speed = 1.0


def test_a_name_that_stands_for_a_new_object_was_replaced(module: Any) -> None:
    module.ARM = Arm()
    module.ARM.x = 0.5
    state = leftovers()
    module.ARM = Arm()
    assert state.since() == ([f"{MODULE}.ARM"], [f"{MODULE}.ARM"], [])


def test_a_count_was_changed_and_not_replaced(module: Any) -> None:
    module.COUNT = 1000
    state = leftovers()
    module.COUNT += 1
    assert state.since() == ([f"{MODULE}.COUNT"], [], [])


def test_what_is_only_asked_is_not_changed(module: Any) -> None:
    module.PATH = pathlib.Path("/a/b")
    module.ARM = Arm()
    module.cache = cached()
    state = leftovers()
    assert str(module.PATH)
    assert hash(module.PATH)
    assert module.PATH.parts
    assert module.cache().x == module.ARM.x
    assert state.since()[0] == []


def test_objects_that_refer_to_each_other_end(module: Any) -> None:
    one, other = Arm(), Arm()
    one.peer, other.peer = other, one  # type: ignore[attr-defined]
    module.ONE = one
    state = leftovers()
    other.x = 1.0
    assert state.since()[0] == [f"{MODULE}.ONE"]


def test_what_tells_its_state_to_nobody_is_named(module: Any) -> None:
    module.PACKER = __import__("struct").Struct("d")
    module.HANDLE = __import__("select").epoll()
    try:
        unseen = leftovers().since()[2]
    finally:
        module.HANDLE.close()
    assert unseen == [f"{MODULE}.HANDLE (select.epoll)"] or f"{MODULE}.HANDLE (select.epoll)" in unseen


def test_an_operation_of_a_native_module_is_state_that_nobody_sees() -> None:
    state = Leftovers(lambda file: False, frozenset({"math"}))
    state.start()
    assert state.since() == ([], [], ["math"])


def test_the_environment_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    state = leftovers()
    monkeypatch.setenv("ROBOT", "1")
    assert state.since()[0] == ["os.environ"]


def test_a_copied_object_leaves_nothing_on_its_class(module: Any) -> None:
    module.Slotted = Slotted
    looks = leftovers()
    copy.copy(Slotted())
    assert looks.since()[0] == []
