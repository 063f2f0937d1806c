"""Operations for the worked examples of this family."""

from __future__ import annotations

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.model.named import Form, Named, settings_of

X = Quantity("x", Path.parse("message.x", rooted=True), Kind.TRANSLATION, "x", "m", mode=Mode.TO)
#: the same, as it is read
GAP = Quantity("gap", Path.parse(".gap", rooted=False), Kind.DISTANCE, unit="m")


def operation(
    form: Form, name: str, arguments: tuple[Quantity, ...] = (), result: tuple[Quantity, ...] = ()
) -> Operation:
    """An operation of a form, with what it writes and reads."""
    named = Named(form, name)
    return Operation(named.target, arguments, result, command=bool(arguments), named=named, kind="messages")


def setting_up(form: Form, name: str) -> Operation:
    """An operation that sets something up."""
    return operation(form, name, settings_of(form))


PUBLISH = operation(Form.PUBLISH, "/arm/target", (X,))
RECEIVE = operation(Form.RECEIVE, "/gap", result=(GAP,))
CALL = operation(Form.CALL, "/gripper/close")
GOAL = operation(Form.GOAL, "/arm/follow")
TICK = operation(Form.TICK, "/mission/check")
