"""joint-order: the first and the third joint are exchanged."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.operators._evidence import FRAMES
from mutabot.operators.catalogue._pairs import Exchange, is_alike
from mutabot.operators.operator import Example, Subject

_JOINTS = tuple(
    Quantity(f"joints[{index}]", Path("joints"), Kind.ROTATION, f"j{index + 1}", "deg", mode=Mode.TO)
    for index in range(3)
)
_MOVE = Operation("robot:Arm.move_joints", _JOINTS)
_READ = tuple(Quantity(f"[{index}]", Path(), Kind.ANGLE, f"j{index + 1}", "deg") for index in range(3))
_LOOK = Operation("robot:Arm.joints", result=_READ, command=False)


class JointOrder(Exchange):
    """Exchanges the angles of the first and of the third joint."""

    name = "joint-order"
    summary = "The angles of the first and the third joint are exchanged, as where joints are sorted by name."
    rank = 311
    stands_for = f"Joints in another order, as in joint states that are sorted by name: {FRAMES}."
    where = "written and read angles of the joints j1 and j3"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MOVE, quantity=_JOINTS[0], variant="joints[2]"),
            {"joints[0]": 10, "joints[1]": 20, "joints[2]": 30},
            performed=({"joints[0]": 30, "joints[1]": 20, "joints[2]": 10},),
        ),
        Example(
            Subject(_LOOK, quantity=_READ[0], variant="[2]"),
            replied={"[0]": 10.0, "[1]": 20.0, "[2]": 30.0},
            performed=({},),
            received={"[0]": 30.0, "[1]": 20.0, "[2]": 10.0},
        ),
        Example(
            Subject(_MOVE, quantity=_JOINTS[0], variant="joints[2]"),
            {"joints[0]": 0, "joints[1]": 20, "joints[2]": 0},
            away="both are the same",
        ),
    )

    def pairs(self, whole: Subject) -> Iterator[tuple[Quantity, Quantity]]:
        for side in (whole.written, whole.read):
            for one in side:
                is_first = one.axis == "j1" and one.kind in (Kind.ROTATION, Kind.ANGLE)
                yield from (
                    (one, other) for other in side if is_first and other.axis == "j3" and is_alike(one, other)
                )
