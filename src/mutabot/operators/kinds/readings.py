"""Operators on readings: wrong sign, noise, and misread labels."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from random import Random

from mutabot.model import Kind, Operation, Quantity
from mutabot.model.quantity import MEASURED, PLAIN, WHOLE, Value
from mutabot.model.units import convert, from_rotation_vector
from mutabot.operators.examples import LOCATE, X
from mutabot.operators.operator import Context, Example, Subject
from mutabot.operators.value import ValueOperator

#: standard deviation where the vocabulary gives none: a clearly bad sensor, not a broken one (m, rad)
DEFAULT_DEVIATION = {
    **dict.fromkeys((Kind.POSITION, Kind.DISTANCE), (0.02, "m")),
    **dict.fromkeys((Kind.ORIENTATION, Kind.ANGLE, *WHOLE), (0.05, "rad")),
}
#: up to this many labels, each other label is a mutant of its own; with more, only the next one is
ALL_UP_TO = 4

_SEE = Operation.reading("camera:colour", Kind.LABEL, values=("red", "blue"))
_IN_MM = Operation.reading("laser:distance", Kind.DISTANCE, unit="mm")
_LOOK = Operation.reading("camera:orientation", Kind.QUATERNION, order="wxyz")
_NOISY = replace(LOCATE, result=(replace(X, noise=1.0),))
_SORT = Operation.reading("camera:part", Kind.LABEL, values=("nut", "bolt", "washer"))
_FEEL = Operation.reading("gripper:holding", Kind.FLAG, values=(False, True))


class Negate(ValueOperator):
    """A position, distance or angle is read with the wrong sign; an orientation as a whole is inverted.

    Where: read positions, distances, angles and orientations.

    Published: 9. distance value is x → distance value is −x
    """

    name = "negate"
    is_common = True
    kinds = MEASURED - PLAIN
    of_written = False
    examples = (
        Example.changed(LOCATE, 0.55, -0.55),
        Example.changed(_IN_MM, 12, -12),
        Example.changed(_LOOK, [0.8, 0.6, 0.0, 0.0], [0.8, -0.6, 0.0, 0.0]),
        Example.unchanged(LOCATE, 0.0, "a zero has no sign"),
        Example.unchanged(LOCATE, {}, "the reading has no such part this time"),
    )

    def change(self, value: Value, context: Context) -> Value | None:
        quantity = context.quantity
        if quantity.is_whole:
            return quantity.inverted(value)
        return quantity.map_numbers(value, lambda number: -number)


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
        Example.changed(
            _NOISY,
            0.55,
            # the first draw of Random(1).gauss(0, 1), the generator the examples are run with
            0.55 + Random(1).gauss(0.0, 1.0),
        ),
        Example.unchanged(_NOISY, None, "there is no number to disturb"),
    )

    def change(self, value: Value, context: Context) -> Value | None:
        quantity, random = context.quantity, context.random
        deviation = deviation_of(quantity)
        if quantity.is_whole:
            return disturbed(quantity, value, random, deviation)

        def noisy_number(number: float) -> float:
            noisy = number + random.gauss(0.0, deviation)
            if quantity.range is not None:
                noisy = min(max(noisy, quantity.range[0]), quantity.range[1])
            return round(noisy) if isinstance(number, int) else noisy

        return quantity.map_numbers(value, noisy_number)

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = subject.required_quantity
        deviation = quantity.text(deviation_of(quantity))
        if quantity.is_whole:
            deviation = f"{deviation if quantity.unit else f'{deviation} rad'} about each axis"
        return f"reads {quantity.label} {quantity.text(before)} + noise, σ = {deviation}"


class Misread(ValueOperator):
    """A label, such as a colour, or a flag is read as another one.

    Where: read labels and flags.

    Published: 12. a colour is classified → an incorrect colour is returned
    """

    name = "misread"
    is_common = True
    of_written = False
    examples = (
        Example.changed(_SEE, "red", "blue"),
        Example.changed(_SORT, "bolt", "nut", "+2"),
        Example.changed(_FEEL, True, False),
        Example.unchanged(_SEE, "grey", "not one of the labels"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.kind in (Kind.LABEL, Kind.FLAG) and len(quantity.values or ()) > 1

    def variants_of(self, quantity: Quantity) -> Iterable[str]:
        labels = len(quantity.values or ())
        return [f"+{shift}" for shift in range(1, labels)] if 2 < labels <= ALL_UP_TO else [""]

    def change(self, value: Value, context: Context) -> Value | None:
        return context.next_value(value, int(context.subject.variant or "1"))


def deviation_of(quantity: Quantity) -> float:
    """Return the standard deviation of the noise, in the quantity's unit."""
    if quantity.noise is not None:
        return quantity.noise
    amount, unit = DEFAULT_DEVIATION[quantity.kind]
    return quantity.from_unit(amount, unit)


def disturbed(quantity: Quantity, value: Value, random: Random, deviation: float) -> Value | None:
    """Return an orientation turned at random, with this standard deviation about each axis."""
    sigma = convert(deviation, quantity.unit or "rad", "rad")
    turn = from_rotation_vector([random.gauss(0.0, sigma) for _ in range(3)])
    return quantity.rotated(value, turn.after)
