"""Orientations as a whole that are written or read in another way."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar

from mutabot.families import CATALOGUE
from mutabot.model import Kind
from mutabot.model.quantity import Value, is_same
from mutabot.model.units import convert, from_euler
from mutabot.operators.examples import changed, reading, unchanged, writing
from mutabot.operators.numbers import map_numbers
from mutabot.operators.operator import Context, Example, Unchanged
from mutabot.operators.studies import FRAMES, SIGNS
from mutabot.operators.value import ValueOperator

_RPY = writing("robot:Arm.orient", "rpy", Kind.EULER, unit="deg", order="xyz")
_ORIENT = writing("robot:Arm.orient", "turned", Kind.QUATERNION, order="wxyz")
_LOOK = reading("camera:orientation", Kind.QUATERNION, order="xyzw")


class _OtherNumbers(ValueOperator):
    """Puts other numbers in the place of those of an orientation."""

    family = CATALOGUE

    @abstractmethod
    def numbers(self, numbers: list[float], context: Context) -> list[float]:
        """The other numbers."""

    def change(self, value: Value, context: Context) -> Value | None:
        quantity = context.quantity
        if quantity.orientation(value) is None:
            raise Unchanged("its value is no orientation")
        numbers = self.numbers([float(part) for part in value], context)
        if quantity.orientation(numbers) is None or is_same(quantity, value, numbers):
            raise Unchanged("it would be the same orientation")
        parts = iter(numbers)
        return map_numbers(value, lambda _: next(parts) + 0.0)  # no −0


class EulerOrder(_OtherNumbers):
    """Euler angles are carried out in the reverse order: axes that stay are taken for axes that turn
    along.
    """

    name = "euler-order"
    rank = 320
    stands_for = f"Two conventions of Euler angles: {FRAMES}."
    where = "written and read quantities of kind euler"
    kinds = frozenset({Kind.EULER})
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_RPY, [45.0, 0.0, 90.0], [0.0, -45.0, 90.0]),
        unchanged(_RPY, [0.0, 0.0, 90.0], "a turn about one axis alone has no order"),
    )

    def numbers(self, numbers: list[float], context: Context) -> list[float]:
        quantity = context.quantity
        radians = [convert(angle, quantity.unit or "rad", "rad") for angle in numbers]
        return quantity.numbers(from_euler(radians, (quantity.order or "").swapcase()))


class QuaternionOrder(_OtherNumbers):
    """A quaternion is taken to have its scalar part at the other end: xyzw for wxyz, and back."""

    name = "quaternion-order"
    rank = 321
    stands_for = f"Libraries that order quaternions in two ways: {FRAMES}."
    where = "written and read quantities of kind quaternion"
    kinds = frozenset({Kind.QUATERNION})
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_ORIENT, [0.8, 0.6, 0.0, 0.0], [0.0, 0.8, 0.6, 0.0], note="0.8 is taken for x"),
        changed(_LOOK, [0.0, 0.0, 0.6, 0.8], [0.0, 0.6, 0.8, 0.0]),
        unchanged(_ORIENT, [0.5, 0.5, 0.5, 0.5], "all parts are the same, so their order is none"),
    )

    def numbers(self, numbers: list[float], context: Context) -> list[float]:
        is_scalar_first = context.quantity.order != "xyzw"
        return [numbers[-1], *numbers[:-1]] if is_scalar_first else [*numbers[1:], numbers[0]]


class QuaternionSign(_OtherNumbers):
    """One part of a quaternion's vector has the wrong sign; the inverse rotation is another operator's."""

    name = "quaternion-sign"
    rank = 322
    stands_for = f"A wrong sign: {SIGNS}."
    where = "written and read quantities of kind quaternion"
    kinds = frozenset({Kind.QUATERNION})
    variants: ClassVar[dict[str, str]] = {part: part for part in "xyz"}
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_ORIENT, [0.8, 0.48, 0.36, 0.0], [0.8, 0.48, -0.36, 0.0], "y"),
        unchanged(_ORIENT, [0.0, 1.0, 0.0, 0.0], "half a turn the other way is the same orientation", "x"),
        unchanged(_ORIENT, [0.8, 0.48, 0.36, 0.0], "a zero has no sign", "z"),
    )

    def numbers(self, numbers: list[float], context: Context) -> list[float]:
        order = context.quantity.order or "wxyz"
        named = zip(order, numbers, strict=True)
        return [-number if part == context.option else number for part, number in named]
