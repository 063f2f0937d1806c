"""Paths: reading them, following them, and replacing what lies at their end in a copy."""

from __future__ import annotations

import copy
from collections import OrderedDict, namedtuple
from dataclasses import dataclass
from datetime import datetime
from enum import Enum
from fractions import Fraction
from types import MappingProxyType, SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mutabot.errors import PathError
from mutabot.model import Path
from mutabot.model.path import Step

Point = namedtuple("Point", ["x", "y"])


class Reading(NamedTuple):
    pose: Any
    x: float = 0.0


@dataclass
class Plain:
    x: Any


@dataclass(frozen=True)
class Frozen:
    x: Any


@dataclass(slots=True)
class Slotted:
    x: Any


@dataclass(frozen=True, slots=True)
class FrozenSlotted:
    x: Any


class ByHand:
    def __init__(self, x: Any) -> None:
        self.x = x

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ByHand) and self.x == other.x

    __hash__ = None  # type: ignore[assignment]  # it can change


class HandSlots:
    __slots__ = ("x",)

    def __init__(self, x: Any) -> None:
        self.x = x

    def __eq__(self, other: object) -> bool:
        return isinstance(other, HandSlots) and self.x == other.x

    __hash__ = None  # type: ignore[assignment]  # it can change


class Immutable:
    """Refuses in a way of its own, as frozen models of pydantic do."""

    def __init__(self, x: Any) -> None:
        vars(self)["x"] = x

    def __setattr__(self, name: str, value: Any) -> None:
        raise ValueError(f"{name}: the instance is frozen")

    def __eq__(self, other: object) -> bool:
        return type(other) is Immutable and vars(other) == vars(self)

    __hash__ = None  # type: ignore[assignment]  # of no use here


class Validated(SimpleNamespace):
    def __setattr__(self, name: str, value: Any) -> None:
        if value < 0:
            raise ValueError("less than zero")
        super().__setattr__(name, value)


class Computed:
    @property
    def x(self) -> float:
        return 1.0


#: how a value is put into something, and the step that leads to it
WRAPPERS: dict[str, tuple[Any, str]] = {
    "tuple": (lambda v: (0, v), "[1]"),
    "tuple_from_the_end": (lambda v: (0, v), "[-1]"),
    "list": (lambda v: [v, 0], "[0]"),
    "namedtuple": (lambda v: Point(v, 0), ".x"),
    "namedtuple_by_index": (lambda v: Point(0, v), "[1]"),
    "typed_namedtuple": (Reading, ".pose"),
    "dict": (lambda v: {"gap": v, "x": 0}, "['gap']"),
    "dict_by_number": (lambda v: {7: v}, "[7]"),
    "ordered_dict": (lambda v: OrderedDict(b=0, a=v), "['a']"),
    "dataclass": (Plain, ".x"),
    "frozen_dataclass": (Frozen, ".x"),
    "slots_dataclass": (Slotted, ".x"),
    "frozen_slots_dataclass": (FrozenSlotted, ".x"),
    "object": (ByHand, ".x"),
    "slots_object": (HandSlots, ".x"),
    "immutable_object": (Immutable, ".x"),
    "namespace": (lambda v: SimpleNamespace(x=v, y=0), ".x"),
    "array_of_objects": (lambda v: np.array([None, v], dtype=object), "[1]"),
}
wrappers = st.sampled_from(sorted(WRAPPERS.keys() - {"array_of_objects"}))
names = st.from_regex(r"[^\W\d]\w{0,8}", fullmatch=True).filter(str.isidentifier)
bounds = st.none() | st.integers(-20, 20)
steps = (
    names.map(lambda name: Step(attribute=name))
    | st.integers(-99, 99).map(lambda index: Step(item=index))
    | st.text(st.characters(blacklist_characters="[]", codec="utf-8")).map(lambda key: Step(item=key))
    | st.tuples(bounds, bounds, (st.none() | st.integers(-3, 3)).filter(lambda s: s != 0)).map(
        lambda b: Step(bounds=b)
    )
)


@given(root=st.none() | names, way=st.lists(steps, max_size=4))
def test_a_path_is_read_back_as_it_is_printed(root: str | None, way: list[Step]) -> None:
    path = Path(root, tuple(way))
    assert Path.parse(str(path), rooted=root is not None) == path


@given(layers=st.lists(wrappers, min_size=1, max_size=4), old=st.floats(-9, 9), new=st.floats(-9, 9))
def test_putting_changes_a_copy_at_that_place_only(layers: list[str], old: float, new: float) -> None:
    value, expected, text = old, new, ""
    for name in layers:
        wrap, step = WRAPPERS[name]
        value, expected, text = wrap(value), wrap(expected), step + text
    path = Path.parse(text, rooted=False)
    before = copy.deepcopy(value)

    changed = path.put(value, new)

    assert path.get(value) == old
    assert value == before
    assert path.get(changed) == new
    assert changed == expected
    assert type(changed) is type(value)


@pytest.mark.parametrize("name", WRAPPERS)
def test_every_container_can_be_changed_in_a_copy(name: str) -> None:
    wrap, step = WRAPPERS[name]
    original = wrap(Point(1.0, 2.0))
    path = Path.parse(f"{step}.y", rooted=False)
    changed = path.put(original, 5.0)
    assert (path.get(original), path.get(changed)) == (2.0, 5.0)
    assert type(changed) is type(original)


@pytest.mark.parametrize("dtype", [float, np.float32, int, np.int8, np.uint8])
@pytest.mark.parametrize("new", [3, -5, 0.5, -2.5])
def test_a_number_in_an_array_is_replaced_without_loss(dtype: Any, new: float) -> None:
    original = np.array([1, 2, 3], dtype=dtype)
    path = Path.parse("[1]", rooted=False)
    changed = path.put(original, new)
    assert path.get(changed) == new
    assert original.tolist() == [1, 2, 3]
    assert changed[[0, 2]].tolist() == [1, 3]


@pytest.mark.parametrize("new", [[0.5, -1.0], np.array([0.5, -1.0]), (0.5, -1)])
@pytest.mark.parametrize("dtype", [float, int, np.uint8])
def test_a_slice_of_an_array_is_replaced_without_loss(new: Any, dtype: Any) -> None:
    original = np.array([1, 2, 3], dtype=dtype)
    changed = Path.parse("[1:3]", rooted=False).put(original, new)
    assert changed.tolist() == [1, 0.5, -1]
    assert original.tolist() == [1, 2, 3]


def test_rows_of_an_array_of_whole_numbers_are_replaced() -> None:
    original = np.zeros((2, 2), dtype=int)
    changed = Path.parse("[0:2]", rooted=False).put(original, [[1, 2], [3, 4]])
    assert changed.tolist() == [[1, 2], [3, 4]]
    assert changed.dtype == original.dtype


def test_an_element_of_a_matrix_is_replaced_in_a_copy() -> None:
    original = {"pose": np.eye(3)}
    changed = Path.parse("['pose'][0][2]", rooted=False).put(original, 7.0)
    assert (changed["pose"][0, 2], original["pose"][0, 2]) == (7.0, 0.0)


def test_a_slice_of_a_tuple_stays_a_tuple() -> None:
    assert Path.parse("[1:]", rooted=False).put((1, 2, 3), [5, 6]) == (1, 5, 6)


def test_the_empty_path_is_the_value_itself() -> None:
    assert (Path().get(3), Path().put(3, 4)) == (3, 4)


@pytest.mark.parametrize(
    ("text", "rooted", "words"),
    [
        ("x", False, "from 'x' on"),
        (".x y", False, "from ' y' on"),
        ("[0", False, "from '[0' on"),
        ("[gap]", False, "a key needs quotes"),
        ("[1.5]", False, "whole number"),
        ("[True]", False, "whole number"),
        ("[::0]", False, "stride of zero"),
        ("", True, "argument's name"),
        (".x", True, "argument's name"),
        ("a..b", True, "from '..b' on"),
    ],
)
def test_a_text_that_is_no_path_says_where_it_goes_wrong(text: str, rooted: bool, words: str) -> None:
    with pytest.raises(ValueError, match="path") as caught:
        Path.parse(text, rooted=rooted)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("value", "text", "words"),
    [
        (Point(1, 2), ".z", ["Point has no .z", "'.y'"]),
        ({"gap": 1}, "['gpa']", ["\"['gap']\""]),
        ((1, 2), "[2]", ["tuple has no [2]", "'[1]'"]),
        (np.zeros(3), "[5]", ["ndarray has no [5]", "'[2]'"]),
        (Frozen(Point(1, 2)), ".x.xx", ["'.x'"]),
        (Point(1, 2), ".height", ["it has .x, .y"]),
        (3.5, ".x", ["float has no .x"]),
        (None, "[0]", ["NoneType has no [0]"]),
    ],
)
def test_a_path_that_does_not_fit_names_what_would(value: Any, text: str, words: list[str]) -> None:
    with pytest.raises(PathError) as caught:
        Path.parse(text, rooted=False).get(value)
    assert [word for word in words if word not in str(caught.value)] == [], str(caught.value)


class Kept:
    def __init__(self) -> None:
        self._x = 1.0

    @property
    def x(self) -> float:
        return self._x


class Handle:
    """Is not copied, like most of what compiled packages return."""

    def __init__(self, x: float = 1.0) -> None:
        self.x = x

    def __reduce_ex__(self, protocol: Any) -> Any:
        raise TypeError(f"cannot pickle {type(self).__name__!r} object")


class Bounds(tuple[float, float]):
    """A tuple that is made of two numbers with names."""

    def __new__(cls, lower: float, upper: float) -> Bounds:
        return super().__new__(cls, (lower, upper))

    lower = property(lambda self: self[0])
    upper = property(lambda self: self[1])


class Delegate:
    """Asks another object for what it has not, and knows none while it is copied."""

    def __init__(self, there: Any) -> None:
        self._there = there

    def __getattr__(self, name: str) -> Any:
        return getattr(self._there, name)


class Level(Enum):
    HIGH = 2.0


class Measured(float):
    error = 0.1


FIXED: list[tuple[Any, str, str]] = [
    (Computed(), ".x", ".x of Computed"),
    (MappingProxyType({"x": 1}), "['x']", "['x'] of mappingproxy"),
    ("abc", "[1]", "[1] of str"),
    (b"abc", "[1]", "[1] of bytes"),
    (range(3), "[1]", "[1] of range"),
    (2j, ".imag", ".imag of complex"),
    ([SimpleNamespace(z=2j)], "[0].z.imag", ".imag of complex"),
    (Measured(2.0), ".real", ".real of Measured"),
    (np.float64(2.0), ".real", ".real of float64"),
    (Level.HIGH, ".value", ".value of Level"),
    (datetime(2026, 1, 2), ".day", ".day of datetime"),
    (Fraction(1, 2), ".numerator", ".numerator of Fraction"),
    (Handle(), ".x", ".x of Handle"),
    ({"pose": (Handle(),)}, "['pose'][0].x", ".x of Handle"),
    (Delegate(Kept()), ".x", ".x of Delegate"),
    (Bounds(lower=0.0, upper=1.0), ".upper", ".upper of Bounds"),
]


@pytest.mark.parametrize(("value", "text", "part"), FIXED)
def test_what_cannot_be_copied_and_changed_is_known_and_refused(value: Any, text: str, part: str) -> None:
    path = Path.parse(text, rooted=False)
    assert path.fixed_part(value) == part
    with pytest.raises(PathError, match="cannot replace"):
        path.put(value, 0)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        *((wrap(1.0), step) for wrap, step in WRAPPERS.values()),
        (Kept(), ".x"),
        (np.array([1j, 2.0]), ".real[0]"),
    ],
)
def test_what_a_copy_can_have_otherwise_is_not_fixed(value: Any, text: str) -> None:
    path = Path.parse(text, rooted=False)
    assert path.fixed_part(value) == ""
    assert path.get(path.put(value, 5.0)) == 5.0


def test_an_object_with_a_finalizer_is_not_copied_to_find_out() -> None:
    ended: list[object] = []

    class Link(Handle):
        def __del__(self) -> None:
            ended.append(1)

    class Copied(Link):
        def __reduce_ex__(self, protocol: Any) -> Any:
            return Copied, (self.x,)

    for made in (Link(), Copied()):
        assert Path.parse(".x", rooted=False).fixed_part(made) == ""
        assert ended == []


def test_a_value_that_the_class_refuses_is_not_forced_upon_it() -> None:
    path, value = Path.parse(".x", rooted=False), Validated(x=1.0)
    assert path.put(value, 2.0).x == 2.0
    with pytest.raises(PathError, match="less than zero"):
        path.put(value, -1.0)


class MuteError(Exception):
    def __str__(self) -> str:
        raise RuntimeError("no text")


class Mute:
    def __getattr__(self, name: str) -> Any:
        raise MuteError


def test_an_object_that_fails_without_a_text_is_an_error_of_the_path() -> None:
    with pytest.raises(PathError, match=r"x of Mute raises MuteError: MuteError"):
        Path.parse(".x", rooted=False).get(Mute())
