"""Vocabularies that load, and what they mean."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.baseline.vocabulary_fit import useless_noise
from mutabot.config.vocabulary import load_vocabulary
from mutabot.config.vocabulary.load import shipped_vocabularies
from mutabot.model import Clock, Kind, Mode, Operation, Probe, Quantity, Vocabulary
from mutabot.model.answer import restore
from mutabot.model.codec import from_data, to_data
from pages import blocks

PAGE = Path(__file__).parents[3] / "docs" / "vocabulary.md"

#: the example of the design, with the operation that its `current` names
DESIGN = """
[[operation]]
call = "robot:Arm.move_by"                      # module:qualified.name
arguments.dx = { kind = "translation", axis = "x", unit = "m", frame = "base", mode = "by" }
arguments.yaw = { kind = "rotation", axis = "z", unit = "deg", mode = "by" }
current = "robot:Arm.tool_pose"                 # where it is now: lets by-to compute
refusals = ["robot:MotionRefused"]

[[operation]]
call = "robot:Arm.tool_pose"
result.".x" = { kind = "position", axis = "x", unit = "m", frame = "base" }

[[operation]]
call = "robot:Gripper.command"
arguments.position = { kind = "opening", values = [0, 1] }

[[operation]]
call = "camera:locate"
result."[0]" = { kind = "label", values = ["red", "blue"] }
result.".pose.x" = { kind = "position", axis = "x", unit = "m", frame = "base", noise = 0.002 }

[[operation]]                                   # commands sent as text
call = "link:send"
message = "text"                                # the argument that holds the command
patterns = [
  { text = "lift/{z:g}", kind = "translation", axis = "z", unit = "cm", mode = "by", opposite = "drop/{z:g}"},
  { text = "turn/{angle:g}", kind = "rotation", axis = "z", unit = "deg", mode = "to" },
]
"""


def loaded(folder: Path, text: str) -> Vocabulary:
    (folder / "robot.toml").write_text(text)
    return load_vocabulary(["robot.toml"], folder)


def only(folder: Path, text: str) -> Operation:
    (operation,) = loaded(folder, "[[operation]]\ncall = 'robot:Arm.go'\n" + text).operations
    return operation


def test_the_example_of_the_design_means_what_it_says(tmp_path: Path) -> None:
    move, pose, grip, locate, send = loaded(tmp_path, DESIGN).operations

    dx, yaw = move.arguments
    assert (dx.name, str(dx.path), dx.kind, dx.axis) == ("dx", "dx", Kind.TRANSLATION, "x")
    assert (dx.unit, dx.frame, dx.mode) == ("m", "base", Mode.BY)
    assert (yaw.name, yaw.kind, yaw.unit) == ("yaw", Kind.ROTATION, "deg")
    assert (move.current, move.refusals) == ("robot:Arm.tool_pose", ("robot:MotionRefused",))
    assert move.command
    assert move.source == "robot.toml:2 · robot:Arm.move_by"

    assert not pose.command
    (position,) = grip.arguments
    assert (position.kind, position.values, position.unit) == (Kind.OPENING, (0, 1), "fraction")

    label, x = locate.result
    assert (label.name, label.values, label.unit) == ("[0]", ("red", "blue"), None)
    assert (x.name, str(x.path), x.noise) == (".pose.x", ".pose.x", 0.002)
    assert not locate.command

    lift, turn = send.patterns
    assert (send.message, send.command) == ("text", True)
    assert (lift.text, lift.opposite) == ("lift/{z:g}", "drop/{z:g}")
    assert [(q.name, q.kind, q.unit) for q in lift.arguments] == [("z", Kind.TRANSLATION, "cm")]
    assert turn.arguments[0].mode is Mode.TO
    assert lift.source == "robot.toml:26 · link:send · lift/{z}"


def test_the_examples_of_the_documentation_load(tmp_path: Path) -> None:
    first, whole, *_ = (
        block for block in blocks(PAGE.read_text(encoding="utf-8")) if block.language == "toml"
    )
    assert [operation.name for operation in loaded(tmp_path, first.text).operations] == ["Arm.move_by"]
    vocabulary = loaded(tmp_path, whole.text)
    assert [operation.name for operation in vocabulary.operations][:2] == ["Arm.move_by", "Arm.tool_pose"]
    pose = vocabulary.operation("robot:Arm.tool_pose")
    assert pose is not None
    assert [(q.name, q.kind.value, q.axis) for q in pose.result] == [
        ("[0]", "position", "x"),
        ("[1]", "position", "y"),
        ("[2]", "position", "z"),
        ("[3]", "orientation", "x"),
        ("[4]", "orientation", "y"),
        ("[5]", "orientation", "z"),
    ]


def test_the_documentation_names_every_kind() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert [kind for kind in Kind if f"`{kind}`" not in text] == []


def test_every_shipped_vocabulary_loads(tmp_path: Path) -> None:
    for name in shipped_vocabularies():
        assert load_vocabulary([name], tmp_path).operations


@pytest.mark.parametrize("name", shipped_vocabularies())
def test_a_shipped_vocabulary_describes_no_noise_that_no_operator_adds(name: str, tmp_path: Path) -> None:
    assert [*useless_noise(load_vocabulary([name], tmp_path))] == []


def test_a_shipped_vocabulary_is_found_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "arm.toml").write_text("[[operation]]\ncall = 'a:b'\n")
    monkeypatch.setattr(sys.modules["mutabot.config.vocabulary.load"], "_SHIPPED", tmp_path)
    assert load_vocabulary(["arm"], tmp_path / "project").operations[0].source == "arm:1 · a:b"


@pytest.mark.parametrize(
    ("path", "axis", "expected"),
    [
        ("[0:3]", "xyz", [("[0]", "x"), ("[1]", "y"), ("[2]", "z")]),
        ("[:2]", "xy", [("[0]", "x"), ("[1]", "y")]),
        ("[3:]", "xy", [("[3]", "x"), ("[4]", "y")]),
        ("[:]", "yz", [("[0]", "y"), ("[1]", "z")]),
        ("[-3:]", "xyz", [("[-3]", "x"), ("[-2]", "y"), ("[-1]", "z")]),
        ("[-3:-1]", "xy", [("[-3]", "x"), ("[-2]", "y")]),
        ("[0:6:2]", "xyz", [("[0]", "x"), ("[2]", "y"), ("[4]", "z")]),
        (".pose[1:3]", "zx", [(".pose[1]", "z"), (".pose[2]", "x")]),
        ("[0:2]", "j1j12", [("[0]", "j1"), ("[1]", "j12")]),
        ("[0:3]", "j2..j4", [("[0]", "j2"), ("[1]", "j3"), ("[2]", "j4")]),
    ],
)
def test_several_axes_are_spread_over_a_slice(
    path: str, axis: str, expected: list[tuple[str, str]], tmp_path: Path
) -> None:
    kind, unit = ("angle", "rad") if "j" in axis else ("position", "m")
    text = f"result.'{path}' = {{ kind = '{kind}', axis = '{axis}', unit = '{unit}' }}"
    assert [(q.name, q.axis) for q in only(tmp_path, text).result] == expected


def test_a_slice_of_an_argument_is_spread_as_well(tmp_path: Path) -> None:
    text = "arguments.'target[0:2]' = { kind = 'translation', axis = 'xy', unit = 'mm', mode = 'to' }"
    x, y = only(tmp_path, text).arguments
    assert (x.name, x.path.root, y.name) == ("target[0]", "target", "target[1]")


def test_a_slice_without_axes_stays_one_quantity(tmp_path: Path) -> None:
    (vector,) = only(tmp_path, "result.'[0:3]' = { kind = 'position', unit = 'm' }").result
    assert (vector.name, vector.path.get([1, 2, 3, 4])) == ("[0:3]", [1, 2, 3])


def test_a_whole_result_is_named_result(tmp_path: Path) -> None:
    (gap,) = only(tmp_path, "result = { kind = 'distance', unit = 'mm', noise = 0.5 }").result
    assert (gap.name, gap.path.steps, gap.noise) == ("result", (), 0.5)


def test_keys_named_like_those_of_a_quantity_are_paths_in_brackets(tmp_path: Path) -> None:
    (gap,) = only(tmp_path, "result.\"['kind']\" = { kind = 'distance', unit = 'mm' }").result
    assert gap.path.get({"kind": 3}) == 3


def test_paths_into_arguments_need_no_quotes(tmp_path: Path) -> None:
    (x,) = only(
        tmp_path, "arguments.pose.position.x = { kind = 'translation', unit = 'm', mode = 'to' }"
    ).arguments
    assert (x.name, x.path.root) == ("pose.position.x", "pose")


def test_a_flag_is_false_or_true_unless_it_says_otherwise(tmp_path: Path) -> None:
    held, ready = only(
        tmp_path,
        "result.'.held' = { kind = 'flag' }\nresult.'.ready' = { kind = 'flag', values = ['no', 'yes'] }",
    ).result
    assert (held.values, ready.values) == ((False, True), ("no", "yes"))


@pytest.mark.parametrize(
    ("table", "unit"),
    [
        ("values = [0, 1]", "fraction"),
        ("range = [0, 1]", "fraction"),
        ("values = ['open', 'closed']", None),
        ("values = [0, 100], unit = 'percent'", "percent"),
        ("range = [0, 0.085], unit = 'm'", "m"),
    ],
)
def test_an_opening_between_0_and_1_is_a_fraction(table: str, unit: str | None, tmp_path: Path) -> None:
    (opening,) = only(tmp_path, f"arguments.p = {{ kind = 'opening', {table} }}").arguments
    assert opening.unit == unit


_FLAG = "result = { kind = 'flag' }"
_WAIT = "arguments.t = { kind = 'duration', unit = 's' }"


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ("", True),
        (_FLAG, False),
        (_WAIT, True),
        (f"{_WAIT}\n{_FLAG}", True),
        (f"{_FLAG}\ncommand = true", True),
        (f"{_WAIT}\ncommand = false", False),
        ("message = 'm'", True),
        ("message = 'm'\npatterns = [{ text = 'held?', result = { kind = 'flag' } }]", False),
        (f"message = 'm'\npatterns = [{{ text = 'held?' }}]\n{_FLAG}", False),
        (
            "message = 'm'\npatterns = [{ text = 'home' }, { text = 'held?', result = { kind = 'flag' } }]",
            True,
        ),
        (
            f"message = 'm'\npatterns = [{{ text = 't/{{t:g}}', kind = 'duration', unit = 's' }}]\n{_FLAG}",
            True,
        ),
    ],
)
def test_a_call_is_a_command_unless_it_only_reads(text: str, command: bool, tmp_path: Path) -> None:
    assert only(tmp_path, text).command is command


def test_a_pattern_with_several_fields_describes_each(tmp_path: Path) -> None:
    text = """message = "m"
    [[operation.patterns]]
    text = "go/{x:g}/{y:.2f}/{name}"
    arguments.x = { kind = "translation", axis = "x", unit = "m", mode = "to" }
    arguments.y = { kind = "translation", axis = "y", unit = "m", mode = "to" }
    result."[0]" = { kind = "flag" }
    """
    (pattern,) = only(tmp_path, text).patterns
    assert [q.name for q in pattern.arguments] == ["x", "y"]
    assert [q.name for q in pattern.result] == ["[0]"]


def test_a_rotation_of_a_joint_may_be_given_by_the_joint_angle(tmp_path: Path) -> None:
    text = """
    [[operation]]
    call = "robot:turn"
    arguments.angle = { kind = "rotation", axis = "j3", unit = "deg", mode = "by" }
    current = "robot:joints"
    [[operation]]
    call = "robot:joints"
    result."[0:7]" = { kind = "angle", axis = "j1..j7", unit = "rad" }
    """
    assert len(loaded(tmp_path, text).operations) == 2


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("idle = 3", 3),
        ("idle = ''", ""),
        ("idle = [true, [2.5]]", [True, [2.5]]),
        ("idle = { a = 1, b.c = [2] }", {"a": 1, "b": {"c": [2]}}),
        ("idle = { call = 'math:sqrt', b = 1 }", {"call": "math:sqrt", "b": 1}),
        ("idle = { call = 'builtins:dict' }", {}),
    ],
)
def test_an_answer_to_doing_nothing_is_what_toml_says(text: str, expected: Any, tmp_path: Path) -> None:
    assert restore(only(tmp_path, text).idle, {}) == expected


def test_each_text_command_may_have_an_answer_of_its_own(tmp_path: Path) -> None:
    found = only(
        tmp_path, "message = 'text'\nidle = 'no'\npatterns = [{ text = 'a', idle = 'yes' }, { text = 'b' }]"
    )
    assert [found.idle, *(pattern.idle for pattern in found.patterns)] == ["no", "yes", None]


def test_opposites_name_each_other(tmp_path: Path) -> None:
    text = """
    [[operation]]
    call = "g:Hand.open"
    opposite = "g:Hand.close"
    [[operation]]
    call = "g:Hand.close"
    opposite = "g:Hand.open"
    """
    assert [operation.opposite for operation in loaded(tmp_path, text).operations] == [
        "g:Hand.close",
        "g:Hand.open",
    ]


def test_a_file_may_hold_only_what_concerns_all_operations(tmp_path: Path) -> None:
    text = """
    refusals = ["robot:Refused", "builtins:ValueError"]
    checks = ["cell:MonitorError"]
    failures = ["cell:SimulatorError"]
    clock = { tick = "sim:World.step", time = "self.time", unit = "ms" }
    [[probe]]
    call = "world:box_pose"
    tolerance = 0.001
    """
    vocabulary = loaded(tmp_path, text)
    assert vocabulary.refusals == ("robot:Refused", "builtins:ValueError")
    assert (vocabulary.checks, vocabulary.failures) == (("cell:MonitorError",), ("cell:SimulatorError",))
    assert vocabulary.clock == Clock(
        "sim:World.step", "self.time", rooted=True, unit="ms", source="robot.toml:5 · clock"
    )
    assert vocabulary.probes == (Probe("world:box_pose", 0.001, "robot.toml:6 · world:box_pose"),)


@pytest.mark.parametrize(
    ("time", "rooted"), [("", False), (".time", False), ("[0]", False), ("data.time", True), ("self", True)]
)
def test_the_time_is_in_the_result_or_in_an_argument(time: str, rooted: bool, tmp_path: Path) -> None:
    clock = loaded(tmp_path, f"clock = {{ tick = 'sim:step', time = '{time}' }}").clock
    assert clock is not None
    assert (clock.time, clock.rooted, clock.unit) == (time, rooted, "s")


def test_a_pattern_may_describe_arguments_beside_the_text(tmp_path: Path) -> None:
    text = """message = "node"
    arguments.timeout = { kind = "duration", unit = "s" }
    [[operation.patterns]]
    text = "axis/{n:d}"
    arguments.n = { kind = "output", values = [1, 2] }
    arguments.value = { kind = "translation", unit = "m", mode = "to" }
    arguments.pose.x = { kind = "translation", unit = "m", mode = "to" }
    """
    operation = only(tmp_path, text)
    (pattern,) = operation.patterns
    assert [q.name for q in pattern.arguments] == ["n", "value", "pose.x", "timeout"]
    assert pattern.fields == {"n"}
    assert operation.described.keys() == {"timeout", "value", "pose", "node"}


def test_the_object_of_a_call_may_decide_which_command_it_is(tmp_path: Path) -> None:
    text = """message = "self.nodeid"
    patterns = [{ text = "ns=2;s=X", arguments.value = { kind = "duration", unit = "s" } }]
    """
    operation = only(tmp_path, text)
    assert (operation.message, operation.command) == ("self.nodeid", True)
    assert operation.described == {"value": "arguments.value"}


def test_an_argument_may_decide_about_the_mode(tmp_path: Path) -> None:
    text = """
    result = { kind = "flag" }
    arguments.dx = { kind = "rotation", unit = "deg", mode = { argument = "rel", true = "by", false = "to" } }
    arguments.speed = { kind = "output", range = [0, 1] }
    """
    operation = only(tmp_path, text)
    assert not operation.arguments
    assert operation.command
    facts = [
        (
            pattern.text,
            pattern.notation,
            [(q.name, q.mode) for q in pattern.arguments],
            [q.name for q in pattern.result],
        )
        for pattern in operation.patterns
    ]
    assert facts == [
        ("rel=true", None, [("dx", Mode.BY), ("speed", None)], ["result"]),
        ("rel=false", None, [("dx", Mode.TO), ("speed", None)], ["result"]),
    ]
    assert {type(q) for pattern in operation.patterns for q in pattern.arguments} == {Quantity}
    assert from_data(Operation, to_data(operation)) == operation


def test_two_arguments_that_decide_make_a_command_of_each_combination(tmp_path: Path) -> None:
    def mode(argument: str) -> str:
        return f'mode = {{ argument = "{argument}", true = "by", false = "to" }}'

    text = f"""message = "m"
    [[operation.patterns]]
    text = "go/{{x:g}}/{{y:g}}"
    opposite = "back/{{x:g}}/{{y:g}}"
    arguments.x = {{ kind = "translation", unit = "m", {mode("a")} }}
    arguments.y = {{ kind = "translation", unit = "m", {mode("b")} }}
    """
    patterns = only(tmp_path, text).patterns
    assert [pattern.text.partition(" ")[2] for pattern in patterns] == [
        "[a=true, b=true]",
        "[a=true, b=false]",
        "[a=false, b=true]",
        "[a=false, b=false]",
    ]
    assert {pattern.notation for pattern in patterns} == {"go/{x:g}/{y:g}"}
    assert patterns[1].name == "go/{x}/{y} [a=true, b=false]"


def test_a_signature_names_the_arguments_of_a_callable_that_does_not(tmp_path: Path) -> None:
    text = """signature = "(body, joints, …)"
    arguments.force = { kind = "output", range = [0, 9] }
    arguments.body = { kind = "output", range = [0, 9] }
    """
    assert only(tmp_path, text).signature == "(body, joints, …)"


def test_a_clock_may_count_fixed_steps(tmp_path: Path) -> None:
    clock = loaded(tmp_path, "clock = { tick = 'pybullet:stepSimulation', step = 0.004166 }").clock
    assert clock is not None
    assert (clock.step, clock.unit, clock.rooted) == (0.004166, "s", False)


def test_files_are_put_together_and_equal_descriptions_are_one(tmp_path: Path) -> None:
    common = "refusals = ['a:B']\nclock = { tick = 'sim:step' }\n[[operation]]\ncall = 'a:b'\n"
    (tmp_path / "one.toml").write_text(common)
    (tmp_path / "two.toml").write_text("# later\n" + common + "[[operation]]\ncall = 'a:c'\n")
    vocabulary = load_vocabulary(["one.toml", "two.toml", "one.toml"], tmp_path)
    assert [operation.target for operation in vocabulary.operations] == ["a:b", "a:c"]
    assert vocabulary.refusals == ("a:B",)


def test_operations_may_refer_to_those_of_another_file(tmp_path: Path) -> None:
    (tmp_path / "one.toml").write_text("[[operation]]\ncall = 'a:open'\nopposite = 'a:close'\n")
    (tmp_path / "two.toml").write_text("[[operation]]\ncall = 'a:close'\n")
    assert len(load_vocabulary(["one.toml", "two.toml"], tmp_path).operations) == 2


def test_windows_line_ends_and_byte_order_marks_are_taken(tmp_path: Path) -> None:
    (tmp_path / "robot.toml").write_bytes(b"\xef\xbb\xbf[[operation]]\r\ncall = 'a:b'\r\n")
    assert load_vocabulary(["robot.toml"], tmp_path).operations[0].source == "robot.toml:1 · a:b"
