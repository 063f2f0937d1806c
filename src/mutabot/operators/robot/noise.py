"""noise: a reading is disturbed by Gaussian noise."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators.operator import Example, Subject, map_numbers
from mutabot.operators.rule import Published

from ._orientation import disturbed
from ._values import ReadValueOperator, label, quantity_of

#: standard deviation where the vocabulary gives none: a clearly bad sensor, not a broken one (m, rad)
DEFAULT_DEVIATION = {
    Kind.POSITION: (0.02, "m"),
    Kind.DISTANCE: (0.02, "m"),
    Kind.ORIENTATION: (0.05, "rad"),
    Kind.ANGLE: (0.05, "rad"),
    Kind.ROTATION_VECTOR: (0.05, "rad"),
    Kind.QUATERNION: (0.05, "rad"),
    Kind.EULER: (0.05, "rad"),
}

_X = Quantity(".x", Path.parse(".x", rooted=False), Kind.POSITION, "x", "m", "world", noise=1.0)
_LOCATE = Operation("camera:locate", result=(_X,), command=False)


class Noise(ReadValueOperator):
    """Adds normally distributed noise of mean zero to one component of a reading."""

    name = "noise"
    summary = "A position, distance or angle is read with Gaussian noise added."
    rank = 70
    where = "read positions, distances, angles and orientations"
    draws = True
    published = (
        Published(10, "distance value is x", "distance value is x + noise"),
        Published(13, "a position or angle is read", "the reading has Gaussian noise"),
    )
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_LOCATE, quantity=_X),
            replied={".x": 0.55},
            performed=({},),
            # the first draw of Random(1).gauss(0, 1), the generator the examples are run with
            received={".x": 0.55 + Random(1).gauss(0.0, 1.0)},
            note="distance value is x: distance value is x + noise",
        ),
        Example(Subject(_LOCATE, quantity=_X), replied={".x": None}, away="there is no number to disturb"),
    )

    def fits(self, quantity: Quantity) -> bool:
        return quantity.is_measured and quantity.kind in DEFAULT_DEVIATION

    def change(self, subject: Subject, value: Value, random: Random) -> Value | None:
        quantity = quantity_of(subject)
        deviation = deviation_of(quantity)
        if quantity.is_whole:
            return disturbed(quantity, value, random, deviation)

        def noisy_number(number: float) -> float:
            noisy = number + random.gauss(0.0, deviation)
            if quantity.range is not None:
                noisy = min(max(noisy, quantity.range[0]), quantity.range[1])
            return round(noisy) if isinstance(number, int) else noisy

        return map_numbers(value, noisy_number)

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = quantity_of(subject)
        deviation = quantity.text(deviation_of(quantity))
        if quantity.is_whole:
            deviation = f"{deviation if quantity.unit else f'{deviation} rad'} about each axis"
        return f"reads {label(quantity)} {quantity.text(before)} + noise, σ = {deviation}"


def deviation_of(quantity: Quantity) -> float:
    """Standard deviation of the noise, in the quantity's unit."""
    if quantity.noise is not None:
        return quantity.noise
    amount, unit = DEFAULT_DEVIATION[quantity.kind]
    return quantity.from_unit(amount, unit)
