"""Proposes entries for names of a middleware, by the types of their messages.

Units and axes are those of REP 103. Where no convention is known of a type, the names of its fields decide.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from mutabot.api.values import Form

from .guess import Guess, NameContext, TomlTable, guess_argument, guess_elements, guess_reading
from .observations import Use, Values, WatchedPart
from .words import GRIPPER, READERS, VERBS, words_of

Meant = dict[str, Guess]

#: how the types of the parts of services and actions of ROS 1 end
_ENDINGS = {
    Form.CALL: ("Request", "Response"),
    Form.GOAL: ("Goal",),
    Form.FEEDBACK: ("Feedback",),
    Form.RESULT: ("Result",),
}
#: what the tests alone read is worth a word if they wait for it: it is what they judge by. What goes wrong in
#: a callback of theirs, the client library may keep to itself
_READINGS = frozenset({Form.RECEIVE, Form.TRANSFORM})
#: what entries are made of: the key that names one, its direction, and the keys of what it writes and reads
_ENTRIES: Mapping[Form, tuple[str, str | None, str | None, str | None]] = {
    Form.PUBLISH: ("topic", "publish", "fields", None),
    Form.RECEIVE: ("topic", "receive", None, "fields"),
    Form.CALL: ("service", None, "request", "response"),
    Form.GOAL: ("action", None, "goal", None),
    Form.FEEDBACK: ("action", None, None, "feedback"),
    Form.RESULT: ("action", None, None, "result"),
    Form.PARAMETER: ("parameter", None, None, "value"),
    Form.TRANSFORM: ("tf", None, None, "fields"),
    Form.TICK: ("timer", None, None, None),
    Form.SLEEP: ("rate", None, None, None),
}

#: how names begin with which the middleware itself does something
_OF_MIDDLEWARE = (
    "/use_sim_time", "use_sim_time", "start_type_description_service", "/rosout_disable_topics_generation",
    "/actionlib_client_", "/run_id", "/tcp_keepalive", "/enable_statistics", "/statistics_", "qos_overrides.",
)  # fmt: skip


@dataclass
class DescribedPart:
    """A part with its table and meaning; without a guess, its meaning is unknown."""

    table: str
    path: str
    part: WatchedPart
    guess: Guess | None


@dataclass
class MessageEntry:
    """A proposed entry.

    Attributes:
        key, name: what it is called by.
        direction: of a topic; None for anything else.
        type: as far as it is known.
        uses: what was seen.
        parts: what passes there.
        is_taken: whether a vocabulary takes it; a wrong guess may be why not.
    """

    key: str
    name: str
    direction: str | None = None
    type: str = ""
    uses: list[Use] = field(default_factory=list)
    parts: list[DescribedPart] = field(default_factory=list)
    is_taken: bool = True

    @property
    def files(self) -> list[str]:
        """The files with the uses."""
        return list(dict.fromkeys(where.rpartition(":")[0] for use in self.uses for where in use.sites))

    @property
    def of_tests(self) -> bool:
        """Whether only the tests use the name."""
        return all(use.of_tests for use in self.uses)

    @property
    def has_meaning(self) -> bool:
        """Whether the draft describes the meaning of any part of the message."""
        return any(part.guess is not None for part in self.parts)


def entries(found: Sequence[Use]) -> list[MessageEntry]:
    """Return an entry for each name that the program uses, and for meaningful readings of the tests."""
    made: dict[tuple[str, str, str | None], MessageEntry] = {}
    for use in sorted(found, key=lambda use: use.of_tests):
        if use.form not in _ENTRIES or use.name.startswith(_OF_MIDDLEWARE):
            continue
        if use.of_tests and (use.form not in _READINGS or use.is_called_back):
            continue
        key, direction, _, _ = _ENTRIES[use.form]
        entry = made.setdefault((key, use.name, direction), MessageEntry(key, use.name, direction))
        if entry.uses and use.of_tests and not entry.of_tests:
            continue  # what the program reads is known from the program alone
        entry.uses.append(use)
        entry.type = entry.type or _type(use)
        known = {(part.table, part.path) for part in entry.parts}
        entry.parts += [part for part in _described(use) if (part.table, part.path) not in known]
    return [entry for entry in made.values() if not entry.of_tests or entry.has_meaning]


def _type(use: Use) -> str:
    """Return the type of a message, service or action; ROS 2 calls the parts ``SetBool_Request``."""
    kind = use.written.type or use.read.type
    package, slash, name = kind.partition("/")
    if use.form is Form.TRANSFORM or not slash:
        return ""
    ending = next((suffix for suffix in _ENDINGS.get(use.form, ()) if name.endswith(suffix)), "")
    return f"{package}/{name.removesuffix(ending).partition('_')[0]}"


def _described(use: Use) -> Iterator[DescribedPart]:
    _, _, written, read = _ENTRIES[use.form]
    for table, values in ((written, use.written), (read, use.read)):
        if table is None:
            continue
        place = MessagePlace.of(use, values, is_written=values is use.written)
        for part in values.parts.values():
            meant = meaning(part, place) if values.always(part) else {}
            for path, guess in meant.items():
                yield DescribedPart(table, path, part, guess if guess.table else None)
            if not meant and not is_irrelevant(part, place):
                yield DescribedPart(table, part.path, part, None)


_HEADER = "std_msgs/Header"
_POINTS = frozenset({"geometry_msgs/Point", "geometry_msgs/Point32", "geometry_msgs/Pose2D"})
_TRANSLATION = ("geometry_msgs/Transform", "translation")
_TWIST = "geometry_msgs/Twist"
_GRIPPER = ("control_msgs/GripperCommand", "position")
_RANGE = ("sensor_msgs/Range", "range")
_JOINTS = {("sensor_msgs/JointState", "position"), ("trajectory_msgs/JointTrajectoryPoint", "positions")}
#: types whose fields are as conventions say, or unknown; their names alone say nothing
_STANDARD = re.compile(r"(?:geometry|sensor|nav|diagnostic|actionlib|action|visualization|shape)_msgs/.*")
_MOST_JOINTS = 12
_BYTES = ("uint8[", "char[", "byte[", "octet[", "sequence<uint8", "sequence<octet")
_MOMENTS = ("time", "duration", "builtin_interfaces/Time", "builtin_interfaces/Duration")
_BY = frozenset({"by", "relative", "rel", "offset", "shift", "jog", "delta", "step", "increment"})


@dataclass(frozen=True)
class MessagePlace:
    """The place where parts are sent or received.

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
    def of(cls, use: Use, values: Values, *, is_written: bool) -> MessagePlace:
        """Return the place of the values of a use."""
        parts = values.parts.values()
        frames = {value for part in parts if _is_header(part, "frame_id") for value in part.values}
        frame = next(iter(frames)) if len(frames) == 1 else ""
        return cls(use.form, words_of(use.name), is_written, frame)

    @property
    def is_by(self) -> bool:
        """Whether its name shows that the sent values are relative."""
        return bool(_BY & set(self.words))

    @property
    def is_plain_reply(self) -> bool:
        """Whether it is the response to a command, which only reports success."""
        return self.form is Form.CALL and not self.is_written and not READERS & set(self.words)


def meaning(part: WatchedPart, place: MessagePlace) -> Meant:
    """Return what a part means, by path; an empty guess for an unknown path, nothing for an unknown whole."""
    if place.is_plain_reply:
        return {}
    field_ = part.within[-1] if part.within else ("", "")
    if part.type == "geometry_msgs/Quaternion":
        return {part.path: Guess({"kind": "quaternion"})}
    if field_[0] == _HEADER:
        is_set = field_[1] in ("frame_id", "stamp") and any(part.values)
        return {part.path: Guess({"kind": field_[1]})} if is_set else {}
    if field_ in _JOINTS and part.length:
        return _joints(part, part.length, place)
    guess = _by_type(part, field_, place)
    if guess is not None:
        return {part.path: guess}
    if _STANDARD.fullmatch(field_[0]):
        return {}
    return by_name(part, place.words, is_written=place.is_written)


def _by_type(part: WatchedPart, field_: tuple[str, str], place: MessagePlace) -> Guess | None:
    """Return what a number means by the types that contain it; None if no convention applies."""
    holder, name = field_
    around = part.within[-2] if len(part.within) > 1 else ("", "")
    if holder in _POINTS or (holder == "geometry_msgs/Vector3" and around == _TRANSLATION):
        return _motion("rotation" if name == "theta" else "translation", name, place)
    if around[0] == _TWIST:  # a speed, unless the name says that a relative move is sent in it
        turns = around[1] == "angular"
        if place.is_written and place.is_by:
            return _motion("rotation" if turns else "translation", name, place)
        return Guess(_framed({"kind": "speed", "axis": name, "unit": "rad/s" if turns else "m/s"}, place))
    if field_ == _GRIPPER and place.is_written:
        table: TomlTable = {"kind": "opening", "unit": "m", "range": ["…", "…"]}
        return Guess(table, ["how far is it fully closed, and fully open?"])
    return Guess({"kind": "distance", "unit": "m"}) if field_ in (_GRIPPER, _RANGE) else None


def _motion(kind: str, name: str, place: MessagePlace) -> Guess:
    """Return the guess of a present or commanded position."""
    turns = kind == "rotation"
    axis, unit = "z" if name == "theta" else name, "rad" if turns else "m"
    read = "orientation" if turns else "position"
    table = _framed({"kind": kind if place.is_written else read, "axis": axis, "unit": unit}, place)
    return Guess({**table, "mode": "by" if place.is_by else "to"} if place.is_written else table)


def _framed(table: TomlTable, place: MessagePlace) -> TomlTable:
    return {**table, "frame": place.frame} if place.frame else table


def _joints(part: WatchedPart, count: int, place: MessagePlace) -> Meant:
    axis = "j1" if count == 1 else f"j1..j{count}"
    path = f"{part.path}[0]" if count == 1 else f"{part.path}[0:{count}]"
    written = {"kind": "rotation", "axis": axis, "unit": "rad", "mode": "to"}
    table = written if place.is_written else {"kind": "angle", "axis": axis, "unit": "rad"}
    return {path: Guess(table)} if count <= _MOST_JOINTS else {}


def _is_header(part: WatchedPart, name: str) -> bool:
    return bool(part.within) and part.within[-1] == (_HEADER, name)


def is_irrelevant(part: WatchedPart, place: MessagePlace) -> bool:
    """Return whether a part is irrelevant: fields of the middleware itself, and texts for people."""
    if part.within and part.within[-1][0] in (_HEADER, "std_msgs/MultiArrayLayout"):
        return True
    if any(isinstance(value, str) for value in part.values):
        return not place.is_written and bool(part.within) and part.within[-1] != ("std_msgs/String", "data")
    return part.type in _MOMENTS or part.type.startswith(_BYTES) or not (part.values or part.length)


#: names of fields that say nothing: the name of the topic or service does
_EMPTY = frozenset({"", "data", "value"})
#: values that are settings, and no scale
_LEAST_VALUES, _MOST_VALUES = 2, 5
#: no joint turns further, rad
_FULL_TURN = 6.5


def by_name(part: WatchedPart, words: Sequence[str], *, is_written: bool) -> Meant:
    """Return what a part means by the names of its field and topic, by path."""
    own, values = part.within[-1][1] if part.within else "", part.values
    setting = NameContext(tuple(words), values=values)
    if not values:
        return {}
    if part.length is not None:
        is_joints = any(re.fullmatch(r"joints?|(?:move|servo)j", word) for word in words)
        is_rate = re.search(r"vel|speed|acc|effort|torque", own) is not None
        name = "joints" if is_joints and not is_rate else own
        found = guess_elements(part, name, setting, written=is_written)
        return {path: _by_convention(guess, values) for path, guess in found.items()}
    if all(isinstance(value, bool) for value in values):
        kind = (
            "opening" if any(gripper_word in word for word in words for gripper_word in GRIPPER) else "output"
        )
        table: TomlTable = {"kind": kind, "values": [False, True]} if is_written else {"kind": "flag"}
        return {part.path: Guess(table)}
    few = _LEAST_VALUES <= len(values) <= _MOST_VALUES
    if all(isinstance(value, str) for value in values):
        return (
            {"": Guess({"kind": "label", "values": values})}
            if few and not part.path and not is_written
            else {}
        )
    if own in _EMPTY and is_written and any(VERBS.get(word) == "duration" for word in words):
        return {part.path: Guess({"kind": "duration", "unit": "s"})}
    name = "_".join(words[-1:]) if own in _EMPTY else own
    guess = guess_argument(name, setting) if is_written else guess_reading(name, setting)
    if guess.table and guess.table["kind"] not in ("label", "flag"):
        return {part.path: _by_convention(guess, values)}
    if own in _EMPTY and few and part.within and all(isinstance(value, int) for value in values):
        return {part.path: Guess({"kind": "output" if is_written else "label", "values": list(values)})}
    return {}


def _by_convention(guess: Guess, values: Sequence[Any]) -> Guess:
    """Assume radians, as is usual in ROS, for angles without a unit that are at most a turn."""
    numbers = [element for value in values for element in (value if isinstance(value, list) else [value])]
    is_small = all(abs(number) <= _FULL_TURN for number in numbers if isinstance(number, int | float))
    if guess.table.get("unit") == "rad" and is_small:
        guess.questions = [question for question in guess.questions if not question.startswith("the unit")]
    return guess
