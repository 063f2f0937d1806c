"""axis-swap: two components of a motion are exchanged."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.operators._evidence import FRAMES
from mutabot.operators.catalogue._pairs import Exchange, is_alike
from mutabot.operators.operator import Example, Subject

_AXES = frozenset("xyz")
_X, _Y = (Quantity(name, Path(name), Kind.TRANSLATION, name, "m", "base", Mode.TO) for name in "xy")
_MOVE = Operation("robot:Arm.move_to", (_X, _Y))


class AxisSwap(Exchange):
    """Exchanges two components of a translation or rotation."""

    name = "axis-swap"
    summary = "Two components of a motion are exchanged: what is meant along x goes along y."
    rank = 310
    stands_for = f"A wrong axis: {FRAMES}."
    where = "commands that write two of the axes x, y, z of one translation or rotation"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MOVE, quantity=_X, variant="y"), {"x": 0.4, "y": 0.1}, performed=({"x": 0.1, "y": 0.4},)
        ),
        Example(Subject(_MOVE, quantity=_X, variant="y"), {"x": 0.2, "y": 0.2}, away="both are the same"),
        Example(Subject(_MOVE, quantity=_X, variant="y"), {"x": 0.2}, away="the call gives no y"),
    )

    def pairs(self, whole: Subject) -> Iterator[tuple[Quantity, Quantity]]:
        for one, other in combinations(whole.written, 2):
            is_motion = one.kind in (Kind.TRANSLATION, Kind.ROTATION) and {one.axis, other.axis} <= _AXES
            if is_motion and one.axis != other.axis and is_alike(one, other):
                yield one, other
