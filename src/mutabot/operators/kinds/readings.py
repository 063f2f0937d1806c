"""Readings with the wrong sign or with noise, and labels that are misread."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from random import Random

from mutabot.model import Kind, Quantity
from mutabot.model.quantity import MEASURED, PLAIN, WHOLE, Value
from mutabot.model.units import convert, from_rotation_vector, product
from mutabot.operators.examples import LOCATE, X, changed, reading, unchanged
from mutabot.operators.operator import Context, Subject, quantity_of
from mutabot.operators.value import ValueOperator, label, map_numbers, next_of, the_other_way, turned, within

#: standard deviation where the vocabulary gives none: a clearly bad sensor, not a broken one (m, rad)
DEFAULT_DEVIATION = {
    **dict.fromkeys((Kind.POSITION, Kind.DISTANCE), (0.02, "m")),
    **dict.fromkeys((Kind.ORIENTATION, Kind.ANGLE, *WHOLE), (0.05, "rad")),
}
#: up to this many labels, each other label is a mutant of its own; with more, only the next one is
ALL_UP_TO = 4

_SEE = reading("camera:colour", Kind.LABEL, values=("red", "blue"))
_IN_MM = reading("laser:distance", Kind.DISTANCE, unit="mm")
_LOOK = reading("camera:orientation", Kind.QUATERNION, order="wxyz")
_NOISY = replace(LOCATE, result=(replace(X, noise=1.0),))
_SORT = reading("camera:part", Kind.LABEL, values=("nut", "bolt", "washer"))
_FEEL = reading("gripper:holding", Kind.FLAG, values=(False, True))


class Negate(ValueOperator):
    """A position, distance or angle is read with the wrong sign; an orientation as a whole is inverted.

    Where: read positions, distances, angles and orientations.

    Published: 9. distance value is x → distance value is −x
    """

    name = "negate"
    kinds = MEASURED - PLAIN
    of_written = False
    examples = (
        changed(LOCATE, 0.55, -0.55),
        changed(_IN_MM, 12, -12),
        changed(_LOOK, [0.8, 0.6, 0.0, 0.0], [0.8, -0.6, 0.0, 0.0]),
        unchanged(LOCATE, 0.0, "a zero has no sign"),
        unchanged(LOCATE, {}, "the reading has no such part this time"),
    )

    def change(self, value: Value, context: Context) -> Value | None:
        if context.quantity.is_whole:
            return the_other_way(context.quantity, value)
        return map_numbers(value, lambda number: -number)


class Noise(ValueOperator):
    """A position, distance or angle is read with Gaussian noise added.

    A reading that is an integer stays one, so noise below half a unit leaves it as it is.

    Where: read positions, distances, angles and orientations.

    Published: 10. distance value is x → distance value is x + noise; 13. a position or angle is read →
    the reading has Gaussian noise
    """

    name = "noise"
    kinds = frozenset(DEFAULT_DEVIATION)
    draws = True
    of_written = False
    examples = (
        changed(
            _NOISY,
            0.55,
            # the first draw of Random(1).gauss(0, 1), the generator the examples are run with
            0.55 + Random(1).gauss(0.0, 1.0),
        ),
        unchanged(_NOISY, None, "there is no number to disturb"),
    )

    def change(self, value: Value, context: Context) -> Value | None:
        quantity, random = context.quantity, context.random
        deviation = deviation_of(quantity)
        if quantity.is_whole:
            return disturbed(quantity, value, random, deviation)

        def noisy_number(number: float) -> float:
            noisy = within(number + random.gauss(0.0, deviation), quantity.range)
            return round(noisy) if isinstance(number, int) else noisy

        return map_numbers(value, noisy_number)

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = quantity_of(subject)
        deviation = quantity.text(deviation_of(quantity))
        if quantity.is_whole:
            deviation = f"{deviation if quantity.unit else f'{deviation} rad'} about each axis"
        return f"reads {label(quantity)} {quantity.text(before)} + noise, σ = {deviation}"


class Misread(ValueOperator):
    """A label, such as a colour, or a flag is read as another one.

    Where: read labels and flags.

    Published: 12. a colour is classified → an incorrect colour is returned
    """

    name = "misread"
    of_written = False
    examples = (
        changed(_SEE, "red", "blue"),
        changed(_SORT, "bolt", "nut", "+2"),
        changed(_FEEL, True, False),
        unchanged(_SEE, "grey", "not one of the labels"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.kind in (Kind.LABEL, Kind.FLAG) and len(quantity.values or ()) > 1

    def variants_of(self, quantity: Quantity) -> Iterable[str]:
        labels = len(quantity.values or ())
        return [f"+{shift}" for shift in range(1, labels)] if 2 < labels <= ALL_UP_TO else [""]

    def change(self, value: Value, context: Context) -> Value | None:
        return next_of(value, context.quantity, int(context.subject.variant or "1"))


def deviation_of(quantity: Quantity) -> float:
    """Standard deviation of the noise, in the quantity's unit."""
    if quantity.noise is not None:
        return quantity.noise
    amount, unit = DEFAULT_DEVIATION[quantity.kind]
    return quantity.from_unit(amount, unit)


def disturbed(quantity: Quantity, value: Value, random: Random, deviation: float) -> Value | None:
    """The orientation turned by a random rotation vector of this standard deviation in each part."""
    sigma = convert(deviation, quantity.unit or "rad", "rad")
    turn = from_rotation_vector([random.gauss(0.0, sigma) for _ in range(3)])
    return turned(quantity, value, lambda orientation: product(turn, orientation))
