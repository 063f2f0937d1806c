"""Arguments and results in all their forms; the user's objects are never changed."""

from __future__ import annotations

from typing import Any

import pytest

from tests.runtime.stage import Make

X = '{ kind = "translation", axis = "x", unit = "m", mode = "by" }'
READ_X = '{ kind = "position", axis = "x", unit = "m", noise = 0.5 }'


@pytest.mark.parametrize(
    ("signature", "arguments", "key", "expected"),
    [
        ("x, y=0", "1.0", "x", (-1.0, 0)),
        ("y, x=2.0", "5", "x", (5, -2.0)),
        ("*, x, y=0", "x=1.0", "x", (-1.0, 0)),
        ("x, /, y=0", "1.0", "x", (-1.0, 0)),
        ("y, *x", "0, 1.0, 3.0", '"x[1]"', (0, 1.0, -3.0)),
        ("**x", "a=1.0", "\"x['a']\"", {"a": -1.0}),
        ("**rest", "x=1.0, b=2.0", "x", {"x": -1.0, "b": 2.0}),
        ("x", "[1.0, 2.0]", '"x[0]"', ([-1.0, 2.0],)),
        ("x", "(1.0, 2.0)", '"x[1]"', ((1.0, -2.0),)),
        ("x", "{'to': {'x': 1.0}}", "\"x['to']['x']\"", ({"to": {"x": -1.0}},)),
    ],
)
def test_a_written_value_is_found_and_replaced(
    make_stage: Make, signature: str, arguments: str, key: str, expected: Any
) -> None:
    robot = f"def move({signature}):\n    seen.append(locals())\n\nseen = []\n"
    program = f"import robot\n\ndef run():\n    robot.move({arguments})\n    return robot.seen[-1]\n"
    stage = make_stage(robot, program, f'[[operation]]\ncall = "robot:move"\narguments.{key} = {X}\n')
    result, activation = stage.mutated("reverse", key.strip('"'))
    assert activation.activity.acted == 1
    assert expected in (_flat(result), next(iter(result.values())))


def _flat(seen: dict[str, Any]) -> tuple[Any, ...]:
    found: list[Any] = []
    for name, value in seen.items():
        found.extend(value) if name == "x" and isinstance(value, tuple) and len(seen) > 1 else found.append(
            value
        )
    return tuple(found)


RESULTS = """
    from dataclasses import dataclass, field
    from typing import NamedTuple
    import numpy

    class Point(NamedTuple):
        x: float
        y: float

    @dataclass(frozen=True)
    class Pose:
        x: float
        label: str = "a"

    @dataclass(slots=True, frozen=True)
    class Slotted:
        pose: Pose

    class Plain:
        def __init__(self):
            self.x = 1.5

    KEPT = {
        "scalar": 1.5, "tuple": (1.5, 2), "list": [1.5, 2], "dict": {"x": 1.5}, "named": Point(1.5, 2.0),
        "frozen": Pose(1.5), "nested": Slotted(Pose(1.5)), "plain": Plain(), "array": numpy.array([1.5, 2.0]),
        "ints": numpy.array([3, 4]), "numpy": numpy.float32(1.5), "int": 3,
    }

    def read(kind):
        return KEPT[kind]
"""


@pytest.mark.parametrize(
    ("kind", "path", "get"),
    [
        ("scalar", "", lambda r: r),
        ("numpy", "", lambda r: r),
        ("int", "", lambda r: r),
        ("tuple", "[0]", lambda r: r[0]),
        ("list", "[0]", lambda r: r[0]),
        ("dict", "['x']", lambda r: r["x"]),
        ("named", ".x", lambda r: r.x),
        ("named", "[0]", lambda r: r.x),
        ("frozen", ".x", lambda r: r.x),
        ("nested", ".pose.x", lambda r: r.pose.x),
        ("plain", ".x", lambda r: r.x),
        ("array", "[0]", lambda r: r[0]),
        ("ints", "[0]", lambda r: r[0]),
    ],
)
def test_a_mutated_reading_is_a_copy_of_the_same_type(
    make_stage: Make, kind: str, path: str, get: Any
) -> None:
    program = f"import robot\n\ndef run():\n    return robot.read({kind!r}), robot.KEPT[{kind!r}]\n"
    result = f"result = {READ_X}" if not path else f'result."{path}" = {READ_X}'
    stage = make_stage(RESULTS, program, f'[[operation]]\ncall = "robot:read"\n{result}\n')
    (mutated, original), activation = stage.mutated("negate", path or "result")
    value = get(original)
    assert value > 0, "the original object must not be changed"
    assert get(mutated) == -value
    assert type(mutated) is type(original)
    assert type(get(mutated)) is type(value)
    assert activation.activity.example == (value, -value)


def test_a_call_that_fits_no_signature_fails_as_it_would_without_mutabot(make_stage: Make) -> None:
    stage = make_stage(
        "def move(x):\n    pass\n",
        "import robot\n\ndef run():\n    robot.move()\n",
        f'[[operation]]\ncall = "robot:move"\narguments.x = {X}\n',
    )
    with pytest.raises(TypeError, match="missing 1 required positional argument"):
        stage.run(stage.session())


def test_exceptions_of_the_robot_pass_through_unchanged(make_stage: Make) -> None:
    robot = "class Stop(StopIteration):\n    pass\n\ndef move(x):\n    raise Stop(x)\n"
    program = """
        import robot

        def run():
            try:
                robot.move(1.0)
            except robot.Stop as stop:
                return stop.args
    """
    stage = make_stage(robot, program, f'[[operation]]\ncall = "robot:move"\narguments.x = {X}\n')
    assert stage.run(stage.session()) == (1.0,)
    assert stage.mutated("reverse", "x")[0] == (-1.0,)


def test_a_missing_part_of_a_reading_is_left_alone(make_stage: Make) -> None:
    stage = make_stage(
        "def read():\n    return None\n",
        "import robot\n\ndef run():\n    return robot.read()\n",
        f'[[operation]]\ncall = "robot:read"\nresult = {READ_X}\n',
    )
    result, activation = stage.mutated("negate", "result")
    assert result is None
    assert (activation.activity.hits, activation.activity.acted) == (1, 0)


GRIPPER = """
    LOG = []

    class Gripper:
        def open(self): LOG.append("open"); return True
        def close(self): LOG.append("close"); return True
"""
GRIP = """
    [[operation]]
    call = "robot:Gripper.close"
    opposite = "robot:Gripper.open"
    [[operation]]
    call = "robot:Gripper.open"
    opposite = "robot:Gripper.close"
"""
USE = (
    "import robot\n\ndef run():\n    robot.LOG.clear()\n    return robot.Gripper().close(), list(robot.LOG)\n"
)


@pytest.mark.parametrize(
    ("operator", "idle", "expected"),
    [
        ("opposite", None, (True, ["open"])),
        ("repeat", None, (True, ["close", "close"])),
        ("skip", True, (True, [])),
        ("skip", None, (None, [])),
        ("skip", {"answers": [{"tuple": [1, 2]}]}, ((1, 2), [])),
    ],
)
def test_commands_are_left_out_repeated_and_turned_round(
    make_stage: Make, operator: str, idle: Any, expected: Any
) -> None:
    stage = make_stage(GRIPPER, USE, GRIP)
    assert stage.mutated(operator, idle=idle)[0] == expected


ARM = """
    class Arm:
        def __init__(self): self.x = 250.0; self.moves = []
        def tool(self): return {"x": self.x}
        def move_by(self, dx): self.moves.append(dx)
        def move_to(self, x): self.moves.append(x)
"""


@pytest.mark.parametrize(
    ("call", "expected"), [("move_by(0.5)", [0.25]), ("move_to(x=0.5)", [0.75])], ids=["by to to", "to to by"]
)
def test_by_to_reads_where_the_robot_is_in_the_units_of_both(
    make_stage: Make, call: str, expected: Any
) -> None:
    vocabulary = """
        [[operation]]
        call = "robot:Arm.move_by"
        current = "robot:Arm.tool"
        arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
        [[operation]]
        call = "robot:Arm.move_to"
        current = "robot:Arm.tool"
        arguments.x = { kind = "translation", axis = "x", unit = "m", mode = "to" }
        [[operation]]
        call = "robot:Arm.tool"
        result."['x']" = { kind = "position", axis = "x", unit = "mm" }
    """
    program = f"import robot\n\ndef run():\n    arm = robot.Arm()\n    arm.{call}\n    return arm.moves\n"
    stage = make_stage(ARM, program, vocabulary)
    result, activation = stage.mutated("by-to", "dx" if "by" in call else "x")
    assert result == expected
    assert len(activation.activity.example or ()) == 2


SEND = """
    [[operation]]
    call = "robot:send"
    message = "text"
    patterns = [
      { text = "lift/{height:g}", opposite = "drop/{height:g}", arguments.height = HEIGHT },
      { text = "drop/{height:g}", opposite = "lift/{height:g}", arguments.height = HEIGHT },
      { text = "pick" },
      { text = "weight", result = { kind = "distance", unit = "mm" } },
    ]
""".replace("HEIGHT", '{ kind = "translation", axis = "z", unit = "cm", mode = "by" }')


@pytest.mark.parametrize(
    ("sent", "operator", "quantity", "received"),
    [
        ("'lift/5'", "reverse", "height", ["lift/-5"]),
        ("'lift/5.00'", "reverse", "height", ["lift/-5.00"]),
        ("'lift/5'", "opposite", None, ["drop/5"]),
        ("'lift/5.00'", "opposite", None, ["drop/5.00"]),
        ("'pick'", "skip", None, []),
        ("'pick'", "repeat", None, ["pick", "pick"]),
        ("b'lift/5\\n'", "reverse", "height", [b"lift/-5\n"]),
        ("'weight'", "negate", "result", ["weight"]),
    ],
)
def test_text_commands_are_mutated_in_their_own_notation(
    make_stage: Make, sent: str, operator: str, quantity: str | None, received: Any
) -> None:
    robot = "LOG = []\n\ndef send(text):\n    LOG.append(text)\n    return 12.0\n"
    program = f"""
        import robot

        def run():
            robot.LOG.clear()
            robot.last = robot.send({sent})
            return list(robot.LOG)
    """
    stage = make_stage(robot, program, SEND)
    assert stage.mutated(operator, quantity)[0] == received
    if operator == "negate":
        assert stage.load_robot().last == -12.0


def test_a_skipped_text_command_answers_as_that_command_did(make_stage: Make) -> None:
    """Not as the command before it, which the program would take for nonsense."""
    robot = "def send(text):\n    return {'pick': 'ok', 'weight': 12.0}[text]\n"
    program = """
        import robot

        def run():
            robot.send("weight")
            return robot.send("pick")
    """
    stage = make_stage(robot, program, SEND)
    assert stage.mutated("skip", index=1, idle="ok")[0] == "ok"


def test_keyword_only_defaults_are_intercepted_too(make_stage: Make) -> None:
    robot = "def move(x):\n    return x\n"
    program = "import robot\n\ndef run(*, go=robot.move):\n    return go(1.0)\n"
    stage = make_stage(robot, program, f'[[operation]]\ncall = "robot:move"\narguments.x = {X}\n')
    assert stage.mutated("reverse", "x")[0] == -1.0
