"""What the parts of messages mean, by the types that hold them: units and axes are those of REP 103.

Types that no convention is known of are left to the names of their fields (``by_name``).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mutabot.model.operation import Form
from mutabot.proposal.guess import Guess, Setting, Table, guess_argument, guess_elements, guess_reading
from mutabot.proposal.named.seen import Part, Use

Meant = dict[str, Guess]

_HEADER = "std_msgs/Header"
_POINTS = frozenset({"geometry_msgs/Point", "geometry_msgs/Point32"})
_TRANSLATION = ("geometry_msgs/Transform", "translation")
#: holders of speeds
_SPEEDS = "geometry_msgs/Twist"
#: types whose fields are as conventions say, or unknown; their names alone tell nothing
_STANDARD = re.compile(r"(?:geometry|sensor|nav|diagnostic|actionlib|action|visualization|shape)_msgs/.*")
_JOINTS = {
    ("sensor_msgs/JointState", "position"),
    ("trajectory_msgs/JointTrajectoryPoint", "positions"),
}
_MOST_JOINTS = 12
#: how far fingers open that nobody says more of, in m
_STROKE = 0.1
_BYTES = ("uint8[", "char[", "byte[", "octet[", "sequence<uint8", "sequence<octet")
_BY = frozenset({"by", "relative", "rel", "offset", "shift", "jog", "delta", "step", "increment"})
_GETTERS = frozenset({"get", "read", "query", "is", "has", "where", "locate", "detect", "measure", "lookup"})


@dataclass(frozen=True)
class Place:
    """Where parts pass.

    Attributes:
        form: what is done.
        words: the words of its name, in lower case.
        is_written: whether the program sends them.
        frame: the frame that all messages speak of; empty if there are several or none.
    """

    form: Form
    words: tuple[str, ...]
    is_written: bool
    frame: str = ""

    @classmethod
    def of(cls, use: Use, parts: Sequence[Part], *, is_written: bool) -> Place:
        """The place of what passes in a use."""
        name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", use.name)
        words = tuple(word.lower() for word in re.findall(r"[A-Za-z]+\d*|\d+", name))
        frames = {value for part in parts if _is_header(part, "frame_id") for value in part.values}
        frame = next(iter(frames)) if len(frames) == 1 else ""
        return cls(use.form, words, is_written, frame)

    @property
    def is_by(self) -> bool:
        """Whether its name says that what is sent is relative."""
        return bool(_BY & set(self.words))

    @property
    def tells_nothing(self) -> bool:
        """Whether it is the answer to a command, which says how that went."""
        return self.form is Form.CALL and not self.is_written and not _GETTERS & set(self.words)


def meaning(part: Part, place: Place) -> Meant:
    """What a part means, by path; an empty guess for a path of which nothing tells, nothing for the whole."""
    if place.tells_nothing:
        return {}
    for rule in _RULES:
        found = rule(part, place)
        if found is not None:
            return found
    if part.within and _STANDARD.fullmatch(part.within[-1][0]):
        return {}
    return by_name(part, place.words, is_written=place.is_written)


def is_nothing(part: Part, place: Place) -> bool:
    """Whether a part is not worth asking about: what the middleware itself writes, and words for people."""
    if part.within and part.within[-1][0] in (_HEADER, "std_msgs/MultiArrayLayout"):
        return True
    if any(isinstance(value, str) for value in part.values):
        return not place.is_written and bool(part.within) and part.within[-1] != ("std_msgs/String", "data")
    if part.type in ("time", "duration", "builtin_interfaces/Time", "builtin_interfaces/Duration"):
        return True
    return part.type.startswith(_BYTES) or (not part.values and not part.length)


def _header(part: Part, place: Place) -> Meant | None:
    if not part.within or part.within[-1][0] != _HEADER:
        return None
    name = part.within[-1][1]
    is_set = name in ("frame_id", "stamp") and any(part.values)
    return {part.path: Guess({"kind": name})} if is_set else {}


def _is_header(part: Part, name: str) -> bool:
    return bool(part.within) and part.within[-1] == (_HEADER, name)


def _quaternion(part: Part, place: Place) -> Meant | None:
    return {part.path: Guess({"kind": "quaternion"})} if part.type == "geometry_msgs/Quaternion" else None


def _coordinate(part: Part, place: Place) -> Meant | None:
    """A coordinate of a point, of a transform's translation, or of a plane's pose."""
    holder, name = part.within[-1] if part.within else ("", "")
    if holder == "geometry_msgs/Pose2D":
        return {part.path: _placed("rotation" if name == "theta" else "translation", name, place)}
    is_translation = holder == "geometry_msgs/Vector3" and part.within[-2:-1] == (_TRANSLATION,)
    if holder in _POINTS or is_translation:
        return {part.path: _placed("translation", name, place)}
    return None


def _placed(kind: str, name: str, place: Place) -> Guess:
    """Where something is, or is to be."""
    unit, axis = ("rad", "z") if kind == "rotation" else ("m", name)
    if not place.is_written:
        read = "orientation" if kind == "rotation" else "position"
        return Guess(_framed({"kind": read, "axis": axis, "unit": unit}, place))
    table = _framed({"kind": kind, "axis": axis, "unit": unit}, place)
    return Guess({**table, "mode": "by" if place.is_by else "to"}, [] if place.is_by else ["mode"])


def _speed(part: Part, place: Place) -> Meant | None:
    """A part of a ``Twist``: a speed, unless the name says that a relative move is sent in it."""
    if len(part.within) < 2 or part.within[-2][0] != _SPEEDS:
        return None
    turns, axis = part.within[-2][1] == "angular", part.within[-1][1]
    if place.is_written and place.is_by:
        kind, unit = ("rotation", "rad") if turns else ("translation", "m")
        table = _framed({"kind": kind, "axis": axis, "unit": unit}, place)
        return {part.path: Guess({**table, "mode": "by"})}
    unit = "rad/s" if turns else "m/s"
    return {part.path: Guess(_framed({"kind": "speed", "axis": axis, "unit": unit}, place))}


def _framed(table: Table, place: Place) -> Table:
    return {**table, "frame": place.frame} if place.frame else table


def _joints(part: Part, place: Place) -> Meant | None:
    if not part.within or part.within[-1] not in _JOINTS or not part.length:
        return None
    if part.length > _MOST_JOINTS:
        return {}
    axis = "j1" if part.length == 1 else f"j1..j{part.length}"
    path = f"{part.path}[0]" if part.length == 1 else f"{part.path}[0:{part.length}]"
    if place.is_written:
        return {path: Guess({"kind": "rotation", "axis": axis, "unit": "rad", "mode": "to"}, ["order"])}
    return {path: Guess({"kind": "angle", "axis": axis, "unit": "rad"}, ["order"])}


def _finger(part: Part, place: Place) -> Meant | None:
    if not part.within or part.within[-1] != ("control_msgs/GripperCommand", "position"):
        return None
    if not place.is_written:
        return {part.path: Guess({"kind": "distance", "unit": "m"})}
    numbers = [value for value in part.values if isinstance(value, int | float)]
    table: Table = {"kind": "opening", "unit": "m", "range": [0.0, float(max([_STROKE, *numbers]))]}
    return {part.path: Guess(table, ["range"])}


def _range(part: Part, place: Place) -> Meant | None:
    is_range = bool(part.within) and part.within[-1] == ("sensor_msgs/Range", "range")
    return (
        {part.path: Guess({"kind": "distance", "unit": "m"})} if is_range and not place.is_written else None
    )


_RULES: tuple[Callable[[Part, Place], Meant | None], ...] = (
    _header, _quaternion, _coordinate, _speed, _joints, _finger, _range,
)  # fmt: skip


#: names of fields that say nothing: the name of the topic or service does
_EMPTY = frozenset({"", "data", "value"})
_WAITS = frozenset({"wait", "sleep", "pause", "dwell", "delay", "duration"})
_GRIPPER = re.compile(r"grip|hand$|finger|claw|jaw|vacuum|suction")
_JOINT = re.compile(r"joints?|(?:move|servo)j")
_POSE_LENGTH, _TURN = 6, "[3:6]"
#: values that are settings, and no scale
_LEAST_VALUES, _MOST_VALUES = 2, 5
#: no joint turns further, rad
_FULL_TURN = 6.5


def by_name(part: Part, words: Sequence[str], *, is_written: bool) -> dict[str, Guess]:
    """What a part means, by path; an empty guess for a path of which nothing tells."""
    own = part.within[-1][1] if part.within else ""
    if part.length == 0:
        return {}
    if part.length is not None:
        return _elements(part, own, words, is_written=is_written)
    values = [value for value in part.values if value is not None]
    if not values:
        return {}
    if all(isinstance(value, bool) for value in values):
        guess = _switch(words) if is_written else Guess({"kind": "flag"})
    elif all(isinstance(value, str) for value in values):
        guess = _label(part) if not part.path and not is_written else Guess()
    else:
        guess = _number(part, own, words, is_written=is_written)
    return {part.path: guess} if guess.table else {}


def _switch(words: Sequence[str]) -> Guess:
    is_gripper = any(_GRIPPER.search(word) for word in words)
    return Guess({"kind": "opening" if is_gripper else "output", "values": [False, True]})


def _label(part: Part) -> Guess:
    many = _LEAST_VALUES <= len(part.values) <= _MOST_VALUES
    return Guess({"kind": "label", "values": list(part.values)}, ["values"]) if many else Guess()


def _number(part: Part, own: str, words: Sequence[str], *, is_written: bool) -> Guess:
    is_empty = own in _EMPTY
    if is_empty and is_written and _WAITS & set(words):
        return Guess({"kind": "duration", "unit": "s"})
    name = "_".join(words[-1:]) if is_empty else own
    setting = Setting("_".join(words), "", "", part.values)
    guess = guess_argument(name, setting) if is_written else guess_reading(name, setting)
    if guess.table and guess.table.get("kind") not in ("label", "flag"):
        return _in_radians(guess, part.values)
    if is_empty and _is_whole(part) and _LEAST_VALUES <= len(part.values) <= _MOST_VALUES:
        kind = "output" if is_written else "label"
        return Guess({"kind": kind, "values": list(part.values)}, ["values"])
    return Guess()


def _is_whole(part: Part) -> bool:
    return bool(part.within) and all(isinstance(value, int) for value in part.values)


def _elements(part: Part, own: str, words: Sequence[str], *, is_written: bool) -> dict[str, Guess]:
    assert part.length is not None
    name = "joints" if any(_JOINT.fullmatch(word) for word in words) and not _says_speed(own) else own
    setting = Setting("_".join(words), "", "", part.values)
    found = guess_elements(name, part.length, setting, written=is_written)
    numbers = [number for values in part.values for number in values]
    told = {f"{part.path}{step}": _in_radians(guess, numbers) for step, guess in found.items()}
    if part.length == _POSE_LENGTH and name != "joints" and f"{part.path}{_TURN}" in told:
        told[f"{part.path}{_TURN}"] = Guess()  # Euler angles of some order, or a rotation vector
    return told


def _says_speed(name: str) -> bool:
    return re.search(r"vel|speed|acc|effort|torque", name) is not None


def _in_radians(guess: Guess, values: Sequence[object]) -> Guess:
    """Angles of ROS are radians, if nothing says otherwise and they are no larger than a turn."""
    if "unit" in guess.checks and guess.table.get("unit") == "deg":
        largest = max((abs(value) for value in values if isinstance(value, int | float)), default=0.0)
        if largest <= _FULL_TURN:
            guess.table["unit"] = "rad"
    return guess
