"""Demands: faults of at least a given magnitude must be noticed in every round."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import TYPE_CHECKING

from mutabot.errors import shortened
from mutabot.frozen import frozen
from mutabot.model.mutant_pattern import fits, is_like
from mutabot.model.quantity import Kind
from mutabot.model.units import UNITS, convert_difference, dimension_of

if TYPE_CHECKING:
    from mutabot.model.mutant import Mutant

#: the operator that is meant if a demand names none: a value is off by the magnitude
OFFSET = "offset"
#: digits that a magnitude keeps when its unit is converted: 5 mm are 0.005 m, and not 0.005000000000000001
_DIGITS = 12
_AMOUNT = re.compile(r"([-+]?(?:\d{1,18}\.?\d{0,18}|\.\d{1,18})(?:[eE][-+]?\d{1,3})?)\s*([^\d\s.].*)?")


@frozen
class Demand:
    """A user's demand that faults of at least a given magnitude are noticed in every round.

    Attributes:
        notice: the magnitude, in ``unit``.
        unit: a key of ``units.UNITS``; None for quantities without one.
        site: which sites, as ``--only`` takes them; a callee as written will do. None for all.
        quantity: the name of the quantity; None for any.
        kind: its kind; None for any.
        operator: the graded operator.
        source: ``file:line`` where it stands.
    """

    notice: float
    unit: str | None = None
    site: str | None = None
    quantity: str | None = None
    kind: Kind | None = None
    operator: str = OFFSET
    source: str = ""

    def is_about(self, mutant: Mutant, kind: Kind | None) -> bool:
        """Return whether it concerns a graded mutant, whose quantity is of this kind, if known."""
        return (
            mutant.operator == self.operator
            and (self.quantity is None or is_like(self.quantity, mutant.quantity or ""))
            and (self.kind is None or self.kind is kind)
            and self.is_at(mutant)
            and self.magnitude_in(mutant.unit) is not None
        )

    def magnitude_in(self, unit: str | None) -> float | None:
        """Return the demanded magnitude in another unit; None if that measures something else."""
        if unit is None or self.unit is None:
            return self.notice if unit == self.unit else None
        if unit == self.unit:
            return self.notice
        if not {unit, self.unit} <= UNITS.keys() or dimension_of(unit) is not dimension_of(self.unit):
            return None
        return _rounded(convert_difference(self.notice, self.unit, unit))

    @property
    def text(self) -> str:
        """The demand as text: ``notice = "5 mm" at mission.py:38, quantity y``."""
        about = [f"quantity {self.quantity}" if self.quantity is not None else ""]
        about += [f"kind {self.kind}" if self.kind is not None else ""]
        about += [f"operator {self.operator}" if self.operator != OFFSET else ""]
        where = f" at {self.site}" if self.site is not None else ""
        rest = ", ".join(part for part in about if part)
        return f'notice = "{self.amount}"{where}{f", {rest}" if rest else ""}'

    @property
    def amount(self) -> str:
        """The demanded magnitude as text: ``5 mm``."""
        return f"{self.notice:g}{f' {self.unit}' if self.unit is not None else ''}"

    def is_at(self, mutant: Mutant) -> bool:
        """Return whether it concerns the site of a mutant."""
        site = self.site
        if site is None:
            return True
        texts = (mutant.site.id, mutant.site.text, mutant.site.span.function)
        return fits(site, mutant) or any(is_like(site, text) for text in texts)


def wanted_magnitudes(demands: Iterable[Demand], mutant: Mutant, kind: Kind | None) -> tuple[float, ...]:
    """Return the magnitudes that a ladder must have for its demands, rising, in the ladder's unit.

    ``mutant`` is any of the ladder's: only its site, quantity, operator, unit and id are looked at. ``kind``
    is that of its quantity.
    """
    found = (demand.magnitude_in(mutant.unit) for demand in demands if demand.is_about(mutant, kind))
    return tuple(sorted({magnitude for magnitude in found if magnitude is not None}))


def is_at_least(magnitude: float, demanded: float) -> bool:
    """Return whether a magnitude of a ladder is at least the demanded one, up to rounding of units."""
    return magnitude > demanded or is_same(magnitude, demanded)


def is_same(first: float, second: float) -> bool:
    """Return whether two magnitudes are equal, up to rounding of units."""
    return math.isclose(first, second, rel_tol=1e-9)


def parse_amount(text: str) -> tuple[float, str | None]:
    """Return the number and the unit in ``5 mm``, ``2.5 deg``, ``5 %`` or ``3``.

    Raises ValueError with a sentence about what is wrong; KeyError for a unit that does not exist.
    """
    found = _AMOUNT.fullmatch(text.strip())
    if found is None:
        raise ValueError(f"{shortened(text)!r} is not a magnitude; write a number and a unit, like '5 mm'")
    value, unit = float(found[1]), "percent" if found[2] == "%" else found[2]
    if not (value > 0 and math.isfinite(value)):
        raise ValueError(f"{text!r}: a magnitude is more than 0; both directions are meant")
    if unit is not None and unit not in UNITS:
        raise KeyError(unit)
    return value, unit


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
