"""left-handed: a pose is mirrored, as between a right-handed and a left-handed frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Pattern, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import FRAMES
from mutabot.operators.catalogue._shape import Away, ValuesFault, given, is_written, side_of
from mutabot.operators.operator import Example, Subject, is_number, map_numbers
from mutabot.operators.robot._values import label, quantity_of

_PLACES = (Kind.TRANSLATION, Kind.POSITION)
_ANGLES = (Kind.ROTATION, Kind.ORIENTATION)
_Y = Quantity("y", Path("y"), Kind.TRANSLATION, "y", "m", "base", Mode.TO)
_YAW = Quantity("yaw", Path("yaw"), Kind.ROTATION, "z", "deg", "base", Mode.TO)
_TURNED = Quantity("turned", Path("turned"), Kind.QUATERNION, order="wxyz")
_MOVE = Operation("robot:Arm.move_to", (_Y, _YAW))
_PUT = Operation("robot:Arm.put", (_Y, _TURNED))


class LeftHanded(ValuesFault):
    """Mirrors a pose at the x-z plane: y and the turns about x and z are negated."""

    name = "left-handed"
    summary = "A pose is taken as given in a left-handed frame: y and the turns about x and z are negated."
    rank = 312
    stands_for = f"Frames of the other handedness, as of game engines: {FRAMES}."
    where = "written and read poses with y and an orientation beside it; for y alone it is a wrong sign"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_MOVE, quantity=_Y), {"y": 0.2, "yaw": 30.0}, performed=({"y": -0.2, "yaw": -30.0},)),
        Example(
            Subject(_PUT, quantity=_Y),
            {"y": 0.2, "turned": [0.8, 0.0, 0.0, 0.6]},
            performed=({"y": -0.2, "turned": [0.8, 0.0, 0.0, -0.6]},),
        ),
        Example(Subject(_MOVE, quantity=_Y), {"y": 0.0, "yaw": 0.0}, away="a mirror changes nothing here"),
    )

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterator[Subject]:
        whole = Subject(operation, pattern)
        for side in (whole.written, whole.read):
            for quantity in side:
                if quantity.kind in _PLACES and quantity.axis == "y" and any(map(_turns, side)):
                    yield replace(whole, quantity=quantity)

    def changed(self, subject: Subject, values: Mapping[str, Value], memory: Any) -> Mapping[str, Value]:
        quantity = quantity_of(subject)
        found = {quantity.name: map_numbers(given(values, quantity.name), _negative)}
        for one in side_of(subject):
            if _turns(one) and one.name in values:
                found[one.name] = _mirrored(one, values[one.name])
        return found

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        verb = "" if is_written(subject) else "reads "
        name = label(quantity_of(subject))
        return f"{verb}the pose mirrored: {name} and the turns about x and z negated"


def _turns(quantity: Quantity) -> bool:
    """Whether it is an orientation, or a part of one, that a mirror changes."""
    return quantity.is_whole or (quantity.kind in _ANGLES and quantity.axis in ("x", "z"))


def _negative(number: float) -> float:
    return -number if number else number


def _mirrored(quantity: Quantity, value: Value) -> Value | None:
    if not quantity.is_whole:
        return map_numbers(value, _negative)
    orientation = quantity.orientation(value)
    if orientation is None or not all(is_number(part) for part in value):
        raise Away("its value is no orientation")
    w, x, y, z = orientation
    parts = iter(quantity.numbers((w, -x, y, -z)))
    return map_numbers(value, lambda _: next(parts) + 0.0)  # no −0
