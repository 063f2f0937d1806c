"""Commands that are carried out too weakly, too strongly or not fully."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from mutabot.families import CATALOGUE
from mutabot.model import Kind, Quantity
from mutabot.model.quantity import Value
from mutabot.operators.examples import changed, unchanged, writing
from mutabot.operators.numbers import like, map_numbers, middle_of, within
from mutabot.operators.operator import Context, Example, Subject
from mutabot.operators.studies import COMMANDS, PARAMETERS
from mutabot.operators.value import ValueOperator

_SPEED = writing("robot:Arm.set_speed", "speed", Kind.SPEED, unit="m/s", range=(0.0, 1.0))
_PRESS = writing("robot:Arm.press", "force", Kind.FORCE, unit="N")
_GRIP = writing("robot:Gripper.set_force", "newtons", Kind.FORCE, unit="N", range=(20.0, 235.0))
_LIMITED = writing("robot:Gripper.set_force", "newtons", Kind.FORCE, unit="N", range=(0.0, 100.0))
_PAYLOAD = writing("robot:Arm.set_payload", "mass", Kind.MASS, unit="kg", range=(0.0, 5.0))
_OPEN = writing("robot:Gripper.move", "width", Kind.OPENING, unit="mm", range=(0.0, 85.0))


class _Factor(ValueOperator):
    """Multiplies a commanded number; what leaves its range stays at the end of it.

    Class attributes:
        is_limited: whether it does.
    """

    family = CATALOGUE
    stands_for = f"A wrong parameter: {PARAMETERS}."
    of_read = False
    variants: ClassVar[Mapping[str, float]] = {"x0.5": 0.5, "x2": 2.0}
    is_limited: ClassVar[bool] = True

    def change(self, value: Value, context: Context) -> Value | None:
        limits = context.quantity.range if self.is_limited else None
        return map_numbers(value, lambda number: like(number, within(context.option * number, limits)))


class SpeedOverride(_Factor):
    """A speed or acceleration is 50 % or 200 % of what is commanded, within its range."""

    name = "speed-override"
    rank = 350
    where = "written quantities of kind speed, acceleration or jerk"
    kinds = frozenset({Kind.SPEED, Kind.ACCELERATION, Kind.JERK})
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_SPEED, 0.5, 0.25, "x0.5"),
        changed(_SPEED, 0.8, 1.0, "x2", note="its range ends there"),
        unchanged(_SPEED, 1.0, "it is at the end of its range", "x2"),
    )


class ForceOverride(_Factor):
    """A force or torque is 50 % or 200 % of what is commanded, within its range."""

    name = "force-override"
    rank = 351
    where = "written quantities of kind force or torque"
    kinds = frozenset({Kind.FORCE, Kind.TORQUE})
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_PRESS, 40.0, 20.0, "x0.5"),
        changed(_PRESS, 40.0, 80.0, "x2"),
        unchanged(_PRESS, 0.0, "twice nothing is nothing", "x2"),
    )


class WeakGrip(_Factor):
    """A gripper has 30 % of the force that it is told to have, or the least of its range."""

    name = "weak-grip"
    rank = 352
    where = "written quantities of kind force, in calls that command no motion"
    variants: ClassVar[Mapping[str, float]] = {"x0.3": 0.3}
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_GRIP, 160, 48, "x0.3"),
        changed(_GRIP, 40, 20, "x0.3", note="the least of its range"),
        unchanged(_GRIP, 20, "it is the least already", "x0.3"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        motions = (Kind.TRANSLATION, Kind.ROTATION)
        return quantity.kind is Kind.FORCE and not any(
            one.kind in motions or one.is_whole for one in whole.written
        )


class WrongPayload(_Factor):
    """The payload that is set is none, or twice as heavy as it is."""

    name = "wrong-payload"
    rank = 353
    where = "written quantities of kind mass"
    kinds = frozenset({Kind.MASS})
    variants: ClassVar[Mapping[str, float]] = {"none": 0.0, "double": 2.0}
    is_limited = False
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_PAYLOAD, 1.2, 0.0, "none"),
        changed(_PAYLOAD, 1.2, 2.4, "double"),
        unchanged(_PAYLOAD, 4.0, "the robot takes 5 kg at most", "double"),
        unchanged(_PAYLOAD, 0.0, "there is none to forget", "none"),
    )


class PartialOpening(ValueOperator):
    """A gripper stops half way, as seen from the end of its range that is farther off: half open, half
    closed.
    """

    name = "partial-opening"
    family = CATALOGUE
    rank = 354
    stands_for = f"Commands that are not carried out in full, as by a gripper that jams: {COMMANDS}."
    where = "openings with a range or clip; those of two values take no other"
    of_read = False
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_OPEN, 80.0, 40.0),
        changed(_OPEN, 0.0, 42.5, note="half closed"),
        unchanged(_OPEN, {}, "the call says nothing of it"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.kind is Kind.OPENING and _has_limits(quantity)

    def change(self, value: Value, context: Context) -> Value | None:
        low, high = middle_of(context.quantity, 1.0)

        def half(number: float) -> float:
            far = low if number - low >= high - number else high
            return like(number, (number + far) / 2.0)

        return map_numbers(value, half)


class SilentLimit(ValueOperator):
    """A commanded value is limited to the middle 80 % of its range, without notice."""

    name = "silent-limit"
    family = CATALOGUE
    rank = 355
    stands_for = f"A wrong parameter: {PARAMETERS}."
    where = "written numbers with a range or clip"
    of_read = False
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_LIMITED, 100, 90),
        unchanged(_LIMITED, 50, "it is within"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        is_number = quantity.is_measured or quantity.kind in (Kind.OPENING, Kind.OUTPUT)
        return is_number and _has_limits(quantity) and not quantity.is_whole

    def change(self, value: Value, context: Context) -> Value | None:
        limits = middle_of(context.quantity, 0.8)
        return map_numbers(value, lambda number: like(number, within(number, limits)))


def _has_limits(quantity: Quantity) -> bool:
    return (quantity.range or quantity.clip) is not None and quantity.values is None
