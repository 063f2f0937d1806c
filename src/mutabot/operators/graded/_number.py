"""The shape of graded operators on numbers: a mutant per component, direction and magnitude."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterable
from typing import ClassVar

from mutabot.families import GRADED
from mutabot.model import Kind, Quantity
from mutabot.model.values.quantity import Value
from mutabot.model.values.rotation import from_rotation_vector, product
from mutabot.model.values.units import convert_difference
from mutabot.operators.context import Context, quantity_of
from mutabot.operators.operator import Subject, is_number
from mutabot.operators.value import ValueOperator, label

#: components of a slice without an end that are tried: those of an arm with seven joints
_JOINTS = 7


class NumberOperator(ValueOperator):
    """Changes one number, by a magnitude.

    Class attributes:
        fault: the fault in words, behind the name of the quantity, with ``{}`` for the magnitude; empty where
            that is added.
    """

    family = GRADED
    has_sizes = True
    directions: ClassVar[tuple[str, ...]] = ("+", "-")
    fault: ClassVar[str] = ""

    @abstractmethod
    def number(self, size: float, value: float, context: Context) -> float:
        """The new number. ``size``: the magnitude in the quantity's unit, negative in the direction ``-``."""

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.is_measured and self.magnitudes(quantity) is not None

    def directions_of(self, quantity: Quantity) -> Iterable[str]:
        return [part + direction for part in _components_of(quantity) for direction in self.directions]

    def size_of(self, subject: Subject) -> float:
        """The magnitude in the quantity's unit."""
        quantity, size = quantity_of(subject), subject.magnitude or 0.0
        unit = self.unit_of(subject)
        if unit is not None and unit != quantity.unit:
            size = convert_difference(size, unit, quantity.unit or "rad")
        return size

    def unit_of(self, subject: Subject) -> str | None:
        """The unit of what is added to the value."""
        return subject.unit

    def change(self, value: Value, context: Context) -> Value | None:
        size = self.size_of(context.subject)
        size = -size if context.subject.direction.endswith("-") else size
        return _in_component(context, value, lambda number: self.number(size, number, context))

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        verb = "" if subject.is_written else "reads "
        component = subject.direction.rstrip("+-")
        about = f" about {component}" if component and not component.startswith("[") else component
        return f"{verb}{label(quantity_of(subject))}{about} {self._fault(subject)}"

    def _fault(self, subject: Subject) -> str:
        size = f"{subject.magnitude:g}"
        if self.fault:
            return self.fault.format(f"{size}{f' {subject.unit}' if subject.unit else ''}")
        way = {"+": "+ ", "-": "− "}.get(subject.direction[-1:], "")
        unit = {"percent": " %", None: ""}.get(subject.unit, f" {subject.unit}")
        return f"{way}{size}{unit}"


def _components_of(quantity: Quantity) -> tuple[str, ...]:
    """The components of which one is changed: indices of a vector, axes of an orientation; else ``""``."""
    if quantity.is_whole:
        return ("x", "y", "z")
    bounds = quantity.path.steps[-1].bounds if quantity.path.steps else None
    if bounds is None:
        return ("",)
    first, last, step = bounds
    count = len(range(first or 0, last, step or 1)) if last is not None and last > 0 else _JOINTS
    return tuple(f"[{index}]" for index in range(count))


def _in_component(context: Context, value: Value, change: Callable[[float], float]) -> Value | None:
    """A value with one number of it changed: of an orientation, the angle by which an axis turns it."""
    quantity, component = context.quantity, context.subject.direction.rstrip("+-")
    if quantity.is_whole:
        return _turned(quantity, component, value, change)
    if not component:
        return _like(quantity, value, change(value)) if is_number(value) else None
    index = int(component.strip("[]"))
    try:
        before = value[index]
    except (TypeError, IndexError, KeyError):
        return None
    if not is_number(before):
        return None
    copy = value.copy() if hasattr(value, "copy") else list(value)
    copy[index] = _like(quantity, before, change(float(before)))
    return type(value)(copy) if isinstance(value, tuple) else copy


def _turned(quantity: Quantity, axis: str, value: Value, change: Callable[[float], float]) -> Value | None:
    orientation = quantity.orientation(value)
    if orientation is None:
        return None
    angle = change(0.0)
    radians = convert_difference(angle, quantity.unit or "rad", "rad")
    turn = from_rotation_vector([radians if one == axis else 0.0 for one in "xyz"])
    return quantity.numbers(product(turn, orientation))


def _like(quantity: Quantity, before: Value, after: float) -> float:
    """A count stays a whole number; any other may have parts."""
    return round(after) if quantity.kind is Kind.COUNT and isinstance(before, int) else after
