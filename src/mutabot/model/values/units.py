"""Units a vocabulary may use, and their conversion to SI."""

from __future__ import annotations

import math
from enum import StrEnum
from typing import NamedTuple


class Dimension(StrEnum):
    """What a unit measures."""

    LENGTH = "length"
    ANGLE = "angle"
    TIME = "time"
    RATIO = "ratio"
    SPEED = "speed"
    ANGULAR_SPEED = "angular speed"
    ACCELERATION = "acceleration"
    ANGULAR_ACCELERATION = "angular acceleration"
    JERK = "jerk"
    ANGULAR_JERK = "angular jerk"
    FORCE = "force"
    TORQUE = "torque"
    MASS = "mass"
    TEMPERATURE = "temperature"
    VOLTAGE = "voltage"
    CURRENT = "current"
    PRESSURE = "pressure"
    FREQUENCY = "frequency"


class Unit(NamedTuple):
    """A unit.

    Attributes:
        dimension: what it measures.
        factor: how many of the SI's unit (metre, radian, second, fraction, kilogram …) it is.
        zero: where its scale begins, in the SI's unit.
    """

    dimension: Dimension
    factor: float
    zero: float = 0.0


_DEGREE = math.pi / 180.0
#: by the names that vocabularies write; a test holds them against pint's
UNITS: dict[str, Unit] = {
    "m": Unit(Dimension.LENGTH, 1.0),
    "cm": Unit(Dimension.LENGTH, 0.01),
    "mm": Unit(Dimension.LENGTH, 0.001),
    "um": Unit(Dimension.LENGTH, 1e-6),
    "inch": Unit(Dimension.LENGTH, 0.0254),
    "rad": Unit(Dimension.ANGLE, 1.0),
    "mrad": Unit(Dimension.ANGLE, 0.001),
    "deg": Unit(Dimension.ANGLE, _DEGREE),
    "s": Unit(Dimension.TIME, 1.0),
    "ms": Unit(Dimension.TIME, 0.001),
    "us": Unit(Dimension.TIME, 1e-6),
    "min": Unit(Dimension.TIME, 60.0),
    "fraction": Unit(Dimension.RATIO, 1.0),
    "percent": Unit(Dimension.RATIO, 0.01),
    "m/s": Unit(Dimension.SPEED, 1.0),
    "cm/s": Unit(Dimension.SPEED, 0.01),
    "mm/s": Unit(Dimension.SPEED, 0.001),
    "mm/min": Unit(Dimension.SPEED, 0.001 / 60.0),
    "rad/s": Unit(Dimension.ANGULAR_SPEED, 1.0),
    "deg/s": Unit(Dimension.ANGULAR_SPEED, _DEGREE),
    "rpm": Unit(Dimension.ANGULAR_SPEED, 2.0 * math.pi / 60.0),
    "m/s^2": Unit(Dimension.ACCELERATION, 1.0),
    "mm/s^2": Unit(Dimension.ACCELERATION, 0.001),
    "rad/s^2": Unit(Dimension.ANGULAR_ACCELERATION, 1.0),
    "deg/s^2": Unit(Dimension.ANGULAR_ACCELERATION, _DEGREE),
    "m/s^3": Unit(Dimension.JERK, 1.0),
    "mm/s^3": Unit(Dimension.JERK, 0.001),
    "rad/s^3": Unit(Dimension.ANGULAR_JERK, 1.0),
    "deg/s^3": Unit(Dimension.ANGULAR_JERK, _DEGREE),
    "N": Unit(Dimension.FORCE, 1.0),
    "kN": Unit(Dimension.FORCE, 1000.0),
    "Nm": Unit(Dimension.TORQUE, 1.0),
    "Nmm": Unit(Dimension.TORQUE, 0.001),
    "kg": Unit(Dimension.MASS, 1.0),
    "g": Unit(Dimension.MASS, 0.001),
    "K": Unit(Dimension.TEMPERATURE, 1.0),
    "degC": Unit(Dimension.TEMPERATURE, 1.0, 273.15),
    "degF": Unit(Dimension.TEMPERATURE, 5.0 / 9.0, 273.15 - 32.0 * 5.0 / 9.0),
    "V": Unit(Dimension.VOLTAGE, 1.0),
    "mV": Unit(Dimension.VOLTAGE, 0.001),
    "A": Unit(Dimension.CURRENT, 1.0),
    "mA": Unit(Dimension.CURRENT, 0.001),
    "Pa": Unit(Dimension.PRESSURE, 1.0),
    "kPa": Unit(Dimension.PRESSURE, 1000.0),
    "mbar": Unit(Dimension.PRESSURE, 100.0),
    "bar": Unit(Dimension.PRESSURE, 1e5),
    "psi": Unit(Dimension.PRESSURE, 6894.757293168361),
    "Hz": Unit(Dimension.FREQUENCY, 1.0),
    "kHz": Unit(Dimension.FREQUENCY, 1000.0),
}


def dimension_of(unit: str) -> Dimension:
    """The dimension a unit measures. Raises KeyError for an unknown unit."""
    return UNITS[unit].dimension


def convert(value: float, unit: str, to: str) -> float:
    """``value`` given in ``unit``, expressed in ``to``.

    Raises ValueError when the two units measure different things. A conversion between equal units
    returns the value untouched, so that nothing is rounded without need.
    """
    one, other = _both(unit, to)
    if unit == to:
        return value
    if one.zero == other.zero:
        return value * one.factor / other.factor
    return (value * one.factor + one.zero - other.zero) / other.factor


def convert_difference(difference: float, unit: str, to: str) -> float:
    """A difference of two values given in ``unit``, expressed in ``to``: where scales begin is all one.

    Raises ValueError when the two units measure different things.
    """
    one, other = _both(unit, to)
    return difference if unit == to else difference * one.factor / other.factor


def _both(unit: str, to: str) -> tuple[Unit, Unit]:
    one, other = UNITS[unit], UNITS[to]
    if one.dimension is not other.dimension:
        raise ValueError(f"cannot convert {unit} ({one.dimension}) to {to} ({other.dimension})")
    return one, other
