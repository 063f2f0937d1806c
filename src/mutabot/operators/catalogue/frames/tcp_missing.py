"""tcp-missing: the offset of the tool is forgotten."""

from __future__ import annotations

from typing import ClassVar

from mutabot.operators._evidence import FRAMES
from mutabot.operators.operator import Example, Subject

from ._tcp import MOVE, WrongTcp, Z


class TcpMissing(WrongTcp):
    """Moves a target along the tool's offset."""

    name = "tcp-missing"
    summary = "The offset of the tool centre point is missing: the flange goes where the tool's tip should."
    rank = 314
    stands_for = f"A tool that is not set up, or set up in two places: {FRAMES}."
    where = "target positions whose vocabulary says how far the tool reaches: tcp"
    sign = 1.0
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(MOVE, quantity=Z),
            {"z": 0.3},
            performed=({"z": 0.18},),
            note="12 cm of gripper that looks down",
        ),
        Example(Subject(MOVE, quantity=Z), {"z": 0.05}, away="it would be below the range [0, 0.6]"),
    )
