"""Operations for the worked examples of this family."""

from __future__ import annotations

from dataclasses import replace

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.model.operation import Form, Named, settings_of

X = Quantity("x", Path.parse("message.x", rooted=True), Kind.TRANSLATION, "x", "m", mode=Mode.TO)
#: the same, as it is read
GAP = Quantity("gap", Path.parse(".gap", rooted=False), Kind.DISTANCE, unit="m")


def operation(
    form: Form, name: str, arguments: tuple[Quantity, ...] = (), result: tuple[Quantity, ...] = ()
) -> Operation:
    """An operation of a form, with what it writes and reads."""
    named = Named(form, name)
    command = form in (Form.PUBLISH, Form.CALL, Form.GOAL)
    return Operation(named.target, arguments, result, command=command, named=named, kind="messages")


def setting_up(form: Form, name: str) -> Operation:
    """An operation that sets something up."""
    return operation(form, name, settings_of(form))


PUBLISH = operation(Form.PUBLISH, "/arm/target", (X,))
RECEIVE = operation(Form.RECEIVE, "/gap", result=(GAP,))
CALL = operation(Form.CALL, "/gripper/close")
CALL_TO = operation(Form.CALL, "/arm/move_to", (replace(X, path=Path.parse("request.x", rooted=True)),))
GOAL = operation(Form.GOAL, "/arm/follow")
TICK = operation(Form.TICK, "/mission/check")
RESULT = operation(Form.RESULT, "/arm/follow")
SPEED = operation(
    Form.PARAMETER, "speed", settings_of(Form.PARAMETER), (Quantity("value", Path(), Kind.SETTING),)
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
SEND_STAMP = operation(Form.PUBLISH, "/arm/target", (STAMP,))
HEAR_STAMP = operation(Form.RECEIVE, "/scan", result=(HEARD_STAMP,))
