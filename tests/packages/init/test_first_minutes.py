"""``mutabot init`` on toolboxes, wrappers and PLC clients, and on projects that do not run yet."""

from __future__ import annotations

import os
import textwrap
from pathlib import Path
from typing import Any

import pytest

from mutabot.cli.app import project_of
from mutabot.config.vocabulary import load_vocabulary
from mutabot.errors import UsageError
from mutabot_init.guess import NameContext, guess_argument
from mutabot_init.propose import propose
from mutabot_init.words import units_in, words_of
from tests.command import mutabot

TOOLBOX = '''
    import math

    class Pose:
        def __init__(self, x, y): self.parts = (x, y)
        @classmethod
        def shifted(cls, x, y): return cls(x, y)

    class Vector:
        __slots__ = ("_parts",)
        def __init__(self, x, y, z): self._parts = (x, y, z)
        x = property(lambda self: self._parts[0])
        y = property(lambda self: self._parts[1])
        z = property(lambda self: self._parts[2])

    def path(q, goal, t):
        """:param t: time vector or number of steps"""
        return [[a + (b - a) * i / (t - 1) for a, b in zip(q, goal)] for i in range(t)]

    class Gripper:
        def grab(self):
            self.is_open = False
            return True
        def lock(self):
            self.is_locked = True
            return True

    class Arm:
        def fkine(self, q): return [math.sin(angle) for angle in q]
        def move_joint(self, q):
            """Move an arm with 6 degrees of freedom."""
            self.q = q
        def set_velocity(self, linear): self.velocity = linear.y

    class World:
        time = 0.0
        def step(self): self.time += 0.01

    class Camera:
        def grab(self): return [0, 1, 2]
'''
PROGRAM = """
    from toolbox import Pose, Vector, path

    def run(arm, gripper, world, camera):
        camera.grab()
        for q in path([0.0] * 6, [0.5] * 6, 3):
            arm.move_joint(q)
            world.step()
        arm.set_velocity(Vector(0.0, -0.1, 0.0))
        return gripper.grab() and gripper.lock() and Pose.shifted(0.5, 0.25) and arm.fkine([0.5] * 6)
"""
TEST = """
    import program, toolbox
    def test_it():
        arm = toolbox.Arm()
        assert program.run(arm, toolbox.Gripper(), toolbox.World(), toolbox.Camera())
        assert arm.q[0] == 0.5
"""


def write(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        (folder / name).write_text(textwrap.dedent(text))
    return folder


@pytest.fixture(scope="module")
def toolbox(tmp_path_factory: pytest.TempPathFactory) -> Path:
    files = {"toolbox.py": TOOLBOX, "program.py": PROGRAM, "test_program.py": TEST}
    folder = write(tmp_path_factory.mktemp("toolbox"), files)
    propose(folder)
    return folder


def operations(folder: Path) -> dict[str, Any]:
    return {operation.target: operation for operation in load_vocabulary(["robot.toml"], folder).operations}


def test_what_only_makes_or_computes_something_is_no_operation(toolbox: Path) -> None:
    text = (toolbox / "robot.toml").read_text()
    assert {name: name in text for name in ("shifted", "path", "fkine", "move_joint")} == {
        "shifted": False, "path": False, "fkine": False, "move_joint": True,
    }  # fmt: skip


def test_what_takes_hold_of_a_part_is_a_command_though_it_answers(toolbox: Path) -> None:
    found = operations(toolbox)
    assert [found[f"toolbox:Gripper.{name}"].command for name in ("grab", "lock")] == [True, True]
    assert "toolbox:Camera.grab" not in found


def test_what_lets_a_simulation_go_on_is_asked_about_as_its_clock(toolbox: Path) -> None:
    text = (toolbox / "robot.toml").read_text()
    assert "toolbox:World.step" not in operations(toolbox)
    (line,) = [line for line in text.splitlines() if "World.step" in line]
    assert line.startswith('# clock = { tick = "toolbox:World.step"')
    write(toolbox, {"robot.toml": text.replace("# clock", "clock")})
    clock = load_vocabulary(["robot.toml"], toolbox).clock
    assert clock is not None
    assert clock.tick == "toolbox:World.step"


def test_degrees_of_freedom_are_no_unit_of_joints(toolbox: Path) -> None:
    joints = operations(toolbox)["toolbox:Arm.move_joint"].arguments
    assert [joint.unit for joint in joints] == ["rad"] * 6


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("an arm with 6 degrees of freedom", []),
        ("a 7-degree-of-freedom arm", []),
        ("the 6 degrees of Cartesian motion", []),
        ("the angle in degrees of the joint", ["deg"]),
        ("degrees of rotation", ["deg"]),
    ],
)
def test_degrees_are_a_unit_unless_they_are_of_freedom(text: str, expected: list[str]) -> None:
    assert units_in(text, "angle") == expected


@pytest.mark.parametrize(
    ("doc", "is_sure"),
    [
        ("t: time in seconds", True),
        ("t: number of seconds to move", True),
        ("", False),
        ("t: time vector or number of steps", False),
        ("t: number of points", False),
    ],
)
def test_a_number_that_may_count_steps_is_a_question(doc: str, is_sure: bool) -> None:
    found = guess_argument("t", NameContext(words_of("follow"), doc=doc, values=[20]))
    assert (found.table["kind"], found.is_sure) == ("duration", is_sure)


@pytest.mark.parametrize(
    ("call", "name", "expected"),
    [
        ("forward", "metres", {"kind": "translation", "axis": "x", "unit": "m", "mode": "by"}),
        ("drive", "mm", {"kind": "translation", "unit": "mm", "mode": "by"}),
        ("attach", "m", {}),  # a mass, for all that is known
    ],
)
def test_an_argument_named_by_its_unit_is_a_length(call: str, name: str, expected: dict[str, str]) -> None:
    found = guess_argument(name, NameContext(words_of(call), values=[50, 120]))
    assert found.table == expected
    assert found.is_sure or not expected


def test_a_unit_of_pressure_is_taken_from_the_docstring() -> None:
    setting = NameContext(words_of("set_pressure"), doc="Set the level in mbar.", values=[-620])
    assert guess_argument("value", setting).table == {"kind": "pressure", "unit": "mbar"}


def test_a_vector_is_asked_about_by_its_coordinates(toolbox: Path) -> None:
    text = (toolbox / "robot.toml").read_text()
    asked = {axis: f'# arguments."linear.{axis}" = {{ kind = "speed", axis = "{axis}"' for axis in "xyz"}
    assert [axis for axis, line in asked.items() if line not in text] == []
    assert "arguments.linear =" not in text


PLC = """
    class Plc:
        def __init__(self): self.tags = {"Gate": False, "Speed": 0.0}
        def __setitem__(self, tag, value): self.tags[tag] = value
        def write(self, *tags_values): self.tags.update(tags_values)

    class Variable:
        value = 0
        def __init__(self, index): self.index = index
        def __repr__(self): return f"<Variable 0x{self.index:X}>"
        @property
        def raw(self): return self.value
        @raw.setter
        def raw(self, value): self.value = value

    class Drive:
        def __init__(self):
            self.sdo = {index: Variable(index) for index in (0x6040, 0x60FF)}
            self.limits = [0, 0]
        @property
        def ramp(self): return self._ramp
        @ramp.setter
        def ramp(self, value): self._ramp = value
        @property
        def angle(self): return self._angle
        @angle.setter
        def angle(self, value): self._angle = value
        @property
        def lift_height(self): return self._height
        @lift_height.setter
        def lift_height(self, value): self._height = value
        @property
        def speed_rpm(self): return self._speed
        @speed_rpm.setter
        def speed_rpm(self, value): self._speed = value
"""
CELL = """
    def run(plc, drive):
        plc["Gate"] = True
        plc["Gate"] = False
        plc.write(("Gate", True))
        plc.write(("Speed", 0.5))
        drive.sdo[0x6040].raw = 15
        drive.sdo[0x60FF].raw = 1200
        drive.sdo[0x60FF].raw = 0
        drive.limits[0] = 3
        drive.ramp = 2.5
        drive.speed_rpm = 300.0
        drive.angle = 90
        drive.lift_height = 0.25
        drive.note = "ready"
        return drive.speed_rpm
"""
CELL_TEST = """
    import cell, plc
    def test_it():
        drive = plc.Drive()
        assert cell.run(plc.Plc(), drive) == 300
        assert drive.sdo[0x6040].raw == 15
"""


@pytest.fixture(scope="module")
def fieldbus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fieldbus")
    write(folder, {"plc.py": PLC, "cell.py": CELL, "test_cell.py": CELL_TEST})
    propose(folder)
    return folder


def test_writes_to_tags_and_objects_are_messages_with_the_values_seen(fieldbus: Path) -> None:
    found = {
        name: (
            operation.message,
            {pattern.text: [q.values for q in pattern.arguments] for pattern in operation.patterns},
        )
        for name in ("Plc.__setitem__", "Plc.write", "Variable.raw")
        for operation in [operations(fieldbus)[f"plc:{name}"]]
    }
    paths = {name: str(message) for name, (message, _) in found.items()}
    assert paths == {"Plc.__setitem__": "tag", "Plc.write": "tags_values[0][0]", "Variable.raw": "self"}
    assert {name: patterns for name, (_, patterns) in found.items()} == {
        "Plc.__setitem__": {"Gate": [(False, True)]},
        "Plc.write": {"Gate": [(False, True)], "Speed": []},
        "Variable.raw": {"<Variable 0x6040>": [], "<Variable 0x60FF>": [(1200, 0)]},
    }


def test_what_nobody_passes_is_no_part_of_a_message(tmp_path: Path) -> None:
    files = {
        "bus.py": """
            def publish(topic, payload, retain=False): ...
            def write_register(registeraddress, value, signed=False): ...
        """,
        "program.py": """
            import bus
            def run():
                for speed in (0.3, 0.1):
                    bus.publish("cell/speed", speed)
                    bus.write_register(289, speed > 0.2, signed=True)
        """,
        "test_program.py": "import program\ndef test_it(): program.run()\n",
    }
    propose(write(tmp_path, files))
    found = {name.partition(":")[2]: operation for name, operation in operations(tmp_path).items()}
    assert {
        name: [
            (pattern.text, [str(argument.path) for argument in pattern.arguments])
            for pattern in value.patterns
        ]
        for name, value in found.items()
    } == {"publish": [("cell/speed", ["payload"])], "write_register": [("289", ["value"])]}


def test_assignments_to_properties_are_listed(fieldbus: Path) -> None:
    text = (fieldbus / "robot.toml").read_text()
    (speed,) = operations(fieldbus)["plc:Drive.speed_rpm"].arguments
    assert (speed.kind, speed.unit) == ("speed", "rpm")
    (angle,) = operations(fieldbus)["plc:Drive.angle"].arguments
    assert (angle.kind, angle.mode) == ("rotation", "to")
    (height,) = operations(fieldbus)["plc:Drive.lift_height"].arguments
    assert (height.kind, height.axis, height.mode) == ("translation", "z", "to")
    assert '# call = "plc:Drive.ramp"\n# arguments.value  # seen: 2.5' in text
    assert "limits" not in text
    assert "note" not in text


def test_what_puts_a_value_into_a_buffer_is_no_command_and_what_sends_it_is_one(tmp_path: Path) -> None:
    files = {
        "bus.py": """
            import struct
            def set_real(data, index, value): struct.pack_into(">f", data, index, value)
            def send(data): sent.append(bytes(data))
            class Plc:
                def set_block(self, data): sent.append(bytes(data))
            sent = []
        """,
        "program.py": """
            import bus
            def run(plc):
                data = bytearray(4)
                bus.set_real(data, 0, 12.5)
                bus.send(data)
                plc.set_block(data)
        """,
        "test_program.py": "import bus, program\ndef test_it(): program.run(bus.Plc())\n",
    }
    propose(write(tmp_path, files))
    assert {"bus:set_real", "bus:send", "bus:Plc.set_block"} & operations(tmp_path).keys() == {
        "bus:send", "bus:Plc.set_block",
    }  # fmt: skip


@pytest.mark.parametrize(("name", "is_moved"), [("set_digital_output", False), ("move_to", True)])
def test_the_number_of_an_output_is_no_coordinate(name: str, is_moved: bool) -> None:
    found = guess_argument("x", NameContext(words_of(name), values=[1], names=frozenset({"x"})))
    assert bool(found.table) is is_moved


def test_what_ends_or_begins_something_is_a_command(tmp_path: Path) -> None:
    names = ("start", "halt", "deactivate", "shake", "hold", "muse")
    methods = "".join(f"    def {name}(self): self.last = 1\n" for name in names)
    calls = ", ".join(f"pump.{name}()" for name in names)
    files = {
        "pump.py": f"class Pump:\n{methods}",
        "program.py": f"def run(pump): {calls}\n",
        "test_program.py": "import program, pump\ndef test_it(): program.run(pump.Pump())\n",
    }
    propose(write(tmp_path, files))
    found = {name for name in names if f"pump:Pump.{name}" in operations(tmp_path)}
    assert found == {*names} - {"muse"}


def test_check_reaches_every_write_that_is_drafted(fieldbus: Path) -> None:
    done = mutabot(fieldbus, "check")
    assert done.returncode == 0, done.stderr
    assert "sites     10 reached" in done.stdout


def test_an_inertia_is_no_mass(tmp_path: Path) -> None:
    files = {
        "robot.py": "class Arm:\n    def set_payload(self, weight, inertia): self.it = weight, inertia\n",
        "program.py": "def run(arm): arm.set_payload(0.5, 0.01)\n",
        "test_program.py": "import program, robot\ndef test_it(): program.run(robot.Arm())\n",
    }
    write(tmp_path, files)
    propose(tmp_path)
    lines = (tmp_path / "robot.toml").read_text().splitlines()
    weight, inertia = (
        [line for line in lines if f"arguments.{name}" in line] for name in ("weight", "inertia")
    )
    assert [["mass" in line for line in found] for found in (weight, inertia)] == [[True], [False]]


def test_a_program_that_only_computes_is_said_to_call_no_robot(tmp_path: Path) -> None:
    files = {
        "sums.py": "def doubled(numbers): return [2 * one for one in numbers]\n",
        "program.py": "import sums\ndef run(): return sums.doubled([1, 2])\n",
        "test_program.py": "import program\ndef test_it(): assert program.run() == [2, 4]\n",
    }
    write(tmp_path, files)
    done = mutabot(tmp_path, "init", "program.py")
    assert done.returncode == 0, done.stderr
    assert "none of these calls looks like one of a robot or a device" in done.stdout
    assert "run tests that call the program" not in done.stdout


def test_where_no_test_could_run_the_next_step_is_to_make_them_run(tmp_path: Path) -> None:
    """The guess may be right: that no test called it says nothing where none ran."""
    files = {
        "robot.py": "class Arm:\n    def move(self, metres): self.x = metres\n",
        "program.py": "import robot\ndef run(): robot.Arm().move(0.5)\n",
        "test_program.py": "import robot, program\nrobot.Arm().move(0.1)\nimport missing_one\n",
    }
    write(tmp_path, files)
    done = mutabot(tmp_path, "init")
    assert "the tests could not be watched: test_program.py: ModuleNotFoundError" in done.stdout, done.stderr
    assert "run tests that call the program" in done.stdout
    assert "no test runs a call of the guessed program" not in done.stdout


def test_what_pytests_own_configuration_names_is_watched_and_not_written_down(tmp_path: Path) -> None:
    """A doctest of the program is a test as well; the files of tests alone would never show it."""
    files = {
        "pytest.ini": "[pytest]\ntestpaths = program.py test_it.py\naddopts = --doctest-modules\n",
        "robot.py": "class Arm:\n    def move(self, metres): self.x = metres\n",
        "program.py": "import robot\ndef run():\n    '>>> run()'\n    robot.Arm().move(0.5)\n",
        "test_it.py": "def test_it(): pass\n",
    }
    write(tmp_path, files)
    done = mutabot(tmp_path, "init")
    assert "tests: 2 passed; the program calls 1 callable" in done.stdout, done.stderr
    assert "tests =" not in (tmp_path / "mutabot.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("broken", ["robot", "program", "test_program"])
def test_a_file_that_is_no_python_is_named_and_nothing_is_written(tmp_path: Path, broken: str) -> None:
    files = {
        "robot.py": "def go(): pass\n",
        "program.py": "import robot\ndef run(): robot.go()\n",
        "test_program.py": "import program\ndef test_it(): program.run()\n",
    }
    write(tmp_path, files | {f"{broken}.py": "x = 1\ndef wrong(:\n"})
    done = mutabot(tmp_path, "init", "program.py")
    assert done.returncode == 2
    assert f"mutabot: {broken}.py:2: " in done.stderr
    assert not list(tmp_path.glob("*.toml"))


def test_a_folder_of_a_project_finds_the_project_above(tmp_path: Path) -> None:
    files = {
        "pyproject.toml": "",
        "robot.py": "def go(): pass\n",
        "program.py": "import robot\ndef run(): robot.go()\n",
        "test_program.py": "import program\ndef test_it(): program.run()\n",
    }
    below = write(tmp_path, files) / "notes" / "old"
    below.mkdir(parents=True)
    told: list[str] = []
    propose(below, notify=told.append)
    assert told[0] == f"project: {tmp_path}"
    assert (tmp_path / "mutabot.toml").exists()
    assert project_of(below) == Path("..", "..")
    with pytest.raises(UsageError, match="exists already"):
        propose(below)


@pytest.mark.parametrize("marker", ["mutabot.toml", ".mutabot", "pyproject.toml"])
def test_commands_find_the_nearest_project(tmp_path: Path, marker: str) -> None:
    folder = tmp_path / "here" / "below"
    folder.mkdir(parents=True)
    assert project_of(folder) == Path(os.curdir)
    (tmp_path / "pyproject.toml").write_text("[tool.mutabot]\n")
    (tmp_path / "here" / marker).write_text("[tool.mutabot.cluster]\n")
    assert project_of(folder) == Path("..")


def test_what_is_true_of_many_operations_is_noted_once(tmp_path: Path) -> None:
    names = ("alpha", "beta", "gamma")
    files = {
        "robot.py": "".join(f"def {name}(): pass\n" for name in names),
        "program.py": "import robot\ndef run():\n" + "".join(f"    robot.{name}()\n" for name in names),
        "test_program.py": "import program\ndef test_it(): program.run()\n",
    }
    propose(write(tmp_path, files))
    text = (tmp_path / "robot.toml").read_text()
    assert text.count("command = true") == 3
    assert text.count("it is left out and made twice") == 1
