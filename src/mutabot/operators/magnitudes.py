"""The magnitudes of graded faults: a mutant for each magnitude of a ladder.

Where a vocabulary names none, these are the 1-2-5 series over a range with a reason. Lengths begin at 1 mm,
ten times the pose repeatability that makers of small arms state by ISO 9283 (0.02 to 0.1 mm): below, the
arm itself would hide the fault. They end at 100 mm, beyond the parts that such an arm takes. Angles span
what that is at 0.3 m from a joint. Times begin at 10 ms, a usual cycle of a controller, and end at 1 s, a
usual step of a task. The others are 1 % to 50 % of what data sheets of grippers, small arms and their
sensors give as the full scale (235 N and 0.15 m/s for a two-finger gripper, 2 kg payload, 24 V, 6 bar).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from mutabot.frozen import frozen
from mutabot.model import Kind, Quantity
from mutabot.model.units import Dimension, dimension_of

if TYPE_CHECKING:
    from .operator import Subject


@frozen
class Magnitudes:
    """The magnitudes of a fault, rising.

    Attributes:
        unit: their unit; None for those of what has none.
        steps: the magnitudes.
    """

    unit: str | None
    steps: tuple[float, ...]

    def of(self, subject: Subject, direction: str = "") -> Iterator[Subject]:
        """Return the subject, once for each magnitude in one direction."""
        return (subject.of_size(size, self.unit, direction) for size in self.steps)


def series(first: float, count: int) -> tuple[float, ...]:
    """Return ``count`` numbers of the 1-2-5 series, beginning with ``first``."""
    decade = 10.0 ** math.floor(math.log10(first) + 1e-9)
    at = (1, 2, 5).index(round(first / decade))
    numbers = ((1, 2, 5)[n % 3] * 10 ** (n // 3) * decade for n in range(at, at + count))
    return tuple(float(f"{number:.6g}") for number in numbers)


#: seven magnitudes over two decades, by what is measured
LADDERS: dict[Dimension, Magnitudes] = {
    Dimension.LENGTH: Magnitudes("mm", series(1, 7)),
    Dimension.ANGLE: Magnitudes("deg", series(0.2, 7)),
    Dimension.TIME: Magnitudes("ms", series(10, 7)),
    Dimension.RATIO: Magnitudes("percent", series(1, 6)),
    Dimension.SPEED: Magnitudes("mm/s", series(5, 7)),
    Dimension.ANGULAR_SPEED: Magnitudes("deg/s", series(1, 7)),
    Dimension.ACCELERATION: Magnitudes("mm/s^2", series(50, 7)),
    Dimension.ANGULAR_ACCELERATION: Magnitudes("deg/s^2", series(5, 7)),
    Dimension.JERK: Magnitudes("mm/s^3", series(500, 7)),
    Dimension.ANGULAR_JERK: Magnitudes("deg/s^3", series(50, 7)),
    Dimension.FORCE: Magnitudes("N", series(1, 7)),
    Dimension.TORQUE: Magnitudes("Nm", series(0.1, 7)),
    Dimension.MASS: Magnitudes("g", series(10, 7)),
    Dimension.TEMPERATURE: Magnitudes("K", series(0.5, 7)),
    Dimension.VOLTAGE: Magnitudes("mV", series(100, 7)),
    Dimension.CURRENT: Magnitudes("mA", series(10, 7)),
    Dimension.PRESSURE: Magnitudes("mbar", series(10, 7)),
    Dimension.FREQUENCY: Magnitudes("Hz", series(0.1, 7)),
}
_COUNTED = Magnitudes(None, series(1, 7))
#: drift per second: over a task of ten seconds it reaches the ladder of the offset
_PER_SECOND = 0.1


def own_ladder(quantity: Quantity) -> Magnitudes | None:
    """Return the magnitudes of faults in the quantity's own measure; None if none are defined for it."""
    # orientations as a whole are angles; plain numbers have no measure
    unit = "rad" if quantity.is_whole else quantity.unit
    measure = dimension_of(unit) if unit is not None else None
    ladder = _from_vocabulary(quantity)
    if ladder is not None and (ladder.unit is None or dimension_of(ladder.unit) is measure):
        return ladder
    if quantity.kind is Kind.COUNT:
        return _COUNTED
    return LADDERS.get(measure) if measure is not None else None


def ladder_in(quantity: Quantity | None, measure: Dimension) -> Magnitudes:
    """Return the magnitudes of faults measured in time, or as a share of the value."""
    ladder = _from_vocabulary(quantity) if quantity is not None else None
    if ladder is not None and ladder.unit is not None and dimension_of(ladder.unit) is measure:
        return ladder
    return LADDERS[measure]


def per_second(quantity: Quantity) -> Magnitudes | None:
    """Return the magnitudes of faults that grow with time, per second."""
    own = own_ladder(quantity)
    if own is None:
        return None
    return Magnitudes(f"{own.unit or ''}/s", tuple(float(f"{step * _PER_SECOND:.6g}") for step in own.steps))


def _from_vocabulary(quantity: Quantity) -> Magnitudes | None:
    """Return the ladder in the vocabulary; None if it has none."""
    if quantity.ladder is None:
        return None
    return Magnitudes(quantity.ladder_unit or quantity.unit, quantity.ladder)
