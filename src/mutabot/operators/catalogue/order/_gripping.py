"""What gripper commands are, in the words of vocabularies."""

from __future__ import annotations

from mutabot.model import Call, Kind, Operation, Path, Quantity
from mutabot.operators.catalogue._shape import Away, given
from mutabot.operators.operator import Subject
from mutabot.operators.robot.opposite import other_end

POSITION = Quantity("position", Path("position"), Kind.OPENING, unit="fraction", values=(0, 1))
GRIP = Operation("robot:Gripper.command", (POSITION,))
CLOSE = Operation("robot:Gripper.close", opposite="robot:Gripper.open")
WHERE = (
    "commands with an opening, and commands without quantities that have an opposite, such as close and open"
)


def is_gripping(whole: Subject) -> bool:
    """Whether it is a command to a gripper."""
    has_opening = any(one.kind is Kind.OPENING for one in whole.written)
    return has_opening or (whole.opposite is not None and not whole.written)


def undone(subject: Subject, call: Call) -> Call:
    """The call that takes a gripper command back. Raises Away if its opening has no other end."""
    for quantity in subject.written:
        if quantity.kind is Kind.OPENING:
            value = other_end(quantity, given(call.values, quantity.name))
            if value is None:
                raise Away("the value is neither of the two ends")
            return call.with_value(quantity, value)
    return call.opposite()
