"""Operations that several operators' worked examples share."""

from __future__ import annotations

from dataclasses import replace

from mutabot.api.values import Form, Kind, Mode, Operation, Path, Quantity

X = Quantity("x", Path.parse("message.x", rooted=True), Kind.TRANSLATION, "x", "m", mode=Mode.TO)
#: the same, as it is read
GAP = Quantity("gap", Path.parse(".gap", rooted=False), Kind.DISTANCE, unit="m")
GRIP = Operation.writing("robot:Gripper.command", "position", Kind.OPENING, unit="fraction", values=(0, 1))
CLOSE = Operation("robot:Gripper.close", opposite="robot:Gripper.open")
MOVE_BY = Operation.writing("robot:Arm.move_by", "dx", Kind.TRANSLATION, axis="x", unit="m", mode=Mode.BY)
MOVE_TO = Operation(
    "robot:Arm.move_to",
    tuple(Quantity(axis, Path(axis), Kind.TRANSLATION, axis, "m", "base", Mode.TO) for axis in "xy"),
)


def setting_up(form: Form, name: str) -> Operation:
    """Return an operation that sets something up."""
    return Operation.under_name(form, name, form.settings)


PUBLISH = Operation.under_name(Form.PUBLISH, "/arm/target", (X,))
RECEIVE = Operation.under_name(Form.RECEIVE, "/gap", result=(GAP,))
CALL = Operation.under_name(Form.CALL, "/gripper/close")
CALL_TO = Operation.under_name(
    Form.CALL, "/arm/move_to", (replace(X, path=Path.parse("request.x", rooted=True)),)
)
GOAL = Operation.under_name(Form.GOAL, "/arm/follow")
TICK = Operation.under_name(Form.TICK, "/mission/check")
RESULT = Operation.under_name(Form.RESULT, "/arm/follow")
SPEED = Operation.under_name(
    Form.PARAMETER, "speed", Form.PARAMETER.settings, (Quantity("value", Path(), Kind.SETTING),)
)
ADVERTISE = setting_up(Form.ADVERTISE, "/arm/target")
SUBSCRIBE = setting_up(Form.SUBSCRIBE, "/gap")
CLIENT = setting_up(Form.CLIENT, "/arm/follow")
TIMER = setting_up(Form.TIMER, "/mission/check")
RATE = setting_up(Form.RATE, "/mission")

FRAME = Quantity(
    "header.frame_id",
    Path.parse("message.header.frame_id", rooted=True),
    Kind.FRAME_ID,
    values=("base", "tool"),
)
OPEN_FRAME = Quantity("header.frame_id", FRAME.path, Kind.FRAME_ID)
HEARD_FRAME = Quantity("header.frame_id", Path.parse(".header.frame_id", rooted=False), Kind.FRAME_ID)
STAMP = Quantity("header.stamp", Path.parse("message.header.stamp", rooted=True), Kind.STAMP, unit="s")
HEARD_STAMP = Quantity("header.stamp", Path.parse(".header.stamp", rooted=False), Kind.STAMP, unit="s")
SEND_STAMP = Operation.under_name(Form.PUBLISH, "/arm/target", (STAMP,))
HEAR_STAMP = Operation.under_name(Form.RECEIVE, "/scan", result=(HEARD_STAMP,))
