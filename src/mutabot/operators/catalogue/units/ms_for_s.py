"""ms-for-s: seconds are taken for milliseconds"""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.operators._evidence import UNITS
from mutabot.operators.operator import Example, Subject

from ._factor import TAKEN, OtherUnit

_SECONDS = Quantity("seconds", Path("seconds"), Kind.DURATION, unit="s")
_WAIT = Operation("cell:wait", (_SECONDS,))


class MillisecondForSecond(OtherUnit):
    """Takes seconds for milliseconds."""

    name = "ms-for-s"
    summary = (
        "A duration in seconds is taken for milliseconds. The other way round it is so long that any"
        " test only times out."
    )
    rank = 304
    stands_for = f"A number in another unit: {UNITS}."
    where = "durations in s"
    units: ClassVar[dict[str, str]] = {"s": "ms"}
    variants = (TAKEN,)
    of_read = False
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_WAIT, quantity=_SECONDS, variant="taken-ms"),
            {"seconds": 0.8},
            performed=({"seconds": 0.0008},),
        ),
        Example(
            Subject(_WAIT, quantity=_SECONDS, variant="taken-ms"), {"seconds": 0.0}, away="no time is no time"
        ),
    )
