"""Worked examples of operators in few words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from mutabot.model import Kind, Mode, Operation, Path, Quantity

from .magnitudes import Magnitudes, sized
from .operator import Example, Subject, quantity_of

if TYPE_CHECKING:
    from mutabot.model.quantity import Value

X = Quantity(".x", Path.parse(".x", rooted=False), Kind.POSITION, "x", "m", "world")
LOCATE = Operation("camera:locate", result=(X,), command=False)
GRIP = Operation(
    "robot:Gripper.command",
    (Quantity("position", Path("position"), Kind.OPENING, unit="fraction", values=(0, 1)),),
)
_X, _Y = (Quantity(name, Path(name), Kind.TRANSLATION, name, "m", "base", Mode.TO) for name in "xy")
MOVE_TO = Operation("robot:Arm.move_to", (_X, _Y))
CLOSE = Operation("robot:Gripper.close", opposite="robot:Gripper.open")


def reading(target: str, kind: Kind, **more: Any) -> Operation:
    """An operation that returns one value and commands nothing."""
    return Operation(target, result=(Quantity("result", Path(), kind, **more),), command=False)


def writing(target: str, name: str, kind: Kind, **more: Any) -> Operation:
    """An operation with one argument."""
    return Operation(target, (Quantity(name, Path(name), kind, **more),))


def changed(operation: Operation, before: Any, after: Any, variant: str = "", **more: Any) -> Example:
    """A value that the operator changes: as the program writes or the robot answers it, and as it becomes.

    The first quantity of the operation is meant, or that named ``quantity``; with ``size=("+", 20.0, "mm")``
    the fault has a magnitude. ``before``, ``after`` and each of ``earlier`` may be all values of the call.
    """
    subject = _subject(operation, variant, more)
    values, others = _values(subject, before), _values(subject, after)
    if subject.is_written:
        return Example(subject, values, performed=(others,), **more)
    return Example(subject, replied=values, performed=({},), received=others, **more)


def unchanged(operation: Operation, before: Any, away: str, variant: str = "", **more: Any) -> Example:
    """A value that the operator leaves alone, and why; else as ``changed``."""
    subject = _subject(operation, variant, more)
    more["values" if subject.is_written else "replied"] = _values(subject, before)
    return Example(subject, away=away, **more)


def whole(
    operation: Operation,
    value: Any,
    *after: Any,
    variant: str = "",
    size: tuple[float, str | None] | None = None,
    earlier: tuple[Any, ...] = (),
    then: tuple[Any, ...] = (),
    **more: Any,
) -> Example:
    """A call on which the operator acts as a whole.

    Of a call that writes, ``value`` is what it writes, and ``after`` what each call writes that reaches the
    robot. Of one that reads, they are what the robot answers, and what the program gets, if it gets any.
    Values are those of the first quantity, or a table of several; ``size``: the magnitude and its unit.
    """
    first = next(iter((*operation.arguments, *operation.result)), None)

    def of(one: Any) -> Mapping[str, Value]:
        return one if first is None or isinstance(one, Mapping) else {first.name: one}

    subject = Subject(operation, variant=variant)
    if size is not None:
        subject = next(sized(subject, Magnitudes(size[1], (size[0],))))
    known = {"earlier": tuple(map(of, earlier)), "then": tuple(map(of, then)), **more}
    if operation.arguments or not operation.result:
        return Example(subject, of(value), performed=tuple(map(of, after)), **known)
    received = of(after[0]) if after else None
    return Example(subject, replied=of(value), performed=({},), received=received, **known)


def _subject(operation: Operation, variant: str, more: dict[str, Any]) -> Subject:
    quantities = {one.name: one for one in (*operation.arguments, *operation.result)}
    quantity = quantities[more.pop("quantity", next(iter(quantities)))]
    subject = Subject(operation, quantity=quantity, variant=variant)
    more["earlier"] = tuple(_values(subject, one) for one in more.get("earlier", ()))
    if "size" not in more:
        return subject
    direction, size, unit = more.pop("size")
    return next(sized(subject, Magnitudes(unit, (size,)), direction))


def _values(subject: Subject, given: Any) -> Mapping[str, Value]:
    return given if isinstance(given, Mapping) else {quantity_of(subject).name: given}


MOVE_BY = writing("robot:Arm.move_by", "dx", Kind.TRANSLATION, axis="x", unit="m", frame="base", mode=Mode.BY)
