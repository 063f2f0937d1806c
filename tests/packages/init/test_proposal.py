"""``mutabot init``: guesses that an engineer would make, a vocabulary that loads, nothing overwritten."""

from __future__ import annotations

import subprocess
import textwrap
import tomllib
import venv
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import mutabot_init.propose
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot.errors import UsageError
from mutabot.model import Kind, Mode
from mutabot_init.guess import NameContext, guess_argument, guess_elements, guess_reading
from mutabot_init.observations import WatchedPart
from mutabot_init.propose import propose
from mutabot_init.words import words_of
from tests.command import mutabot

ROBOT = '''
from dataclasses import dataclass
import errors

@dataclass
class Pose:
    """In mm and degrees."""
    x: float
    y: float
    yaw: float

class Base:
    def home(self): ...

class Arm(Base):
    def move_by(self, dx=0.0, dy=0.0, yaw_deg=0.0, speed=0.5):
        """Relative move, m."""
        if dx > 1: raise errors.OutOfReach(dx)
    def go_to(self, target: Pose): ...
    def pose(self) -> Pose: return Pose(1.0, 2.0, 3.0)
    @property
    def distance_mm(self) -> float: return 4.0
    def _private(self, x): ...

class Gripper:
    def command(self, position): ...
    def open(self): ...
    def close(self): ...

class Conveyor:
    def set_output(self, on: bool): ...

class Camera:
    def colour(self) -> str: return "red"
    def locate(self) -> tuple[float, float, float]:
        """Position, m."""
        return 0.1, 0.2, 0.3

def wait(seconds): ...
def connect() -> Arm: return Arm()
def log(text): ...
'''
MISSION = """
import time
import robot
from robot import Gripper, wait as pause, Arm
from constants import CLOSED

OPEN = 0

class Mission:
    def __init__(self, camera: robot.Camera):
        self.arm = robot.connect()
        self.camera = camera

    def run(self, conveyor):
        gripper = Gripper()
        gripper.command(OPEN)
        gripper.command(CLOSED)
        gripper.open()
        gripper.close()
        self.arm.home()
        self.arm.move_by(0.1, yaw_deg=90)
        self.arm.go_to(robot.Pose(10.0, 20.0, 30.0))
        self.arm._private(1)
        pause(1.5)
        conveyor.set_output(True)
        colour = self.camera.colour()
        if colour == "red" or colour in ("blue", "green"):
            self.arm.move_by(dy=-0.1)
        robot.log("done")
        time.sleep(0)
        return self.arm.distance_mm, self.camera.locate()

    def never(self):
        self.arm.turn_by(5)
"""
SENSORS = """
import robot

def where(arm: robot.Arm):
    return arm.pose()
"""
TEST = """
import mission, sensors, robot
def test_it():
    m = mission.Mission(robot.Camera())
    m.run(robot.Conveyor())
    assert sensors.where(m.arm).x == 1.0
"""


FILES = {
    "robot.py": ROBOT,
    "errors.py": "class OutOfReach(Exception): ...\n",
    "constants.py": "CLOSED = 1\n",
    "mission.py": MISSION,
    "tests/sensors.py": SENSORS,
    "tests/test_mission.py": TEST,
}


def write(folder: Path, files: Mapping[str, str]) -> Path:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(exist_ok=True, parents=True)
        path.write_text(textwrap.dedent(text))
    return folder


def operations(project: Path) -> dict[str, Any]:
    return {operation.target: operation for operation in load_vocabulary(["robot.toml"], project).operations}


@pytest.fixture
def project(tmp_path: Path) -> Path:
    return write(tmp_path, FILES)


@pytest.fixture(scope="module")
def proposed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A project with its proposal, and what was told."""
    folder = write(tmp_path_factory.mktemp("project"), FILES)
    return folder, "\n".join(propose(folder))


def test_the_proposal_loads_and_names_program_oracle_and_tests(proposed: tuple[Path, str]) -> None:
    configuration = load_configuration(proposed[0])
    assert configuration.program == ("mission.py",)
    assert configuration.oracle == ("tests/sensors.py",)
    assert configuration.tests == ("tests",)
    assert configuration.vocabulary == ("robot.toml",)
    assert operations(proposed[0])


def test_what_a_vocabulary_would_not_take_is_a_comment(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    module, line = mutabot_init.propose, 'call = "robot:Base.home"'
    loads = module._loads
    monkeypatch.setattr(module, "_loads", lambda text: line not in text.splitlines() and loads(text))
    told = "\n".join(propose(project))
    assert "with 11 operations and 1 question" in told
    assert len(operations(project)) == 11
    assert f"# {line}" in (project / "robot.toml").read_text(encoding="utf-8").splitlines()


def test_every_way_to_reach_an_operation_is_followed(proposed: tuple[Path, str]) -> None:
    assert set(operations(proposed[0])) == {
        "robot:Base.home",  # inherited
        "robot:Arm.move_by",  # on what a function returns
        "robot:Arm.go_to",
        "robot:Arm.pose",  # only the tests read it
        "robot:Arm.distance_mm",  # a property
        "robot:Gripper.command",  # a class imported by name
        "robot:Gripper.open",
        "robot:Gripper.close",
        "robot:wait",  # imported under another name
        "robot:Conveyor.set_output",
        "robot:Camera.colour",  # kept in self
        "robot:Camera.locate",
    }


def test_arguments_get_kind_axis_unit_and_mode_from_their_names(proposed: tuple[Path, str]) -> None:
    move = operations(proposed[0])["robot:Arm.move_by"]
    found = {
        argument.name: (argument.kind, argument.axis, argument.unit, argument.mode)
        for argument in move.arguments
    }
    assert found == {
        "dx": (Kind.TRANSLATION, "x", "m", Mode.BY),
        "dy": (Kind.TRANSLATION, "y", "m", Mode.BY),
        "yaw_deg": (Kind.ROTATION, "z", "deg", Mode.BY),
    }
    assert move.refusals == ("errors:OutOfReach",)


def test_fields_of_an_argument_are_absolute_targets(proposed: tuple[Path, str]) -> None:
    found = operations(proposed[0])["robot:Arm.go_to"].arguments
    assert {(quantity.name, quantity.unit, quantity.mode) for quantity in found} == {
        ("target.x", "mm", Mode.TO),
        ("target.y", "mm", Mode.TO),
        ("target.yaw", "deg", Mode.TO),
    }


def test_results_are_read_from_values_and_names(proposed: tuple[Path, str]) -> None:
    found = operations(proposed[0])
    assert {(quantity.name, quantity.kind, quantity.unit) for quantity in found["robot:Arm.pose"].result} == {
        (".x", Kind.POSITION, "mm"),
        (".y", Kind.POSITION, "mm"),
        (".yaw", Kind.ORIENTATION, "deg"),
    }
    assert [(quantity.kind, quantity.unit) for quantity in found["robot:Arm.distance_mm"].result] == [
        (Kind.DISTANCE, "mm")
    ]
    assert [(quantity.name, quantity.axis) for quantity in found["robot:Camera.locate"].result] == [
        ("[0]", "x"),
        ("[1]", "y"),
        ("[2]", "z"),
    ]


def test_values_come_from_what_the_program_sends_and_compares_with(proposed: tuple[Path, str]) -> None:
    found = operations(proposed[0])
    assert found["robot:Gripper.command"].arguments[0].values == (0, 1)
    assert found["robot:Camera.colour"].result[0].values == ("red", "blue", "green")
    assert found["robot:Conveyor.set_output"].arguments[0].values == (False, True)
    assert found["robot:Gripper.open"].opposite == "robot:Gripper.close"


def test_lines_show_values_that_were_seen_and_what_is_unsure_is_a_question(
    proposed: tuple[Path, str],
) -> None:
    text = (proposed[0] / "robot.toml").read_text()
    assert "[[operation]]  # seen: 2 calls, first at mission.py:21" in text
    assert "seen: 0.1, 0" in text
    speed = 'arguments.speed = { kind = "speed", unit = "m/s" }  # question: the unit: m/s, cm/s, mm/s'
    assert f"# {speed}" in text
    assert '# call = "robot:log"\n# arguments.text  # seen: "done"' in text  # named, but not proposed
    assert "with 12 operations and 1 question" in proposed[1]


def test_a_reading_without_arguments_stands_as_the_probe_to_take(proposed: tuple[Path, str]) -> None:
    lines = (proposed[0] / "robot.toml").read_text().splitlines()
    at = lines.index("# [[probe]]")
    own = "\n".join(line.removeprefix("# ") for line in lines[at:])
    (probe,) = tomllib.loads(own)["probe"]
    assert probe["call"] in operations(proposed[0])


def test_what_was_run_and_what_comes_next_is_reported(proposed: tuple[Path, str]) -> None:
    assert "mission.py (guessed" in proposed[1]
    assert "tests: 1 passed" in proposed[1]
    assert "mutabot check" in proposed[1].splitlines()[-1]


def test_check_accepts_the_proposal_as_it_is(proposed: tuple[Path, str]) -> None:
    done = mutabot(proposed[0], "check")
    assert done.returncode == 0, done.stderr
    assert "sites     14 reached" in done.stdout  # every call of the program and the oracle that was seen


def test_text_commands_become_patterns(tmp_path: Path) -> None:
    write(
        tmp_path,
        {
            "link.py": "def send(text): ...\ndef read(name): return 'red'\n",
            "sorter.py": """
                import link
                def run(h):
                    link.send('pick'); link.send('lift/5'); link.send('lift/7')
                    link.send(f'drop/{h}'); link.send('turn/90.5'); link.send('release')
                    return link.read('color') in ('red', 'blue')
            """,
            "test_sorter.py": "import sorter\ndef test_it(): sorter.run(3)\n",
        },
    )
    propose(tmp_path)
    assert load_configuration(tmp_path).tests == ("test_sorter.py",)
    found = operations(tmp_path)
    patterns = {pattern.text: pattern for pattern in found["link:send"].patterns}
    assert set(patterns) == {"pick", "release", "lift/{height:g}", "drop/{height:g}", "turn/{angle:g}"}
    assert patterns["pick"].opposite == "release"
    assert patterns["lift/{height:g}"].opposite == "drop/{height:g}"
    turn = patterns["turn/{angle:g}"].arguments[0]
    assert (turn.axis, turn.unit, turn.mode) == (None, "deg", Mode.BY)
    asked = '{ kind = "translation", axis = "z", unit = "m", mode = "by" }'
    assert f"# question: the unit: m, cm, mm? {asked}" in (tmp_path / "robot.toml").read_text()
    assert not found["link:read"].command
    assert [quantity.values for quantity in found["link:read"].patterns[0].result] == [("red", "blue")]


VENDOR = """
    import functools, asyncio

    class Robot:
        def __init__(self): self.pose = [0.3, -0.2, 0.4, 0.0, 3.14159, 0.0]; self.done = []
        def movej(self, joints, acc=0.1, vel=0.05, wait=True, relative=False): self.done.append("movej")
        def movel(self, tpose, acc=0.01, vel=0.01): self.pose = list(tpose); return self.pose
        def speedl(self, velocities, acc, min_time): ...
        def getl(self): return list(self.pose)
        def get_pose(self): return tuple(self.pose)
        def set_digital_out(self, output, val): return True
        def set_tcp(self, tcp): ...
        def goto(self, x, y, theta): return 0
        def dock(self): return True
        def set_gripper_mm(self, *, width): ...
        @staticmethod
        def beep(): ...

    class Space:
        low, high = [-1.0, -1.0], [1.0, 1.0]

    class Env:
        action_space = Space()
        def step(self, action): return [0.1, 0.2], 1.0, False, False, {"success": 0.0}

    class Client:
        async def write(self, node, value): ...
        async def read(self, node): return 12.5
        def close_later(self): return self.write("a", 1)

    def unnamed(function):
        def anything(*args, **kwargs): return function(*args, **kwargs)
        return anything

    @unnamed
    def clamp(position): return position

    def stop(): return True
"""
CELL = """
    import asyncio, math, vendor
    from datetime import datetime

    class Tuned(vendor.Robot):
        def dock(self): return super().dock()

    def run(robot, env):
        robot.movej([0.0, -1.57, 1.57, 0.0, 0.5, 0.25], acc=0.2)
        robot.movel([0.4, 0.1, 0.2, 0.0, 3.1, 0.0])
        robot.speedl([0.0, 0.0, -0.1, 0, 0, 0], 0.5, 1)
        robot.set_digital_out(3, True)
        robot.set_tcp((0, 0, 0.12, 0, 0, 0))
        robot.goto(1200.0, 300.0, 45)
        robot.dock(); robot.beep()
        robot.set_gripper_mm(width=40)
        vendor.clamp(0.5)
        vendor.stop()
        env.step([0.5, -1.0])
        asyncio.run(talk())
        datetime.now().isoformat()
        return robot.getl(), robot.get_pose()

    async def talk():
        client = vendor.Client()
        await client.write("belt", 0.5)
        await client.write("belt", 1.5)
        assert await client.read("weight") == 12.5
        await client.close_later()
"""


@pytest.fixture(scope="module")
def vendor(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A program in the names that vendors use, with its tests and program in packages of their own."""
    test = "import vendor\nfrom work.cell import Tuned, run\ndef test_it(): run(Tuned(), vendor.Env())\n"
    files = {
        "src/vendor.py": VENDOR,
        "src/work/__init__.py": "",
        "src/work/cell.py": CELL,
        "tests/unit/test_cell.py": test,
        "pytest.ini": "[pytest]\npythonpath = src\n",
    }
    folder = write(tmp_path_factory.mktemp("vendor"), files)
    propose(folder)
    return folder


def test_a_program_below_src_is_found(vendor: Path) -> None:
    configuration = load_configuration(vendor)
    assert configuration.program == ("src/work/cell.py",)
    assert configuration.tests == ("tests",)


@pytest.mark.parametrize(
    ("target", "expected"),
    [
        ("Robot.movej", [(f"joints[{n}]", Kind.ROTATION, f"j{n + 1}", "rad", Mode.TO) for n in range(6)]),
        (
            "Robot.movel",
            [(f"tpose[{n}]", Kind.TRANSLATION, "xyz"[n], "m", Mode.TO) for n in range(3)],
        ),
        ("Robot.speedl", [("min_time", Kind.DURATION, None, "s", None)]),
        ("Robot.set_digital_out", [("val", Kind.OUTPUT, None, None, None)]),
        ("Robot.dock", []),
        (
            "Robot.goto",
            [
                ("x", Kind.TRANSLATION, "x", "mm", Mode.TO),
                ("y", Kind.TRANSLATION, "y", "mm", Mode.TO),
                ("theta", Kind.ROTATION, None, "deg", Mode.TO),
            ],
        ),
        ("Robot.set_gripper_mm", []),
        ("Env.step", [(f"action[{n}]", Kind.OUTPUT, None, None, None) for n in range(2)]),
        ("stop", []),
    ],
)
def test_the_names_that_vendors_use_are_understood(vendor: Path, target: str, expected: list[Any]) -> None:
    operation = operations(vendor)[f"vendor:{target}"]
    found = [
        (argument.name, argument.kind, argument.axis, argument.unit, argument.mode)
        for argument in operation.arguments
    ]
    assert found == expected
    assert operation.command


@pytest.mark.parametrize("target", ["getl", "get_pose"])
def test_a_pose_that_is_read_is_understood(vendor: Path, target: str) -> None:
    found = operations(vendor)[f"vendor:Robot.{target}"]
    assert not found.command
    assert [(quantity.kind, quantity.axis, quantity.unit) for quantity in found.result] == [
        (Kind.POSITION, axis, "m") for axis in "xyz"
    ]


def test_what_cannot_be_described_is_a_comment_with_its_reason(vendor: Path) -> None:
    text = (vendor / "robot.toml").read_text()
    assert '# call = "vendor:Client.close_later"' in text
    assert "it returns a coroutine but is not a coroutine function" in text
    assert '# arguments."velocities[0:6]" = { kind = "speed", unit = "…" }  # question: the unit' in text
    assert (
        '# arguments."tpose[3:6]" = { kind = "rotation_vector", unit = "rad" }  # question: a rotation'
        in text
    )
    assert "isoformat" not in text  # of the standard library


def test_check_accepts_what_was_proposed_for_a_vendor(vendor: Path) -> None:
    done = mutabot(vendor, "check")
    assert done.returncode == 0, done.stderr
    assert "1 pass" in done.stdout


def test_what_nothing_is_known_about_can_still_be_checked(tmp_path: Path) -> None:
    write(
        tmp_path,
        {
            "things.py": "class Thing:\n    def frobnicate(self, what): return object()\n",
            "program.py": "import things\ndef run(): things.Thing().frobnicate({'a': 1})\n",
            "tests/test_it.py": "import program\ndef test_it(): program.run()\n",
        },
    )
    propose(tmp_path)
    assert operations(tmp_path)["things:Thing.frobnicate"].command
    assert '# arguments."what[\\"a\\"]"  # seen: 1' in (tmp_path / "robot.toml").read_text()
    assert mutabot(tmp_path, "check").returncode == 0


def test_a_program_that_holds_its_robot_is_understood(tmp_path: Path) -> None:
    write(
        tmp_path,
        {
            "cell.py": "class Arm:\n    def move_to(self, x): self.x = x\ndef run(arm): arm.move_to(0.5)\n",
            "test_cell.py": "import cell\ndef test_it(): cell.run(cell.Arm())\n",
        },
    )
    propose(tmp_path)
    assert set(operations(tmp_path)) == {"cell:Arm.move_to"}


def test_a_robot_that_only_the_tests_know_is_found_by_its_methods(tmp_path: Path) -> None:
    write(
        tmp_path,
        {
            "task.py": "def run(arm): arm.move_to(x=0.5)\n",
            "tests/fakes.py": """
                class Arm:
                    def move_to(self, x): self.x = x
                    def where(self): return self.x
            """,
            "tests/test_task.py": """
                import fakes, task
                def test_it():
                    arm = fakes.Arm()
                    task.run(arm)
                    assert arm.where()
            """,
        },
    )
    propose(tmp_path)
    assert set(operations(tmp_path)) == {"*:*.move_to"}


def test_values_come_from_the_program_where_the_tests_call_the_same(tmp_path: Path) -> None:
    test = """
        import link, program, pytest
        @pytest.mark.parametrize("text", ["nonsense", "lift/", "PICK", "lift five"])
        def test_it(text):
            link.send(text)
            program.run()
    """
    files = {
        "link.py": "def send(text): ...\n",
        "program.py": "import link\ndef run(): link.send('lift/5')\n",
        "tests/test_it.py": test,
    }
    propose(write(tmp_path, files))
    assert [pattern.text for pattern in operations(tmp_path)["link:send"].patterns] == ["lift/{height:g}"]


def test_tests_that_cannot_run_are_reported_precisely_and_files_are_written(project: Path) -> None:
    (project / "tests" / "test_mission.py").write_text("import simulator_that_is_missing, mission\n")
    told = "\n".join(propose(project))
    assert "No module named 'simulator_that_is_missing'" in told
    assert "python -m pytest tests" in told
    assert load_configuration(project).program == ("mission.py",)
    assert "without an operation" in told


def test_failing_tests_are_reported_and_what_they_called_counts(project: Path) -> None:
    with (project / "tests" / "test_mission.py").open("a") as file:
        file.write("def test_bad(): assert 1 == 2, 'this is bad'\n")
    told = "\n".join(propose(project))
    assert "1 passed, 1 failed" in told
    assert "test_bad: AssertionError: this is bad" in told
    assert "robot:Arm.move_by" in operations(project)


@pytest.mark.whole
def test_tests_that_never_end_are_stopped_and_what_they_called_counts(project: Path) -> None:
    with (project / "tests" / "test_mission.py").open("a") as file:
        file.write("def test_late():\n    while True: pass\n")
    told = "\n".join(propose(project, limit=4.0))
    assert "took longer than 4 s" in told
    assert "robot:Arm.move_by" in operations(project)


def test_files_can_be_named(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(project.parent)
    propose(project, [Path("tests/sensors.py")])
    assert load_configuration(project).program == ("tests/sensors.py",)
    assert set(operations(project)) == {"robot:Arm.pose"}


@pytest.mark.parametrize("name", ["mutabot.toml", "robot.toml"])
def test_an_existing_file_is_never_overwritten(project: Path, name: str) -> None:
    (project / name).write_text("mine")
    before = {path: path.read_bytes() for path in project.rglob("*") if path.is_file()}
    with pytest.raises(UsageError, match=f"{name} exists already"):
        propose(project)
    assert {path: path.read_bytes() for path in project.rglob("*") if path.is_file()} == before


def test_a_configuration_in_pyproject_counts_as_existing(project: Path) -> None:
    (project / "pyproject.toml").write_text("[tool.mutabot]\n")
    with pytest.raises(UsageError, match=r"\[tool.mutabot\] already"):
        propose(project)


@pytest.mark.parametrize(
    ("given", "words"), [("nowhere.py", "no such file"), ("/etc/hosts", "does not lie in")]
)
def test_what_cannot_be_proposed_is_a_usage_error(project: Path, given: str, words: str) -> None:
    with pytest.raises(UsageError, match=words):
        propose(project, [Path(given)])
    assert not (project / "robot.toml").exists()


def test_an_empty_folder_is_a_usage_error(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="name the files"):
        propose(tmp_path)


def test_files_that_are_no_python_do_not_stop_it(project: Path) -> None:
    (project / "broken.py").write_text("def (")
    (project / "binary.py").write_bytes(b"\0\xff")
    assert load_configuration_after(project).program == ("mission.py",)
    assert "robot:Arm.move_by" in operations(project)


def load_configuration_after(project: Path) -> Any:
    propose(project)
    return load_configuration(project)


def test_the_command_writes_both_files_and_nothing_else(project: Path) -> None:
    before = {path for path in project.rglob("*") if path.is_file()}
    done = mutabot(project, "init")
    assert done.returncode == 0, done.stderr
    assert "wrote robot.toml" in done.stdout
    assert tomllib.loads((project / "mutabot.toml").read_text())["seed"] == 1
    after = {path for path in project.rglob("*") if path.is_file()}
    assert {path.name for path in after - before} == {"mutabot.toml", "robot.toml"}


MOVED = {"kind": "translation", "unit": "m"}


@pytest.mark.parametrize(
    ("name", "called", "doc", "expected"),
    [
        ("x", "move_to", "In m.", {**MOVED, "axis": "x", "mode": "to"}),
        ("dz_mm", "move", "", {"kind": "translation", "axis": "z", "unit": "mm", "mode": "by"}),
        ("x", "move_up", "Fly x cm up.", {"kind": "translation", "axis": "z", "unit": "cm", "mode": "by"}),
        ("x", "set_speed", "Set the speed to x cm/s.", {"kind": "speed", "unit": "cm/s"}),
        (
            "x",
            "rotate_clockwise",
            "By x degrees.",
            {"kind": "rotation", "axis": "z", "unit": "deg", "mode": "by"},
        ),
        ("angle_rad", "turn", "", {"kind": "rotation", "unit": "rad", "mode": "by"}),
        ("j3", "moveJoints", "Degrees.", {"kind": "rotation", "axis": "j3", "unit": "deg", "mode": "to"}),
        ("height", "lift_by", "In metres.", {**MOVED, "axis": "z", "mode": "by"}),
        ("seconds", "wait", "", {"kind": "duration", "unit": "s"}),
        ("milliseconds", "wait", "", {"kind": "duration", "unit": "ms"}),
        ("weight", "setPayload", "", {"kind": "mass", "unit": "kg"}),
        ("name", "move", "", {}),
        ("timeout", "wait", "", {}),
        ("code", "set_position", "", {}),
        ("distance_tolerance", "move_by", "In m.", {}),
        ("velocity_unit", "move", "", {}),
        ("beta", "MovePose", "In degrees.", {"kind": "rotation", "unit": "deg", "mode": "to"}),
        ("z", "look_at", "In m.", {**MOVED, "axis": "z", "mode": "to"}),
        ("p", "set_joint_vel", "p: Percentage of the top.", {"kind": "ratio", "unit": "percent"}),
    ],
)
def test_the_verb_decides_what_an_argument_is(
    name: str, called: str, doc: str, expected: dict[str, Any]
) -> None:
    guess = guess_argument(name, NameContext(words_of(called), doc=doc, names=frozenset({name})))
    expected = {**expected, "unit": "kg"} if expected.get("kind") == "mass" else expected
    assert guess.table == expected
    assert guess.is_sure == (bool(expected) and expected["kind"] != "mass")


@pytest.mark.parametrize(
    ("name", "called", "values", "asked"),
    [
        ("x", "move", (0.5,), 'a target (mode = "to") or a change (mode = "by")?'),
        ("x", "move_to", (3,), "the unit: m, cm, mm?"),
        ("width", "gripper_move", (0.05,), "what is fully closed, what is fully open? in which unit"),
        ("speed", "move_to", (0.5,), "the unit: m/s, cm/s"),
    ],
)
def test_what_nothing_shows_is_asked(name: str, called: str, values: tuple[Any, ...], asked: str) -> None:
    guess = guess_argument(name, NameContext(words_of(called), values=values))
    assert guess.questions[0].startswith(asked)


@pytest.mark.parametrize(
    ("name", "setting", "expected"),
    [
        ("z", NameContext(doc="In m."), {"kind": "position", "axis": "z", "unit": "m"}),
        ("roll", NameContext(doc="Degrees."), {"kind": "orientation", "axis": "x", "unit": "deg"}),
        ("j1", NameContext(values=(0.5,)), {"kind": "angle", "axis": "j1", "unit": "rad"}),
        ("read_distance", NameContext(values=(0.5,)), {"kind": "distance", "unit": "m"}),
        ("height_mm", NameContext(("read", "height")), {"kind": "distance", "unit": "mm"}),
        ("is_closed", NameContext(owner=("gripper",)), {"kind": "flag"}),
        (
            "colour",
            NameContext(annotation="Literal['red', 'blue']"),
            {"kind": "label", "values": ["red", "blue"]},
        ),
        ("name", NameContext(("log",)), {}),
        ("code", NameContext(("get", "position"), values=(0,)), {}),
        ("y", NameContext(("get", "y"), ("xbox", "controller"), values=(0.5,)), {}),
        ("is_error", NameContext(("is", "error"), ("modbus", "response"), values=(False,)), {}),
    ],
)
def test_a_reading_is_what_its_name_says(name: str, setting: NameContext, expected: dict[str, Any]) -> None:
    assert guess_reading(name, setting).table == expected


def test_programs_that_the_tests_start_as_processes_are_watched_there(tmp_path: Path) -> None:
    files = {
        "robot.py": """
            class Arm:
                def move_by(self, x=0.0):
                    print(x)
        """,
        "mission.py": """
            from robot import Arm

            arm = Arm()
            for _ in range(3):
                arm.move_by(x=0.5)
        """,
        "tests/test_mission.py": """
            import subprocess
            import sys

            def test_mission():
                subprocess.run([sys.executable, "mission.py"], check=True)

            def test_ended():
                code = "import signal, mission; signal.pause()"
                process = subprocess.Popen([sys.executable, "-uc", code], stdout=subprocess.PIPE)
                process.stdout.readline()
                process.terminate()
        """,
    }
    told = "\n".join(propose(write(tmp_path, files)))
    assert "calls 1 callable," in told
    (found,) = operations(tmp_path).values()
    assert (found.target, [argument.name for argument in found.arguments]) == ("robot:Arm.move_by", ["x"])


def test_a_process_of_an_interpreter_that_has_no_mutabot_is_watched_as_well(tmp_path: Path) -> None:
    venv.create(tmp_path / "bare", symlinks=True)
    python = tmp_path / "bare" / "bin" / "python"
    alone = subprocess.run([python, "-Ic", "import mutabot_init"], stderr=subprocess.PIPE, check=False)
    assert b"No module named 'mutabot_init'" in alone.stderr
    files = {
        "robot.py": "class Arm:\n    def move_by(self, x=0.0): ...\n",
        "mission.py": "from robot import Arm\n\nArm().move_by(x=0.5)\n",
        "tests/test_mission.py": f"""
            import subprocess

            def test_mission():
                subprocess.run([{str(python)!r}, "mission.py"], check=True)
        """,
    }
    told = "\n".join(propose(write(tmp_path / "project", files)))
    assert "1 passed; the program calls 1 callable," in told
    assert set(operations(tmp_path / "project")) == {"robot:Arm.move_by"}


STAND_INS = {
    "mission.py": """
        def run(arm, lamp, plain):
            arm.move_by(0.25, speed=0.5)
            lamp.set_output(True)
            plain.rotate(yaw_deg=30.0)
    """,
    "robot.py": """
        class Lamp:
            def set_output(self, on: bool): ...
    """,
    "test_mission.py": """
        from unittest.mock import MagicMock, Mock

        import mission
        from robot import Lamp

        class FakeArm:
            def move_by(self, dx, speed=0.1): ...

        class FakeLamp(Lamp):
            def set_output(self, on): ...

        def test_with_fakes():
            mission.run(FakeArm(), FakeLamp(), Mock())

        def test_with_mocks():
            mission.run(Mock(), MagicMock(spec=Lamp), Mock())
    """,
}


def test_where_the_tests_stand_in_for_the_robot_methods_are_proposed(tmp_path: Path) -> None:
    for name, text in STAND_INS.items():
        (tmp_path / name).write_text(textwrap.dedent(text), encoding="utf-8")
    lines = propose(tmp_path)
    operations = {
        operation.target: operation for operation in load_vocabulary(["robot.toml"], tmp_path).operations
    }
    assert set(operations) == {"*:*.move_by", "robot:Lamp.set_output", "*:*.rotate"}
    assert str(operations["*:*.move_by"].signature) == "(dx, speed=0.1)"
    assert [argument.name for argument in operations["*:*.rotate"].arguments] == ["yaw_deg"]
    (mocked,) = (line for line in lines if line.startswith("the tests call these on mocks or fakes"))
    assert set(mocked.rpartition(": ")[2].split(", ")) == {"robot:Lamp.set_output", "move_by", "rotate"}
    assert "the class that they stand for; a name alone means any object that has it: " in mocked


@pytest.mark.parametrize(
    ("name", "called", "doc", "expected"),
    [
        ("speed", "forward", ":param float speed: between 0 (stopped) and 1 (full speed)", [0.0, 1.0]),
        ("xSpeed", "arcadeDrive", ":param xSpeed: along the X axis [-1.0..1.0]", [-1.0, 1.0]),
        ("speed", "send_angles", "speed : (int) 1 ~ 100", [1.0, 100.0]),
    ],
)
def test_a_range_in_a_docstring_makes_a_speed_a_ratio(
    name: str, called: str, doc: str, expected: list[float]
) -> None:
    table = guess_argument(name, NameContext(words_of(called), doc=doc)).table
    unit = "percent" if expected[1] > 1 else "fraction"
    assert table == {"kind": "ratio", "unit": unit, "range": expected}


def test_a_range_counts_if_it_is_one_and_holds_all_values() -> None:
    doc = ":param value: a float from 0 to 1, or degrees\n:param factor: array of [7, 1]\n"
    setting = NameContext(words_of("write"), doc=doc, values=(0.5, 90))
    assert guess_argument("value", setting).table == {}
    assert guess_argument("value", replace(setting, values=(0.5,))).table["range"] == [0.0, 1.0]
    assert "range" not in guess_argument("factor", NameContext(words_of("set_speed"), doc=doc)).table


def test_of_two_ways_to_read_a_number_is_asked() -> None:
    setting = NameContext(words_of("move"), doc="velocity (int): Percentage or mm/s.")
    assert guess_argument("velocity", setting).questions == ["the unit: mm/s, or a ratio in percent?"]


@pytest.mark.parametrize(
    ("name", "called", "values", "axis"),
    [
        ("target", "goto", [0.0, 10.0, -10.0, -90.0, 0.0, 0.0, 0.0], "j1..j7"),
        ("target", "goto", [0.5, 0.25, 0.125, 0.0, 0.0, 0.6, 0.8], "xyz"),
        ("get_joint_pos", "get_joint_pos", [0.0, -20.0, 10.0, 0.0, 30.0, 0.0], "j1..j6"),
    ],
)
def test_seven_numbers_without_a_quaternion_are_joints(
    name: str, called: str, values: list[float], axis: str
) -> None:
    part = WatchedPart("", name=name, values=[values], length=len(values))
    guesses = guess_elements(part, name, NameContext(words_of(called), values=[values]), written=True)
    assert next(iter(guesses.values())).table["axis"] == axis


def test_an_argument_says_whether_angles_are_degrees(tmp_path: Path) -> None:
    files = {
        "robot.py": """
            class Arm:
                def rotate_by(self, yaw, degrees=True):
                    '''In degrees, or in radians.'''
        """,
        "mission.py": "def run(arm):\n    arm.rotate_by(1.5)\n",
        "test_mission.py": "import mission, robot\ndef test_it(): mission.run(robot.Arm())\n",
    }
    propose(write(tmp_path, files))
    assert (
        'arguments.yaw = { kind = "rotation", axis = "z", unit = "deg"'
        in (tmp_path / "robot.toml").read_text()
    )


def test_calls_that_a_mock_noted_are_left_alone(tmp_path: Path) -> None:
    files = {
        "mission.py": "def run(arm):\n    arm.lift_by(0.5)\n",
        "test_mission.py": """
            from unittest import mock
            import mission

            def test_it():
                arm = mock.Mock()
                mission.run(arm)
                assert arm.lift_by.call_args_list == [mock.call(0.5)]
        """,
    }
    assert any("tests: 1 passed" in line for line in propose(write(tmp_path, files)))


def test_the_unit_is_that_of_the_arguments_own_line() -> None:
    doc = ":param x: cartesian position x, (unit: mm)\n:param speed: move speed (mm/s, rad/s)\n"
    setting = NameContext(words_of("set_position"), doc=doc)
    assert guess_argument("x", setting).table["unit"] == "mm"
    assert guess_argument("speed", setting).questions == ["the unit: mm/s, rad/s?"]


def test_where_relative_says_the_mode_it_decides(tmp_path: Path) -> None:
    files = {
        "robot.py": "class Arm:\n    def set_position(self, x, relative=False):\n        '''In mm.'''\n",
        "mission.py": "def run(arm):\n    arm.set_position(300)\n    arm.set_position(-50, relative=True)\n",
        "test_mission.py": "import mission, robot\ndef test_it(): mission.run(robot.Arm())\n",
    }
    propose(write(tmp_path, files))
    assert (
        'mode = { argument = "relative", true = "by", false = "to" }' in (tmp_path / "robot.toml").read_text()
    )
    assert operations(tmp_path)


def test_replies_connections_and_what_is_created_are_no_operations(tmp_path: Path) -> None:
    files = {
        "robot.py": """
            class Response:
                def isError(self): return False

            class Arm:
                def is_connected(self): return True
                def get_gripper_position(self): return 12.5
                def get_position(self):
                    '''In mm.'''
                    return [0.5, 0.25, 0.125]
                def move_to(self, x, y, z):
                    '''In mm.'''
                    return Response()

            def create_arm(position): return Arm()
        """,
        "mission.py": """
            import robot

            def run():
                arm = robot.create_arm([0.5, 0.5, 0.5])
                if arm.is_connected():
                    assert not arm.move_to(0.5, 0.25, 0.125).isError()
                return arm.get_position(), arm.get_gripper_position()
        """,
        "test_mission.py": "import mission\ndef test_it(): mission.run()\n",
    }
    propose(write(tmp_path, files))
    found = operations(tmp_path)
    assert set(found) == {"robot:Arm.move_to", "robot:Arm.get_position"}
    assert found["robot:Arm.move_to"].current == "robot:Arm.get_position"


def test_a_scale_of_bits_is_no_speed() -> None:
    setting = NameContext(words_of("open"), doc="speed (int): Gripper speed between 0 and 255.", values=(64,))
    assert guess_argument("speed", setting).table == {"kind": "output", "range": [0.0, 255.0]}
