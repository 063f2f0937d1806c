"""tcp-doubled: the offset of the tool is counted twice."""

from __future__ import annotations

from typing import ClassVar

from mutabot.operators._evidence import FRAMES
from mutabot.operators.operator import Example, Subject

from ._tcp import MOVE, WrongTcp, Z


class TcpDoubled(WrongTcp):
    """Moves a target along the tool's offset."""

    name = "tcp-doubled"
    summary = "The offset of the tool centre point is counted twice: the tip stays back by as much."
    rank = 315
    stands_for = f"A tool that is not set up, or set up in two places: {FRAMES}."
    where = "target positions whose vocabulary says how far the tool reaches: tcp"
    sign = -1.0
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(MOVE, quantity=Z),
            {"z": 0.3},
            performed=({"z": 0.42},),
            note="12 cm of gripper that looks down",
        ),
        Example(Subject(MOVE, quantity=Z), {"z": 0.5}, away="it would be above the range [0, 0.6]"),
    )
