"""Operations that have a name on a middleware: what entries of a vocabulary become."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.config.vocabulary import load_vocabulary
from mutabot.errors import ConfigurationError
from mutabot.model import Mode, Operation, Vocabulary
from mutabot.model.codec import from_data, to_data
from mutabot.model.operation import Form, Named
from mutabot.operators.operator import with_operation
from pages import blocks

PAGE = Path(__file__).parents[3] / "docs" / "vocabulary.md"
X = '{ kind = "translation", axis = "x", unit = "m", mode = "to" }'
GOAL = 'topic = "/arm/goal"\ndirection = "publish"\n'


def loaded(folder: Path, text: str) -> Vocabulary:
    (folder / "robot.toml").write_text(text)
    return load_vocabulary(["robot.toml"], folder)


def entry(folder: Path, text: str) -> dict[str, Operation]:
    return {operation.target: operation for operation in loaded(folder, "[[operation]]\n" + text).operations}


def refused(folder: Path, text: str) -> str:
    with pytest.raises(ConfigurationError) as caught:
        loaded(folder, "[[operation]]\n" + text)
    return str(caught.value)


def test_a_topic_to_publish_on_comes_with_the_publisher(tmp_path: Path) -> None:
    found = entry(tmp_path, f'{GOAL}type = "geometry_msgs/msg/PoseStamped"\nfields.pose.position.x = {X}')
    publish, advertise = found["publish /arm/goal"], found["advertise /arm/goal"]
    assert publish.named == Named(Form.PUBLISH, "/arm/goal", None, "geometry_msgs/PoseStamped")
    assert (publish.kind, publish.command, advertise.command) == ("messages", True, False)
    (quantity,) = publish.arguments
    assert (quantity.name, str(quantity.path)) == ("pose.position.x", "message.pose.position.x")
    assert publish.source == "robot.toml:1 · publish /arm/goal"
    assert advertise.arguments == Form.ADVERTISE.settings


def test_what_is_received_is_read(tmp_path: Path) -> None:
    text = 'topic = "/colour"\ndirection = "receive"\nnode = "/mission"\n'
    found = entry(tmp_path, text + 'fields.data = { kind = "label", values = ["red", "blue"] }')
    assert list(found) == ["receive /colour of /mission", "subscribe /colour of /mission"]
    (quantity,) = found["receive /colour of /mission"].result
    assert (quantity.name, str(quantity.path)) == ("data", ".data")
    assert not any(operation.command for operation in found.values())


def test_a_service_writes_its_request_and_reads_its_response(tmp_path: Path) -> None:
    text = 'service = "/gripper"\nrequest.data = { kind = "output", values = [false, true] }\n'
    call = entry(tmp_path, text + 'response.success = { kind = "flag" }')["call /gripper"]
    assert [str(argument.path) for argument in (*call.arguments, *call.result)] == [
        "request.data",
        ".success",
    ]
    assert call.command


def test_a_service_that_only_reads_is_no_command(tmp_path: Path) -> None:
    home = 'service = "/home"\n'
    assert not entry(tmp_path, f'{home}response.success = {{ kind = "flag" }}')["call /home"].command
    assert entry(tmp_path, home)["call /home"].command


def test_an_action_is_all_that_is_done_with_it(tmp_path: Path) -> None:
    found = entry(
        tmp_path,
        'action = "/arm/follow"\nfeedback."points[-1].x" = { kind = "position", axis = "x", unit = "m" }\n'
        'goal."trajectory.points[-1].positions[0:2]" = '
        '{ kind = "rotation", axis = "j1..j2", unit = "rad", mode = "to" }\n'
        'result.error_code = { kind = "label", values = [0, -1] }',
    )
    assert [target.partition(" ")[0] for target in found] == [
        "goal",
        "feedback",
        "result",
        "cancel",
        "client",
    ]
    assert [argument.name for argument in found["goal /arm/follow"].arguments] == [
        "trajectory.points[-1].positions[0]",
        "trajectory.points[-1].positions[1]",
    ]
    assert [quantity.name for quantity in found["feedback /arm/follow"].result] == ["points[-1].x"]
    assert [quantity.name for quantity in found["result /arm/follow"].result] == ["error_code"]
    assert found["cancel /arm/follow"].command


@pytest.mark.parametrize(
    ("text", "targets"),
    [
        ('parameter = "speed"', ["parameter speed"]),
        ('timer = "*"', ["tick *", "timer *"]),
        ('rate = "/mission"', ["sleep /mission", "rate /mission"]),
        ('tf = "base -> tool"', ["transform base → tool"]),
        ('tf = "/base→tool"', ["transform base → tool"]),
        ('topic = "*/goal"\ndirection = "receive"', ["receive */goal", "subscribe */goal"]),
    ],
)
def test_every_name_stands_for_its_forms(text: str, targets: list[str], tmp_path: Path) -> None:
    found = entry(tmp_path, text)
    assert list(found) == targets
    assert [Named.of(target).target for target in targets] == targets


def test_paths_lead_into_the_value_of_a_parameter(tmp_path: Path) -> None:
    text = """parameter = "limits"
    value."[0]" = { kind = "distance", unit = "m" }
    value."[1:4]" = { kind = "position", axis = "xyz", unit = "m" }
    """
    found = entry(tmp_path, text)["parameter limits"].result
    assert [(quantity.name, quantity.axis) for quantity in found] == [
        ("[0]", None),
        ("[1]", "x"),
        ("[2]", "y"),
        ("[3]", "z"),
    ]
    with pytest.raises(ConfigurationError, match="begins with a dot or a bracket"):
        entry(tmp_path, text.replace("[0]", "first"))


def test_the_value_of_a_parameter_is_the_whole_of_it(tmp_path: Path) -> None:
    found = entry(tmp_path, 'parameter = "reach"\nvalue = { kind = "distance", unit = "m" }')
    (quantity,) = found["parameter reach"].result
    assert (quantity.name, str(quantity.path)) == ("value", "")


def test_a_field_may_hold_text_commands(tmp_path: Path) -> None:
    found = entry(
        tmp_path,
        'topic = "/cmd"\ndirection = "publish"\nmessage = "data"\npatterns = [\n'
        '{ text = "lift/{h:g}", kind = "duration", unit = "s", opposite = "drop/{h:g}" },\n'
        f'{{ text = "go", arguments.pose.x = {X} }},\n]',
    )["publish /cmd"]
    lift, go = found.patterns
    assert found.message == "message.data"
    assert (lift.opposite, [argument.name for argument in lift.arguments]) == ("drop/{h:g}", ["h"])
    assert [(argument.name, str(argument.path)) for argument in go.arguments] == [
        ("pose.x", "message.pose.x")
    ]


def test_an_argument_may_decide_about_a_mode_of_a_field(tmp_path: Path) -> None:
    mode = '{ argument = "relative", true = "by", false = "to" }'
    found = entry(
        tmp_path, f'service = "/move"\nrequest.x = {{ kind = "translation", unit = "m", mode = {mode} }}'
    )["call /move"]
    assert [
        [(condition.argument, condition.value) for condition in each.when] for each in found.patterns
    ] == [
        [("request.relative", "true")],
        [("request.relative", "false")],
    ]
    assert [each.arguments[0].mode for each in found.patterns] == [Mode.BY, Mode.TO]


def test_what_a_vocabulary_says_reaches_the_worker(tmp_path: Path) -> None:
    vocabulary = loaded(tmp_path, f"[[operation]]\n{GOAL}fields.x = {X}")
    assert from_data(Vocabulary, to_data(vocabulary)) == vocabulary


def test_two_operations_of_one_site_are_distinguished_by_name() -> None:
    assert with_operation("", "publish /arm/goal") == "publish /arm/goal"
    assert with_operation("", "robot:Arm.move") == "Arm.move"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('topic = "/goal"', ["robot.toml:1", "direction", '"publish" or "receive"']),
        ('topic = "/goal"\ndirection = "publsh"', [":3", "'publsh'", "'publish'"]),
        ('topik = "/goal"\ndirection = "publish"', [":2", "'topik'", "'topic'"]),
        ('transform = "base -> tool"', [":2", "did you mean 'tf'?"]),
        ('topic = "goal"\ndirection = "publish"', [":2", "not resolved", "'/goal'"]),
        ('service = "~home"', ["not resolved", "'*/home'"]),
        ('service = "/go home"', ["no ' ' in it"]),
        ('service = ""', ["is empty"]),
        ('service = "/a"\naction = "/a"', [":3", "either service or action"]),
        ('service = "/a"\ncall = "a:b"', [":2", "either call or service"]),
        ('service = "/a"\ntype = "Trigger"', [":3", "package/Name"]),
        ('service = "/a"\nnode = "mission"', [":3", "'/mission'"]),
        ('service = "/a"\ndirection = "publish"', [":3", "a service has no direction"]),
        (f'service = "/a"\nfields.x = {X}', [":3", "a service has no fields", "request", "response"]),
        (f"{GOAL}request.x = {X}", [":4", "has no request", "fields"]),
        (f"{GOAL}fieldz.x = {X}", [":4", "'fieldz'", "'fields'"]),
        (f'{GOAL}fields."x[" = {X}', [":4", "makes no sense"]),
        (f'{GOAL}fields."[0]" = {X}', [":4", "begin with the name of a field"]),
        (
            f'{GOAL}fields.x = {{ kind = "position", unit = "m" }}',
            ["belongs to what is received, not to what is sent"],
        ),
        ('service = "/a"\nresponse.x = { kind = "output", values = [0, 1] }', ["request, not to response"]),
        (
            'topic = "/a"\ndirection = "receive"\ncommand = true',
            [":4", "has no command; it has direction, fields, node, topic, type"],
        ),
        ('topic = "/a"\ndirection = "receive"\nmessage = "data"', [":4", "has no message", "fields"]),
        (f'{GOAL}patterns = [ {{ text = "up" }} ]', [":4", 'message = "…"']),
        ('tf = "base"', [":2", "no two frames", "base -> tool"]),
        ('service = "/a"\nopposite = "call /b"', [":3", "has no opposite", "patterns"]),
        ('service = "/a"\nrefusals = ["Refused"]', [":3", "no colon"]),
        ('service = "/a"\n[[operation]]\nservice = "/a"\ncommand = false', [":3", "call /a is described"]),
    ],
)
def test_a_wrong_entry_is_refused_with_place_and_remedy(text: str, words: list[str], tmp_path: Path) -> None:
    message = refused(tmp_path, text)
    assert [word for word in words if word not in message] == [], message


@pytest.mark.parametrize("first", ['topic = "/arm/goal"', 'call = "cell:Robot.send"'])
def test_the_examples_of_the_page_load(first: str, tmp_path: Path) -> None:
    texts = [block.text for block in blocks(PAGE.read_text("utf-8"))]
    (example,) = (text for text in texts if text.startswith(f"[[operation]]\n{first}"))
    reading = 'call = "cell:Robot.where"\nresult = { kind = "position", axis = "x", unit = "m" }\n'
    vocabulary = loaded(tmp_path, f"{example}\n[[operation]]\n{reading}")
    assert len(vocabulary.operations) > 1


def test_a_quaternion_of_a_message_has_its_parts_by_name(tmp_path: Path) -> None:
    found = entry(tmp_path, f'{GOAL}fields.pose.orientation = {{ kind = "quaternion" }}')
    (quantity,) = found["publish /arm/goal"].arguments
    assert quantity.order == "xyzw"
