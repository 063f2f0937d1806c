"""What a change makes of the numbers of a world."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mutabot_world.change import NotInWorldError, NumberChange, change_at


class Clamped:
    """A servo with a greatest speed."""

    def __init__(self) -> None:
        self._speed = 1.0

    @property
    def speed(self) -> float:
        """Speed in m/s, at most 1.2."""
        return self._speed

    @speed.setter
    def speed(self, value: float) -> None:
        self._speed = min(value, 1.2)

    @property
    def size(self) -> float:
        """Its length in m, as it was made."""
        return 0.3


def test_a_number_is_reported_as_it_is_after_the_change() -> None:
    servo = Clamped()
    assert change_at(servo, "speed", NumberChange("scale", 0.5))[:2] == (1.0, 1.2)


@pytest.mark.parametrize(
    ("world", "path", "change", "why"),
    [
        (Clamped(), "size", NumberChange("scale", 0.5), "size cannot be changed: .* has no setter"),
        ((1.0, 2.0), "[1]", NumberChange("scale", 0.5), "cannot be changed: .* does not support item assign"),
        (SimpleNamespace(name="arm"), "name", NumberChange("offset", 0.5), "name cannot be changed: "),
        (
            SimpleNamespace(speed=0.0),
            "speed",
            NumberChange("scale", 0.5),
            "speed is 0.0 with the change as well",
        ),
        ([np.array([1, 2])], "[0][1]", NumberChange("offset", 0.5), "is 2 with the change as well"),
        ({"a": np.zeros(3)}, "['a']", NumberChange("scale", 0.5), r"is \[0. 0. 0.\] with the change as well"),
    ],
)
def test_what_a_change_leaves_as_it_is_is_not_there_to_be_disturbed(
    world: Any, path: str, change: NumberChange, why: str
) -> None:
    with pytest.raises(NotInWorldError, match=why):
        change_at(world, path, change)


def test_a_change_is_taken_away() -> None:
    world = SimpleNamespace(gravity=np.array([0.0, 0.0, -9.81]))
    before, after, undo = change_at(world, "gravity", NumberChange("offset", 1.0))
    assert world.gravity.tolist() == after.tolist() == [1.0, 1.0, -8.81]
    undo()
    assert world.gravity.tolist() == before.tolist() == [0.0, 0.0, -9.81]
