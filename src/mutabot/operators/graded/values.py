"""Values that are off: by an amount, a share, noise, with time, in steps or within a band."""

from __future__ import annotations

from dataclasses import replace
from random import Random
from typing import ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.model.values.units import Dimension, convert
from mutabot.operators.context import Context, Draws
from mutabot.operators.examples import LOCATE, MOVE_TO, changed, reading, unchanged, writing
from mutabot.operators.magnitudes import Ladder, ladder_in, own_ladder, per_second
from mutabot.operators.operator import Example, Need, Subject
from mutabot.operators.rule import PARAMETERS, SENSORS

from ._number import NumberOperator

#: angles that say where something is: a share of them means nothing, as their zero is anywhere
_ANY_ZERO = frozenset({Kind.ORIENTATION, Kind.ANGLE, Kind.TEMPERATURE})
_Z = Quantity("z", Path("z"), Kind.TRANSLATION, "z", "m", "base", Mode.TO, range=(0.0, 0.5))
_MOVE = writing("robot:Arm.move_by", "dy", Kind.TRANSLATION, axis="y", unit="m", frame="base", mode=Mode.BY)
_GO = replace(MOVE_TO, arguments=MOVE_TO.arguments[:1])
_LIFT = Operation("robot:Arm.lift_to", (_Z,))
_ORIENT = writing("robot:Arm.orient", "rotation", Kind.ROTATION_VECTOR, unit="deg")
_FEEL = reading("sensor:gap", Kind.DISTANCE, unit="m")


class Offset(NumberOperator):
    """Adds a fixed amount, or takes it away."""

    name = "offset"
    summary = "A commanded or read value is off by a fixed amount, at every call, in one direction."
    where = "every number that is commanded or read, bar waits"
    stands_for = f"A tool, a fixture or a camera that stands off, or a wrong constant: {PARAMETERS}."
    rank = 200
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_MOVE, 0.2, 0.22, size=("+", 20.0, "mm"), note="the box is put down 20 mm too far"),
        changed(LOCATE, 0.55, 0.545, size=("-", 5.0, "mm"), note="the camera was bumped into"),
        changed(
            _ORIENT,
            [0.0, 0.0, 30.0],
            [0.0, 0.0, 50.0],
            size=("z+", 20.0, "deg"),
            note="an orientation as a whole is turned further, about one axis of its frame",
        ),
        unchanged(_LIFT, 0.45, "0.55 m is outside the range [0, 0.5]", size=("+", 100.0, "mm")),
    )

    def magnitudes(self, quantity: Quantity) -> Ladder | None:
        return None if quantity.kind is Kind.DURATION else own_ladder(quantity)

    def number(self, size: float, value: float, context: Context) -> float:
        return value + size


class Scale(NumberOperator):
    """Multiplies by 1 + ε, or by 1 − ε."""

    name = "scale"
    summary = (
        "A commanded or read value is a share too large (+) or too small (−), as after a wrong calibration."
    )
    where = "every number whose zero means nothing: amounts, positions, distances, no target angles"
    stands_for = f"A wrong gain or calibration factor: {PARAMETERS}."
    rank = 210
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_MOVE, 0.2, 0.21, size=("+", 5.0, "percent")),
        changed(
            _FEEL,
            0.3,
            0.27,
            size=("-", 10.0, "percent"),
            note="a sensor that was calibrated with another target",
        ),
        unchanged(_MOVE, 0.0, "nothing is no share of", size=("+", 5.0, "percent")),
    )

    def magnitudes(self, quantity: Quantity) -> Ladder | None:
        is_target_angle = quantity.kind is Kind.ROTATION and quantity.mode is Mode.TO
        if quantity.is_whole or quantity.kind in _ANY_ZERO or is_target_angle:
            return None
        return ladder_in(quantity, Dimension.RATIO)

    def size_of(self, subject: Subject) -> float:
        return convert(subject.magnitude or 0.0, subject.unit or "fraction", "fraction")

    def number(self, size: float, value: float, context: Context) -> float:
        return value * (1.0 + size)


class SensorNoise(NumberOperator):
    """Adds Gaussian noise to each reading: the same deviates at every magnitude, so much larger."""

    name = "sensor-noise"
    summary = (
        "Each reading is off by Gaussian noise of standard deviation σ. The draws of a round are the same at "
        "every σ: a larger one is the same noise, only larger."
    )
    where = "every number that is read"
    stands_for = f"A worse sensor than the program was written for: {SENSORS}."
    rank = 220
    draws = True
    directions = ("",)
    of_written = False
    fault = "+ noise, σ = {}"
    examples: ClassVar[tuple[Example, ...]] = (
        changed(
            LOCATE,
            0.55,
            # the draw for the first call of the generator that the examples are run with
            0.55 + 0.01 * Draws(Random(1)).of(1).gauss(0.0, 1.0),
            size=("", 10.0, "mm"),
            note="σ = 10 mm",
        ),
        unchanged(LOCATE, None, "there is no number to disturb", size=("", 10.0, "mm")),
    )

    def magnitudes(self, quantity: Quantity) -> Ladder | None:
        return own_ladder(quantity)

    def number(self, size: float, value: float, context: Context) -> float:
        return value + size * context.draw().gauss(0.0, 1.0)


class Drift(NumberOperator):
    """Adds so much per second of simulated time since the test began."""

    name = "drift"
    summary = "A reading drifts: it is off by δ for every second of simulated time since the test began."
    where = "every number that is read, with a clock in the vocabulary"
    stands_for = f"A sensor that warms up, or odometry that is summed: {SENSORS}."
    rank = 230
    needs = frozenset({Need.CLOCK})
    of_written = False
    examples: ClassVar[tuple[Example, ...]] = (
        changed(
            _FEEL,
            0.3,
            0.32,
            size=("+", 2.0, "mm/s"),
            time=10.0,
            note="2 mm per second: after 10 s it reads 20 mm too much",
        ),
        unchanged(_FEEL, 0.3, "no time has passed yet", size=("-", 2.0, "mm/s")),
    )

    def magnitudes(self, quantity: Quantity) -> Ladder | None:
        return per_second(quantity)

    def number(self, size: float, value: float, context: Context) -> float:
        return value + size * context.call.time()

    def unit_of(self, subject: Subject) -> str | None:
        return (subject.unit or "").removesuffix("/s") or None


class Quantise(NumberOperator):
    """Rounds to the nearest multiple of the step."""

    name = "quantise"
    summary = (
        "A commanded or read value is rounded to the nearest multiple of a step, as by a coarse encoder or"
        " converter."
    )
    where = "every number that is commanded or read, bar orientations as a whole"
    stands_for = f"A coarse encoder or converter: {SENSORS}."
    rank = 240
    directions = ("",)
    fault = "in steps of {}"
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_MOVE, 0.23, 0.25, size=("", 50.0, "mm")),
        changed(LOCATE, 0.55, 0.56, size=("", 20.0, "mm")),
        unchanged(_MOVE, 0.2, "it is a multiple of the step", size=("", 50.0, "mm")),
    )

    def magnitudes(self, quantity: Quantity) -> Ladder | None:
        return None if quantity.is_whole or quantity.kind is Kind.COUNT else own_ladder(quantity)

    def number(self, size: float, value: float, context: Context) -> float:
        return round(value / size) * size if size else value


class Deadband(NumberOperator):
    """Keeps to the last value until a new one is further off than the band."""

    name = "deadband"
    summary = (
        "A target or reading that differs from the last one by less than δ is taken for that one; a relative "
        "move shorter than δ is none. As by a worn gear, or a filter against chatter."
    )
    where = "every number that is commanded or read, bar waits and orientations as a whole"
    stands_for = f"Backlash of a worn gear, or a filter against chatter: {SENSORS}."
    rank = 250
    needs = frozenset({Need.MEMORY, Need.COPIES})
    directions = ("",)
    fault = "with a dead band of {}"
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_GO, 0.41, 0.4, size=("", 20.0, "mm"), earlier=(0.4,)),
        changed(_FEEL, 0.31, 0.3, size=("", 20.0, "mm"), earlier=(0.3,)),
        unchanged(_GO, 0.45, "it is far enough from the last target", size=("", 20.0, "mm"), earlier=(0.4,)),
    )

    def magnitudes(self, quantity: Quantity) -> Ladder | None:
        return None if quantity.is_whole or quantity.kind is Kind.DURATION else own_ladder(quantity)

    def number(self, size: float, value: float, context: Context) -> float:
        last: float = 0.0 if context.quantity.mode is Mode.BY else next(iter(context.memory), value)
        after = last if abs(value - last) < size else value
        context.memory[:] = [after]
        return after
