"""Graded faults, whose magnitude is part of the mutant.

Values are off by an amount, a share, noise, with time, in steps or within a band; waits end early, commands
and readings come late.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import replace
from random import Random
from typing import TYPE_CHECKING, ClassVar

from mutabot.families import GRADED
from mutabot.model import Call, Kind, Mode, Operation, Proceed, Quantity, Reply
from mutabot.model.units import Dimension, convert, convert_difference, from_rotation_vector
from mutabot.operators.command import CommandOperator
from mutabot.operators.examples import LOCATE, MOVE_TO
from mutabot.operators.magnitudes import Magnitudes, ladder_in, own_ladder, per_second
from mutabot.operators.operator import Context, Example, Need, Subject
from mutabot.operators.value import ValueOperator

if TYPE_CHECKING:
    from mutabot.model.quantity import Value

#: components of a slice without an end that are tried: those of an arm with seven joints
_JOINTS = 7


class NumberOperator(ValueOperator):
    """The base class of operators that change one number by a magnitude.

    Class attributes:
        fault: description of the fault, behind the name of the quantity, with ``{}`` for the magnitude; empty
            where that is added.
    """

    family = GRADED
    has_sizes = True
    directions: ClassVar[tuple[str, ...]] = ("+", "-")
    fault: ClassVar[str] = ""

    @abstractmethod
    def number(self, size: float, value: float, context: Context) -> float:
        """Return the new number; ``size`` is in the quantity's unit, negative for direction ``-``."""

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.kind.is_measured and self.magnitudes(quantity) is not None

    def directions_of(self, quantity: Quantity) -> Iterable[str]:
        return [part + direction for part in _components_of(quantity) for direction in self.directions]

    def size_of(self, subject: Subject) -> float:
        """Return the magnitude in the quantity's unit."""
        quantity, size = subject.required_quantity, subject.magnitude or 0.0
        unit = self.unit_of(subject)
        if unit is not None and unit != quantity.unit:
            size = convert_difference(size, unit, quantity.unit or "rad")
        return size

    def unit_of(self, subject: Subject) -> str | None:
        """Return the unit of the number that is added to the value."""
        return subject.unit

    def change(self, value: Value, context: Context) -> Value | None:
        size = self.size_of(context.subject)
        size = -size if context.subject.direction.endswith("-") else size
        return _in_component(context, value, lambda number: self.number(size, number, context))

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        verb = "" if subject.is_written else "reads "
        component = subject.direction.rstrip("+-")
        about = f" about {component}" if component and not component.startswith("[") else component
        return f"{verb}{subject.required_quantity.label}{about} {self._fault(subject)}"

    def _fault(self, subject: Subject) -> str:
        size = f"{subject.magnitude:g}"
        if self.fault:
            return self.fault.format(f"{size}{f' {subject.unit}' if subject.unit else ''}")
        way = {"+": "+ ", "-": "− "}.get(subject.direction[-1:], "")
        unit = {"percent": " %", None: ""}.get(subject.unit, f" {subject.unit}")
        return f"{way}{size}{unit}"


def _components_of(quantity: Quantity) -> tuple[str, ...]:
    """Return the indices of a vector or the axes of an orientation; ``("",)`` for other quantities."""
    if quantity.is_whole:
        return ("x", "y", "z")
    bounds = quantity.path.steps[-1].bounds if quantity.path.steps else None
    if bounds is None:
        return ("",)
    first, last, step = bounds
    count = len(range(first or 0, last, step or 1)) if last is not None and last > 0 else _JOINTS
    return tuple(f"[{index}]" for index in range(count))


def _in_component(context: Context, value: Value, change: Callable[[float], float]) -> Value | None:
    """Return a value with one number changed: of an orientation, the angle about an axis."""
    quantity, component = context.quantity, context.subject.direction.rstrip("+-")
    if quantity.is_whole:
        return _turned(quantity, component, value, change)
    if not component:
        return _like(quantity, value, change(value)) if quantity.is_scalar(value) else None
    index = int(component.strip("[]"))
    try:
        before = value[index]
    except (TypeError, IndexError, KeyError):
        return None
    if not quantity.is_scalar(before):
        return None
    copy = value.copy() if hasattr(value, "copy") else list(value)
    copy[index] = _like(quantity, before, change(float(before)))
    return type(value)(copy) if isinstance(value, tuple) else copy


def _turned(quantity: Quantity, axis: str, value: Value, change: Callable[[float], float]) -> Value | None:
    radians = convert_difference(change(0.0), quantity.unit or "rad", "rad")
    turn = from_rotation_vector([radians if other == axis else 0.0 for other in "xyz"])
    return quantity.rotated(value, turn.after)


def _like(quantity: Quantity, before: Value, after: float) -> float:
    """Return the new number, rounded if the quantity is a count."""
    is_count = quantity.kind is Kind.COUNT and isinstance(before, int) and math.isfinite(after)
    return round(after) if is_count else after


#: angles that say where something is: a share of them means nothing, as their zero is anywhere
_ANY_ZERO = frozenset({Kind.ORIENTATION, Kind.ANGLE, Kind.TEMPERATURE})
_MOVE = Operation.writing(
    "robot:Arm.move_by", "dy", Kind.TRANSLATION, axis="y", unit="m", frame="base", mode=Mode.BY
)
_GO = replace(MOVE_TO, arguments=MOVE_TO.arguments[:1])
_LIFT = Operation.writing(
    "robot:Arm.lift_to", "z", Kind.TRANSLATION, axis="z", unit="m", mode=Mode.TO, range=(0, 0.5)
)
_ORIENT = Operation.writing("robot:Arm.orient", "rotation", Kind.ROTATION_VECTOR, unit="deg")
_MEANT = Subject(LOCATE)
_FEEL = Operation.reading("sensor:gap", Kind.DISTANCE, unit="m")


class Offset(NumberOperator):
    """A commanded or read value is off by a fixed amount in one direction; an orientation as a whole is
    turned about one axis of its frame.

    Where: every number that is commanded or read, bar waits.

    Stands for: A tool, a fixture or a camera that stands off, or a wrong constant: {parameters}.
    """

    name = "offset"
    examples = (
        Example.changed(_MOVE, 0.2, 0.22, size=("+", 20.0, "mm")),
        Example.changed(LOCATE, 0.55, 0.545, size=("-", 5.0, "mm")),
        Example.changed(_ORIENT, [0.0, 0.0, 30.0], [0.0, 0.0, 50.0], size=("z+", 20.0, "deg")),
        Example.unchanged(_LIFT, 0.45, "0.55 m is outside the range [0, 0.5]", size=("+", 100.0, "mm")),
    )

    def magnitudes(self, quantity: Quantity) -> Magnitudes | None:
        return None if quantity.kind is Kind.DURATION else own_ladder(quantity)

    def number(self, size: float, value: float, context: Context) -> float:
        return value + size


class Scale(NumberOperator):
    """A commanded or read value is a share too large (+) or too small (−), as after a wrong calibration.

    Where: every number whose zero means nothing: amounts, positions, distances, no target angles.

    Stands for: A wrong gain or calibration factor: {parameters}.
    """

    name = "scale"
    examples = (
        Example.changed(_MOVE, 0.2, 0.21, size=("+", 5.0, "percent")),
        Example.changed(_FEEL, 0.3, 0.27, size=("-", 10.0, "percent")),
        Example.unchanged(_MOVE, 0.0, "nothing is no share of", size=("+", 5.0, "percent")),
    )

    def magnitudes(self, quantity: Quantity) -> Magnitudes | None:
        is_target_angle = quantity.kind is Kind.ROTATION and quantity.mode is Mode.TO
        if quantity.is_whole or quantity.kind in _ANY_ZERO or is_target_angle:
            return None
        return ladder_in(quantity, Dimension.RATIO)

    def size_of(self, subject: Subject) -> float:
        return convert(subject.magnitude or 0.0, subject.unit or "fraction", "fraction")

    def number(self, size: float, value: float, context: Context) -> float:
        return value * (1.0 + size)


class SensorNoise(NumberOperator):
    """Each reading has Gaussian noise of standard deviation σ; in a round the draws are the same at every
    σ, only scaled.

    Where: every number that is read.

    Stands for: A worse sensor than the program was written for: {sensors}.
    """

    name = "sensor-noise"
    draws = True
    directions = ("",)
    of_written = False
    fault = "+ noise, σ = {}"
    examples = (
        Example.changed(
            LOCATE,
            0.55,
            # the draw for the first call of the generator that the examples are run with
            0.55 + 0.01 * Context(_MEANT, Random(1), number=1).draw().gauss(0.0, 1.0),
            size=("", 10.0, "mm"),
        ),
        Example.unchanged(LOCATE, None, "there is no number to disturb", size=("", 10.0, "mm")),
    )

    def magnitudes(self, quantity: Quantity) -> Magnitudes | None:
        return own_ladder(quantity)

    def number(self, size: float, value: float, context: Context) -> float:
        return value + size * context.draw().gauss(0.0, 1.0)


class Drift(NumberOperator):
    """A reading is off by δ for every second of simulated time since the test began. Needs a `clock`.

    Where: every number that is read, with a clock in the vocabulary.

    Stands for: A sensor that warms up, or odometry that is summed: {sensors}.
    """

    name = "drift"
    needs = frozenset({Need.CLOCK})
    of_written = False
    examples = (
        Example.changed(_FEEL, 0.3, 0.32, size=("+", 2.0, "mm/s"), time=10.0),
        Example.unchanged(_FEEL, 0.3, "no time has passed yet", size=("-", 2.0, "mm/s")),
    )

    def magnitudes(self, quantity: Quantity) -> Magnitudes | None:
        return per_second(quantity)

    def number(self, size: float, value: float, context: Context) -> float:
        return value + size * context.call.time()

    def unit_of(self, subject: Subject) -> str | None:
        return (subject.unit or "").removesuffix("/s") or None


class Quantise(NumberOperator):
    """A commanded or read value is rounded to a multiple of a step, as by a coarse encoder.

    Where: every number that is commanded or read, bar orientations as a whole.

    Stands for: A coarse encoder or converter: {sensors}.
    """

    name = "quantise"
    directions = ("",)
    fault = "in steps of {}"
    examples = (
        Example.changed(_MOVE, 0.23, 0.25, size=("", 50.0, "mm")),
        Example.changed(LOCATE, 0.55, 0.56, size=("", 20.0, "mm")),
        Example.unchanged(_MOVE, 0.2, "it is a multiple of the step", size=("", 50.0, "mm")),
        Example.unchanged(_MOVE, math.inf, "no multiple of the step is near", size=("", 50.0, "mm")),
    )

    def magnitudes(self, quantity: Quantity) -> Magnitudes | None:
        return None if quantity.is_whole or quantity.kind is Kind.COUNT else own_ladder(quantity)

    def number(self, size: float, value: float, context: Context) -> float:
        steps = value / size if size else math.inf
        return round(steps) * size if math.isfinite(steps) else value


class Deadband(NumberOperator):
    """A target or reading that differs from the last one by less than δ is taken for that one; a relative
    move shorter than δ is not made.

    Where: every number that is commanded or read, bar waits and orientations as a whole.

    Stands for: Backlash of a worn gear, or a filter against chatter: {sensors}.
    """

    name = "deadband"
    needs = frozenset({Need.MEMORY, Need.COPIES})
    directions = ("",)
    fault = "with a dead band of {}"
    examples = (
        Example.changed(_GO, 0.41, 0.4, size=("", 20.0, "mm"), earlier=(0.4,)),
        Example.changed(_FEEL, 0.31, 0.3, size=("", 20.0, "mm"), earlier=(0.3,)),
        Example.unchanged(
            _GO, 0.45, "far enough from the last target", size=("", 20.0, "mm"), earlier=(0.4,)
        ),
    )

    def magnitudes(self, quantity: Quantity) -> Magnitudes | None:
        return None if quantity.is_whole or quantity.kind is Kind.DURATION else own_ladder(quantity)

    def number(self, size: float, value: float, context: Context) -> float:
        last: float = 0.0 if context.quantity.mode is Mode.BY else next(iter(context.memory), value)
        after = last if abs(value - last) < size else value
        context.memory[:] = [after]
        return after


_PAUSE = Operation.writing("cell:Cell.wait", "seconds", Kind.DURATION, unit="s", range=(0.0, 3600.0))
_HOME = Operation("robot:Arm.home")


class Lag(CommandOperator):
    """Each command is carried out later; each reading was taken earlier. Needs a `wait` in the vocabulary,
    or a middleware.

    Where: every command that is no wait, and every reading, with a `wait` in the vocabulary or a middleware.

    Stands for: A busy network or controller: {timing}.
    """

    name = "lag"
    family = GRADED
    has_sizes = True
    needs = frozenset({Need.WAIT, Need.PROGRAM})
    examples = (
        Example.whole(_HOME, {}, {}, size=(200.0, "ms"), waited=0.2),
        Example.whole(_FEEL, 0.3, size=(50.0, "ms"), waited=0.05),
    )

    def fits(self, whole: Subject) -> bool:
        waits = any(quantity.kind is Kind.DURATION for quantity in whole.written)
        return (whole.is_command or bool(whole.read)) and not waits

    def magnitudes(self, whole: Subject) -> Magnitudes | None:
        named = next(
            (quantity for quantity in (*whole.written, *whole.read) if quantity.ladder_unit is not None), None
        )
        return ladder_in(named, Dimension.TIME)

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        seconds = convert(context.subject.magnitude or 0.0, context.subject.unit or "s", "s")
        if call.is_command:
            await call.wait(seconds)
            return await proceed(call)
        reply = await proceed(call)
        await call.wait(seconds)
        return reply

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        what = "is carried out" if subject.is_command else "comes"
        return f"{what} {subject.magnitude:g} {subject.unit} later"


class Early(NumberOperator):
    """A wait is shorter, so that what comes next comes too early.

    Where: waits: arguments of kind `duration`.

    Stands for: A wait that was measured on a faster machine: {timing}.
    """

    name = "early"
    directions = ("-",)
    of_read = False
    examples = (
        Example.changed(_PAUSE, 0.8, 0.6, size=("-", 200.0, "ms")),
        Example.unchanged(_PAUSE, 0.8, "no wait is shorter than nothing", size=("-", 1000.0, "ms")),
    )

    def magnitudes(self, quantity: Quantity) -> Magnitudes | None:
        return ladder_in(quantity, Dimension.TIME) if quantity.kind is Kind.DURATION else None

    def number(self, size: float, value: float, context: Context) -> float:
        after = value + size
        return after if after >= -1e-9 else value
