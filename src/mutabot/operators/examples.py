"""Operations that the worked examples of several operators share."""

from __future__ import annotations

from mutabot.model import Kind, Mode, Operation, Path, Quantity

X = Quantity(".x", Path.parse(".x", rooted=False), Kind.POSITION, "x", "m", "world")
LOCATE = Operation("camera:locate", result=(X,), command=False)
GRIP = Operation.writing("robot:Gripper.command", "position", Kind.OPENING, unit="fraction", values=(0, 1))
_X, _Y = (Quantity(name, Path(name), Kind.TRANSLATION, name, "m", "base", Mode.TO) for name in "xy")
MOVE_TO = Operation("robot:Arm.move_to", (_X, _Y))
MOVE_BY = Operation.writing(
    "robot:Arm.move_by", "dx", Kind.TRANSLATION, axis="x", unit="m", frame="base", mode=Mode.BY
)
CLOSE = Operation("robot:Gripper.close", opposite="robot:Gripper.open")
