"""Objects of a class are found wherever they are, whether Python's collector knows them or not."""

from __future__ import annotations

from random import Random

import pytest

from mutabot_world.patching import instances_of


class Kept:
    """Its objects refer to their class, and the collector knows them."""


class KeptBelow(Kept):
    """A subclass of it."""


class Bare:
    """Its objects have nothing that the collector would have to know."""

    __slots__ = ()


class BareBelow(Kept, Bare):
    """The collector knows objects of this class, which are objects of one that it does not know."""


class KeptNumber(int):
    """A class whose objects are those of one in C, too."""


@pytest.mark.parametrize(
    ("kind", "made"),
    [
        (Kept, [Kept(), Kept(), KeptBelow()]),
        (Bare, [Bare(), BareBelow()]),
        (KeptNumber, [KeptNumber(3)]),
    ],
)
def test_all_objects_of_a_class_and_its_subclasses_are_found_once(kind: type, made: list[object]) -> None:
    found = list(instances_of([f"{__name__}:{kind.__name__}"] * 2))
    assert {id(each) for each in made} <= {id(each) for each in found}
    assert len(found) == len({id(each) for each in found})
    assert all(isinstance(each, kind) for each in found)


def test_objects_of_a_class_in_c_are_found_in_what_holds_them() -> None:
    held = {"last": Random(1), "zip": zip((), strict=True)}
    found = list(instances_of(["_random:Random", "builtins:zip"]))
    assert all(any(each is one for one in found) for each in held.values())
