"""What ``frozen`` makes of a class is what ``dataclass(frozen=True)`` makes of it."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import FrozenInstanceError, dataclass, field, fields, is_dataclass, replace
from typing import Any

import pytest

from mutabot.frozen import compile_all, frozen


@frozen
class Nothing:
    pass


@frozen
class Thing:
    name: str
    sizes: tuple[float, ...] = ()
    secret: str = field(default="", repr=False)
    note: str = field(default="", compare=False)


@frozen
class Same:
    name: str
    sizes: tuple[float, ...] = ()
    secret: str = field(default="", repr=False)
    note: str = field(default="", compare=False)


@frozen
class Loud:
    name: str

    def __repr__(self) -> str:
        return self.name.upper()


@dataclass(frozen=True, slots=True)
class Reference:
    name: str
    sizes: tuple[float, ...] = ()
    secret: str = field(default="", repr=False)
    note: str = field(default="", compare=False)


@pytest.mark.parametrize(
    "arguments", [("a",), ("a", (1.0, 2.0)), ("a", (), "hidden", "seen"), ("b", (), "", "another")]
)
def test_it_compares_hashes_and_shows_like_a_frozen_dataclass(arguments: tuple[Any, ...]) -> None:
    for other in [("a",), ("a", (1.0, 2.0)), ("a", (), "hidden", "another"), ("b",)]:
        is_equal = Reference(*arguments) == Reference(*other)
        assert (Thing(*arguments) == Thing(*other)) is is_equal
        assert (len({Thing(*arguments), Thing(*other)}) == 1) is is_equal
    assert repr(Thing(*arguments)) == repr(Reference(*arguments)).replace("Reference", "Thing")


def test_nothing_is_left_to_compile_in_a_process_that_is_forked() -> None:
    @frozen
    class Late:
        name: str = "late"

    before = Late.__init__
    compile_all()
    assert Late.__init__ is not before
    assert Late("a") != Late() == Late("late")


def test_values_of_two_classes_are_not_equal() -> None:
    assert Thing("a") != Same("a")
    assert Thing("a") != ("a", (), "", "")
    assert Nothing() == Nothing()
    assert len({Nothing(), Nothing()}) == 1


@pytest.mark.parametrize(
    "again", [copy.copy, copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing)), replace]
)
def test_copies_are_equal(again: Callable[[Thing], Thing]) -> None:
    assert again(Thing("a", (1.0,), note="n")) == Thing("a", (1.0,))


def test_it_is_a_dataclass_with_slots_and_keeps_methods_of_its_own() -> None:
    assert [attribute.name for attribute in fields(Thing)] == ["name", "sizes", "secret", "note"]
    assert not hasattr(Thing("a"), "__dict__")
    assert repr(Loud("a")) == "A"
    assert Loud("a") == Loud("a")


def test_what_cannot_be_hashed_makes_it_so() -> None:
    with pytest.raises(TypeError, match="unhashable"):
        hash(Thing("a", sizes=[1.0]))  # type: ignore[arg-type]


@frozen
class More(Thing):
    sizes: tuple[float, ...] = (1.0,)
    count: int = 0


def test_a_class_below_it_has_its_fields_first() -> None:
    assert [attribute.name for attribute in fields(More)] == ["name", "sizes", "secret", "note", "count"]
    assert repr(More("a", secret="hidden", count=2)) == "More(name='a', sizes=(1.0,), note='', count=2)"
    assert More("a") != Thing("a", (1.0,))


def test_a_class_without_an_object_is_a_dataclass_for_others() -> None:
    @frozen
    class Late:
        name: str
        note: str = field(default="", compare=False)

    class Below(Late):
        pass

    assert is_dataclass(Below)
    assert [attribute.compare for attribute in fields(Late)] == [True, False]
    match Late("a", "b"):
        case Late(name, note):
            assert (name, note) == ("a", "b")


@frozen(refuses=True, order=True)
class Version:
    major: int
    minor: int = 0


def test_one_that_refuses_cannot_be_changed_and_can_be_copied() -> None:
    version = Version(1, 2)
    with pytest.raises(FrozenInstanceError, match="cannot assign to field 'minor'"):
        version.minor = 3  # type: ignore[misc]
    with pytest.raises(FrozenInstanceError, match="cannot delete field 'minor'"):
        del version.minor  # type: ignore[misc]
    copies = [copy.copy(version), copy.deepcopy(version), pickle.loads(pickle.dumps(version))]
    assert [*copies, replace(version, minor=2)] == [Version(1, 2)] * 4


def test_one_with_an_order_is_sorted_by_its_fields() -> None:
    versions = [Version(2), Version(1, 5), Version(1), Version(1, 2)]
    assert sorted(versions) == [Version(1), Version(1, 2), Version(1, 5), Version(2)]
    assert Version(1) < Version(1, 1) <= Version(1, 1)
    assert Version(2) > Version(1, 1) >= Version(1, 1)
    with pytest.raises(TypeError):
        _ = Version(1) < (1, 0)  # type: ignore[operator]
