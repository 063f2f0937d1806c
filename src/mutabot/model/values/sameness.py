"""Whether two values of a quantity are the same for the robot: one in the place of the other is no fault.

Plan, engines and operators of all families ask here, so that what one leaves out no other plants.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from .quantity import Kind, Mode, Quantity, Value, is_number, same
from .rotation import distance
from .units import UNITS

#: share of a value that no robot shows: a thousand times finer than the 24 bits of the best encoders
_RELATIVE = 1e-9
#: the same next to zero, in the SI's unit. A picometre is what sums of coordinates of some hundred metres
#: are rounded by (2⁻⁵² of each, several times over), and far below the finest step of any drive
_ABSOLUTE = 1e-12
#: share of a stamp: seconds since 1970 have sixteen digits, of which all but the last count
_OF_STAMP = 1e-15
#: seconds below which stamps are the same: messages count nanoseconds
_NANOSECOND = 1e-9
#: radians within which two orientations are the same
SAME_ORIENTATION = 1e-9
#: the same where they are a full turn apart, as half a turn and its opposite are: people write it as 3.1416
TURNED_ROUND = 1e-3


def is_same(quantity: Quantity, one: Value, other: Value) -> bool:
    """Whether the robot, or the program that reads it, cannot tell two values of a quantity apart.

    Orientations as a whole are the same if the angle between them is none, in whichever writing; targets of
    rotations modulo a full turn; numbers, and the parts of vectors, up to the rounding of computations.
    """
    if one is other:
        return True
    if quantity.is_whole:
        before, after = quantity.orientation(one), quantity.orientation(other)
        if before is not None and after is not None:
            return distance(before, after) < SAME_ORIENTATION
    if not quantity.is_measured and quantity.kind is not Kind.STAMP:
        return same(one, other)
    return _are_same(quantity, _plain(one), _plain(other))


def are_same(quantities: Iterable[Quantity], one: Mapping[str, Value], other: Mapping[str, Value]) -> bool:
    """The same of the values of a call, by the names of its quantities."""
    return one.keys() == other.keys() and not changes(quantities, other, one)


def changes(
    quantities: Iterable[Quantity], before: Mapping[str, Value], after: Mapping[str, Value]
) -> dict[str, Value]:
    """The values of a call that are others than before, or were not there."""
    known = {quantity.name: quantity for quantity in quantities}

    def is_kept(name: str, value: Value) -> bool:
        if name not in before:
            return False
        return is_same(known[name], before[name], value) if name in known else same(before[name], value)

    return {name: value for name, value in after.items() if not is_kept(name, value)}


def _plain(value: Value) -> Value:
    return value.tolist() if hasattr(value, "tolist") else value


def _are_same(quantity: Quantity, one: Value, other: Value) -> bool:
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(
            _are_same(quantity, first, second) for first, second in zip(one, other, strict=True)
        )
    if not (is_number(one) and is_number(other)):
        return same(one, other)
    if one == other:
        return True
    if not (math.isfinite(one) and math.isfinite(other)):
        return same(one, other)
    return _is_rounding(quantity, one, other) or _is_full_turn(quantity, one, other)


def _is_rounding(quantity: Quantity, one: float, other: float) -> bool:
    if isinstance(one, int) and isinstance(other, int):
        return False  # whole numbers are not rounded: two counts of an encoder are two places
    if quantity.kind is Kind.STAMP:
        return math.isclose(one, other, rel_tol=_OF_STAMP, abs_tol=_NANOSECOND)
    factor = UNITS[quantity.unit].factor if quantity.unit is not None else 1.0
    return math.isclose(one, other, rel_tol=_RELATIVE, abs_tol=max(_ABSOLUTE / factor, _ABSOLUTE))


def _is_full_turn(quantity: Quantity, one: float, other: float) -> bool:
    """Whether the targets of a rotation lie a full turn apart, or several."""
    turn = _turn_of_target(quantity)
    if turn is None or abs(one - other) < 0.5 * turn:
        return False
    return abs(math.remainder(one - other, turn)) <= TURNED_ROUND * turn / (2.0 * math.pi)


def _turn_of_target(quantity: Quantity) -> float | None:
    """A full turn, where it makes no difference to the robot which of two targets it is sent.

    A program that reads an angle may well tell 180 from −180 degrees. A joint tells them apart as well, and
    so does whatever has a range of more than one turn: it winds.
    """
    turn = quantity.full_turn
    if turn is None or quantity.kind is not Kind.ROTATION or quantity.mode is not Mode.TO:
        return None
    limits = quantity.range or quantity.clip
    winds = limits is not None and limits[1] - limits[0] > turn * (1.0 + 1e-6)
    return None if winds else turn
