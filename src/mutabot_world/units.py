"""Magnitudes of disturbances: their units, and their conversion to SI units."""

from __future__ import annotations

from mutabot.api.values import Kind, Path, Quantity

#: of one of these each unit is a multiple
_SI = ("m", "rad", "s", "fraction", "m/s", "rad/s", "N", "Nm", "kg", "K", "Pa", "Hz", "V", "A")


def in_si(size: float, unit: str | None) -> float:
    """Convert a magnitude to SI units (m, rad, s, kg, N and so on); percent to a fraction.

    Raises ValueError for a unit that does not exist.
    """
    if unit is None:
        return size
    for own in _SI:
        try:
            found = Quantity("", Path(), Kind.POSITION, unit=own).from_unit(size, unit)
            return float(f"{found:.12g}")  # 5 mm are 0.005 m, and not 0.005000000000000001
        except ValueError:  # it measures something else
            continue
        except KeyError:
            break
    raise ValueError(f"{unit!r} is not a unit of disturbances; such as mm, deg, ms, kg, N, percent")


def with_unit(size: float, unit: str | None) -> str:
    """Return a magnitude with its unit as text: ``0.4 kg``, ``5 %``, ``3``."""
    return f"{size:g} {'%' if unit == 'percent' else unit}" if unit else f"{size:g}"
