"""The published expectations, in m, and the published way to compare."""

from __future__ import annotations

from mutabot_cell import Position

HOME = Position(0.5761017, 0.0021496, 0.4340113)
ON_CONVEYOR = Position(0.55, 0.2, 1.0)
TARGETS = {
    "red": Position(-0.3252520, 0.2205990, 0.7675002),
    "blue": Position(-0.3189651, 0.4354883, 0.7683375),
}


def is_within(expected: float, reading: float, threshold: float) -> bool:
    """Whether the reading fits; rounds to whole centimetres before it compares, so 0.02 lets 0.025 pass."""
    return round(abs(expected - reading), 2) <= threshold
