"""swapped-channels: two channels of a sensor are exchanged."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.operators._evidence import SENSORS
from mutabot.operators.catalogue._pairs import Exchange, is_alike
from mutabot.operators.operator import Example, Subject

_X, _Y = (
    Quantity(f".{name}", Path.parse(f".{name}", rooted=False), Kind.POSITION, name, "m", "world")
    for name in "xy"
)
_LOCATE = Operation("camera:locate", result=(_X, _Y), command=False)


class SwappedChannels(Exchange):
    """Exchanges two neighbouring values of one kind that a call reads."""

    name = "swapped-channels"
    summary = "Two channels of a sensor are exchanged: neighbouring values of one kind that a call reads."
    rank = 345
    stands_for = f"A sensor that drops out or is misread: {SENSORS}."
    where = "calls that read two quantities of one kind and unit"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_LOCATE, quantity=_X, variant="y"),
            replied={".x": 0.4, ".y": 0.1},
            performed=({},),
            received={".x": 0.1, ".y": 0.4},
        ),
        Example(
            Subject(_LOCATE, quantity=_X, variant="y"), replied={".x": 0.4}, away="it reads no y this time"
        ),
    )

    def pairs(self, whole: Subject) -> Iterator[tuple[Quantity, Quantity]]:
        groups: list[list[Quantity]] = []
        for quantity in whole.read:
            group = next((one for one in groups if is_alike(one[0], quantity)), None)
            groups.append([quantity]) if group is None else group.append(quantity)
        for group in groups:
            yield from pairwise(group)
