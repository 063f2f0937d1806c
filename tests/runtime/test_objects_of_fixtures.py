"""Where objects with probes are looked for: in what fixtures hold, and without asking it anything."""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import pytest

from mutabot.runtime.test_hooks import objects_of_fixtures

Rig = namedtuple("Rig", "arm gripper")  # as programs write it


class Arm:
    pass


class Cell:
    def __init__(self, arm: Arm) -> None:
        self.arm = arm


class Lazy(Mapping[str, Any]):
    """Is made when anything asks it for anything, as a lazy proxy is."""

    made = 0

    def make(self, *_: object) -> Any:
        Lazy.made += 1
        return Arm()

    __class__ = property(make)  # type: ignore[assignment]
    __dict__ = property(make)  # type: ignore[assignment]
    __getattr__ = make

    def __getitem__(self, key: str) -> Any:
        return self.make()

    def __iter__(self) -> Iterator[str]:
        self.make()
        return iter(())

    def __len__(self) -> int:
        return len(self.make().joints)


class Chest(dict[str, Any]):
    """A dictionary with a way of its own to list its values."""

    def values(self) -> Any:
        raise RuntimeError("locked")


def found(fixture: object) -> list[Any]:
    item: Any = SimpleNamespace(funcargs={"given": fixture}, obj=None)
    return list(objects_of_fixtures(item))


@pytest.mark.parametrize(
    "hold",
    [lambda arm: [arm], lambda arm: Rig(arm, None), lambda arm: {arm}, Cell, lambda arm: Chest(arm=arm)],
    ids=["list", "named tuple", "set", "object", "dictionary"],
)
def test_an_object_is_found_in_what_a_fixture_holds(hold: Any) -> None:
    arm = Arm()
    assert any(value is arm for value in found(hold(arm)))


def test_a_lazy_proxy_is_not_made_by_looking_for_objects() -> None:
    lazy = Lazy()
    assert len(found(lazy)) == 1
    assert len(found([lazy])) == 2
    assert Lazy.made == 0
