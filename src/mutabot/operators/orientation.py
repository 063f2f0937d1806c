"""Orientations as a whole: what turning them the other way, or disturbing them, means."""

from __future__ import annotations

from collections.abc import Callable
from random import Random

from mutabot.model import Quantity
from mutabot.model.values.quantity import Value
from mutabot.model.values.rotation import Quaternion, distance, from_rotation_vector, inverse, product
from mutabot.model.values.sameness import SAME_ORIENTATION, TURNED_ROUND
from mutabot.model.values.units import convert

from .operator import map_numbers


def the_other_way(quantity: Quantity, value: Value) -> Value | None:
    """The inverse rotation, written like the value; the value itself where that is the same orientation."""
    return _changed(quantity, value, inverse, TURNED_ROUND)


def disturbed(quantity: Quantity, value: Value, random: Random, deviation: float) -> Value | None:
    """The orientation turned by a random rotation vector of this standard deviation in each part."""
    sigma = convert(deviation, quantity.unit or "rad", "rad")
    turn = from_rotation_vector([random.gauss(0.0, sigma) for _ in range(3)])
    return _changed(quantity, value, lambda orientation: product(turn, orientation))


def _changed(
    quantity: Quantity,
    value: Value,
    change: Callable[[Quaternion], Quaternion],
    least: float = SAME_ORIENTATION,
) -> Value | None:
    before = quantity.orientation(value)
    if before is None:
        return None
    after = change(before)
    if distance(before, after) < least:
        return value
    parts = iter(quantity.numbers(after))
    return map_numbers(value, lambda _: next(parts) + 0.0)  # no −0
