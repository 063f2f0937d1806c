"""``mutabot init``: entries by name from what was seen to pass, and what the fields of messages mean."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mutabot.config.vocabulary import load_vocabulary
from mutabot.model.operation import Form
from mutabot_init.messages import MessagePlace, entries, meaning
from mutabot_init.observations import Use, Values, WatchedCalls, WatchedPart
from mutabot_init.observe import merged
from mutabot_init.operations import _with_opposites
from mutabot_init.text import entry_text, vocabulary_text
from mutabot_init.watching.values import look, type_of

HEADER = "std_msgs/Header"
POSE, POINT, ROTATION = "geometry_msgs/Pose", "geometry_msgs/Point", "geometry_msgs/Quaternion"
VECTOR, TWIST = "geometry_msgs/Vector3", "geometry_msgs/Twist"


def part(path: str, *within: tuple[str, str], kind: str = "float64", values: Any = (0.5,)) -> WatchedPart:
    length = len(values[0]) if isinstance(values[0], list) else None
    return WatchedPart(path, type=kind, within=within, values=list(values), length=length, count=1)


def raw_part(path: str, within: list[tuple[str, str]], kind: str, values: list[Any]) -> WatchedPart:
    return WatchedPart(path, type=kind, within=tuple(within), values=values, count=1)


def raw(form: str, name: str, **more: Any) -> Use:
    usual: dict[str, Any] = {"of_tests": False, "is_called_back": False, "sites": {"mission.py:7": 1}}
    return Use(Form(form), name, **{**usual, **more})


def passed(kind: str, *parts: WatchedPart) -> Values:
    return Values(1, kind, {part.path: part for part in parts})


def uses(several: list[Use]) -> list[Use]:
    return merged([WatchedCalls(uses=several)]).uses


def place(form: Form, name: str, *, is_written: bool = False) -> MessagePlace:
    return MessagePlace.of(raw(form, name), Values(), is_written=is_written)


MOVED = {"kind": "translation", "axis": "y", "unit": "m"}
SPEED = {"kind": "speed", "axis": "y", "unit": "m/s"}


@pytest.mark.parametrize(
    ("name", "sent", "table"),
    [
        ("/goal", part("p.y", (POSE, "position"), (POINT, "y")), {**MOVED, "mode": "to"}),
        ("/arm/move_by", part("p.y", (POINT, "y")), {**MOVED, "mode": "by"}),
        ("/cmd_vel", part("l.y", (TWIST, "linear"), (VECTOR, "y")), SPEED),
        ("/arm/move_by", part("l.y", (TWIST, "linear"), (VECTOR, "y")), {**MOVED, "mode": "by"}),
        (
            "/cmd_vel",
            part("a.z", (TWIST, "angular"), (VECTOR, "z")),
            {"kind": "speed", "axis": "z", "unit": "rad/s"},
        ),
        ("/goal", part("o", (POSE, "orientation"), kind=ROTATION), {"kind": "quaternion"}),
        ("/arm/wait", part("data", ("std_msgs/Float64", "data")), {"kind": "duration", "unit": "s"}),
        (
            "/lamp",
            part("data", ("std_msgs/Bool", "data"), kind="bool", values=(True,)),
            {"kind": "output", "values": [False, True]},
        ),
        (
            "/gripper/close",
            part("data", ("std_srvs/SetBoolRequest", "data"), kind="bool", values=(True,)),
            {"kind": "opening", "values": [False, True]},
        ),
    ],
)
def test_what_is_sent_means_what_ros_says(name: str, sent: WatchedPart, table: dict[str, Any]) -> None:
    (guess,) = meaning(sent, place(Form.PUBLISH, name, is_written=True)).values()
    assert guess.table == table
    assert guess.is_sure


@pytest.mark.parametrize(
    ("read", "table"),
    [
        (part("p.x", (POSE, "position"), (POINT, "x")), {"kind": "position", "axis": "x", "unit": "m"}),
        (
            part("t.x", ("geometry_msgs/Transform", "translation"), (VECTOR, "x")),
            {"kind": "position", "axis": "x", "unit": "m"},
        ),
        (part("twist.linear.y", (TWIST, "linear"), (VECTOR, "y")), SPEED),
        (part("r", ("sensor_msgs/Range", "range")), {"kind": "distance", "unit": "m"}),
        (
            part("theta", ("geometry_msgs/Pose2D", "theta")),
            {"kind": "orientation", "axis": "z", "unit": "rad"},
        ),
        (
            part("position", ("sensor_msgs/JointState", "position"), values=([0.1, 0.2],)),
            {"kind": "angle", "axis": "j1..j2", "unit": "rad"},
        ),
        (
            part("data", ("std_msgs/Int32", "data"), values=(4, 7)),
            {"kind": "label", "values": [4, 7]},
        ),
    ],
)
def test_what_is_read_means_what_ros_says(read: WatchedPart, table: dict[str, Any]) -> None:
    (guess,) = meaning(read, place(Form.RECEIVE, "/it")).values()
    assert guess.table == table


@pytest.mark.parametrize(
    "read",
    [
        part("wrench.force.x", ("geometry_msgs/Wrench", "force"), (VECTOR, "x")),
        part("level", ("sensor_msgs/BatteryState", "percentage")),
        part("code", ("vendor_msgs/State", "code"), values=(3,)),
        part("header.stamp", (HEADER, "stamp"), kind="time", values=(0.0,)),  # nobody has set it
        part("position", ("vendor_msgs/State", "position"), values=([],)),
        part("data", ("std_msgs/Int32", "data"), values=(9,)),
    ],
)
def test_nothing_is_made_up_where_nothing_is_known(read: WatchedPart) -> None:
    assert meaning(read, place(Form.RECEIVE, "/it")) == {}


def test_poses_and_joints_of_a_vendor_are_identified_by_the_names_of_services() -> None:
    pose = part("pose", ("arm_msgs/MoveRequest", "pose"), values=([282.0, 187.9, 404.5, 3.1, 0.0, -1.5],))
    line = meaning(pose, place(Form.CALL, "/arm/move_line", is_written=True))
    assert {path: guess.table.get("unit") for path, guess in line.items()} == {
        "pose[0:3]": "mm",
        "pose[3:6]": "rad",
    }
    assert line["pose[3:6]"].questions
    angles = part("pose", ("arm_msgs/MoveRequest", "pose"), values=([0.1, 0.2, 0.3, 0.4, 0.5, 0.6],))
    joint = meaning(angles, place(Form.CALL, "/arm/move_joint", is_written=True))
    assert joint["pose[0:6]"].table["axis"] == "j1..j6"
    assert joint["pose[0:6]"].table["unit"] == "rad"


def everything() -> list[Use]:
    flag = raw_part("data", [("std_srvs/SetBoolRequest", "data")], "bool", [True])
    success = raw_part("success", [("std_srvs/SetBoolResponse", "success")], "bool", [True])
    stamped = "geometry_msgs/PoseStamped"
    header = [(stamped, "header"), ("std_msgs/Header", "frame_id")]
    frame = raw_part("header.frame_id", header, "string", ["base"])
    x = raw_part("pose.position.x", [(stamped, "pose"), (POSE, "position"), (POINT, "x")], "float64", [0.5])
    turn = raw_part("pose.orientation", [(stamped, "pose"), (POSE, "orientation")], ROTATION, [])
    odd = raw_part("speed", [("vendor_msgs/Odd", "speed")], "float32", [3.0])
    reached = raw_part("code", [("vendor_msgs/Go_Result", "code")], "int8", [1])
    to = raw_part("target", [("vendor_msgs/Go_Goal", "target")], "float64", [0.25])
    return [
        raw("publish", "/arm/goal", written=passed(stamped, frame, x, turn)),
        raw("publish", "/odd", written=passed("vendor_msgs/Odd", odd)),
        raw(
            "call",
            "/gripper/close",
            written=passed("std_srvs/SetBoolRequest", flag),
            read=passed("std_srvs/SetBoolResponse", success),
        ),
        raw("goal", "/go", written=passed("vendor_msgs/Go_Goal", to)),
        raw("result", "/go", read=passed("vendor_msgs/Go_Result", reached)),
        raw("parameter", "/robot", read=passed("str", raw_part("", [], "str", ["left", "right"]))),
        raw("parameter", "/use_sim_time", read=passed("bool", raw_part("", [], "bool", [True]))),
        raw("tick", "Mission.on_time"),
        raw("sleep", "/mission_4711_1700000000000", sites={"mission.py:9": 12}),
        raw("transform", "base → tool", read=passed("geometry_msgs/TransformStamped")),
        raw("receive", "/tests/wait", of_tests=True, read=passed(stamped, x)),
        raw("receive", "/tests/hear", of_tests=True, is_called_back=True, read=passed(stamped, x)),
        raw("publish", "/tests/send", of_tests=True, written=passed(stamped, x)),
    ]


def test_a_vocabulary_takes_the_entries_as_they_are(tmp_path: Path) -> None:
    text = vocabulary_text(entries(uses(everything())), ["mission.py"])
    (tmp_path / "robot.toml").write_text(text, encoding="utf-8")
    found = {
        operation.target: operation for operation in load_vocabulary(["robot.toml"], tmp_path).operations
    }
    mains = {"publish", "receive", "call", "goal", "parameter", "tick", "sleep", "transform"}
    assert [target for target in found if target.partition(" ")[0] in mains] == [
        "publish /arm/goal",
        "publish /odd",
        "call /gripper/close",
        "goal /go",
        "parameter /robot",
        "tick Mission.on_time",
        "sleep /mission_*",
        "transform base → tool",
        "receive /tests/wait",  # what the tests wait for, not what they send or hear in callbacks
    ]
    goal = found["publish /arm/goal"].named
    assert goal is not None
    assert goal.type == "geometry_msgs/PoseStamped"


def test_what_is_guessed_and_what_nothing_shows_stands_there() -> None:
    texts = {entry.name: entry_text(entry) for entry in entries(uses(everything()))}
    assert texts["/arm/goal"].splitlines() == [
        "[[operation]]  # seen: 1 message, first at mission.py:7",
        'topic = "/arm/goal"',
        'direction = "publish"',
        'type = "geometry_msgs/PoseStamped"',
        'fields."header.frame_id" = { kind = "frame_id" }  # seen: "base"',
        'fields."pose.position.x" = { kind = "translation", axis = "x", unit = "m", frame = "base", '
        'mode = "to" }  # seen: 0.5',
        'fields."pose.orientation" = { kind = "quaternion" }',
    ]
    assert (
        texts["/odd"]
        .splitlines()[-1]
        .startswith('# fields.speed = { kind = "speed", unit = "m/s" }  # question: ')
    )
    assert texts["/gripper/close"].splitlines()[-1].startswith('# refused = { path = "success"')
    assert texts["/go"].splitlines()[2] == 'type = "vendor_msgs/Go"'
    assert {"# goal.target  # seen: 0.25", "# result.code  # seen: 1"} <= set(texts["/go"].splitlines())
    assert "12 turns" in texts["/mission_*"]


def test_what_several_processes_saw_is_one_entry() -> None:
    first = raw("parameter", "/side", read=passed("str", raw_part("", [], "str", ["left"])))
    second = raw("parameter", "/side", read=passed("str", raw_part("", [], "str", ["right"])))
    (entry,) = entries(uses([first, second]))
    assert 'value = { kind = "label", values = ["left", "right"] }' in entry_text(entry)
    assert "seen: 2 readings" in entry_text(entry)


def test_an_entry_that_no_vocabulary_takes_is_a_comment() -> None:
    (entry,) = entries(uses([raw("sleep", "/mission")]))
    entry.is_taken = False
    text = vocabulary_text([entry], ["mission.py"])
    assert all(line.startswith("#") for line in text.splitlines() if line)


class Time:
    __slots__ = ("nsecs", "secs")

    def __init__(self, secs: int = 0, nsecs: int = 0) -> None:
        self.secs, self.nsecs = secs, nsecs


class Header:
    """As ROS 1 makes its messages."""

    __slots__ = ["frame_id", "stamp"]
    _type, _slot_types = "std_msgs/Header", ["string", "time"]

    def __init__(self) -> None:
        self.stamp, self.frame_id = Time(2, 500_000_000), "base"


class Path1:
    """As ROS 1 makes its messages."""

    __slots__ = ["header", "headers", "numbers"]
    _type, _slot_types = "nav_msgs/Path", ["std_msgs/Header", "std_msgs/Header[]", "float64[]"]

    def __init__(self) -> None:
        self.header, self.numbers, self.headers = Header(), [1.0, 2.0], [Header()]


class Flag:
    """As ROS 2 makes its messages."""

    _data = True

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        return {"data": "boolean"}

    @property
    def data(self) -> bool:
        return self._data


def test_messages_of_both_generations_are_described_without_their_packages() -> None:
    parts = Values()
    look(parts, Path1(), message=True)
    found = {path: (value.type, value.values) for path, value in parts.parts.items()}
    assert found == {
        "header.stamp": ("time", [2.5]),
        "header.frame_id": ("string", ["base"]),
        "numbers": ("float64[]", [[1.0, 2.0]]),
        "headers[-1].stamp": ("time", [2.5]),
        "headers[-1].frame_id": ("string", ["base"]),
    }
    assert type_of(Flag()) == f"{__name__.partition('.')[0]}/Flag"
    flag = Values()
    look(flag, Flag(), message=True)
    assert flag.parts["data"].within == ((type_of(Flag()), "data"),)


@pytest.mark.parametrize(
    ("name", "opposites"),
    [
        ("GripperClose", {"GripperOpen"}),
        ("closeGripper", {"openGripper"}),
        ("VALVE_OPEN", {"VALVE_CLOSE"}),
        ("forward", {"back", "backward"}),
        ("unclamp", {"clamp"}),
        ("SetOnline", set()),
        ("reopen", set()),
        ("REOPEN", set()),
    ],
)
def test_an_opposite_is_a_whole_word_in_any_way_of_writing(name: str, opposites: set[str]) -> None:
    assert {*_with_opposites(name)} == opposites
