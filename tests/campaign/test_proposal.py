"""``mutabot init``: guesses that an engineer would make, a vocabulary that loads, nothing overwritten."""

from __future__ import annotations

import subprocess
import sys
import textwrap
import tomllib
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.configuration import load_configuration
from mutabot.campaign.proposal import propose
from mutabot.campaign.proposal.guess import Setting, guess_argument, guess_reading
from mutabot.errors import UsageError
from mutabot.model import Kind, Mode
from mutabot.vocabulary import load

ROBOT = '''
from dataclasses import dataclass
import errors

raise SystemExit("init must never import the program")

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
    def pose(self) -> Pose: ...
    @property
    def distance_mm(self) -> float: ...
    def _private(self, x): ...

class Gripper:
    def command(self, position): ...
    def open(self): ...
    def close(self): ...

class Conveyor:
    def set_output(self, on: bool): ...

class Camera:
    def colour(self) -> str: ...
    def locate(self) -> tuple[float, float, float]:
        """Position, m."""

def wait(seconds): ...
def connect() -> Arm: ...
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
        self.arm.go_to(self.camera)
        self.arm._private(1)
        pause(1.5)
        conveyor.set_output(True)
        colour = self.camera.colour()
        if colour == "red" or colour in ("blue", "green"):
            self.arm.move_by(dy=-0.1)
        robot.log("done")
        time.sleep(1)
        return self.arm.distance_mm, self.camera.locate()
"""
SENSORS = """
import robot

def where(arm: robot.Arm):
    return arm.pose()
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    files = {
        "robot.py": ROBOT,
        "errors.py": "class OutOfReach(Exception): ...\n",
        "constants.py": "CLOSED = 1\n",
        "mission.py": MISSION,
        "tests/sensors.py": SENSORS,
        "tests/test_mission.py": "import mission, sensors\ndef test_it(): mission.Mission\n",
    }
    for name, text in files.items():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(textwrap.dedent(text))
    return tmp_path


def operations(project: Path) -> dict[str, Any]:
    return {one.target: one for one in load(["robot.toml"], project).operations}


def test_the_proposal_loads_and_names_program_oracle_and_tests(project: Path) -> None:
    propose(project)
    configuration = load_configuration(project)
    assert configuration.program == ("mission.py",)
    assert configuration.oracle == ("tests/sensors.py",)
    assert configuration.tests == ("tests",)
    assert configuration.vocabulary == ("robot.toml",)
    assert operations(project)


def test_every_way_to_reach_an_operation_is_followed(project: Path) -> None:
    propose(project)
    assert set(operations(project)) == {
        "robot:Base.home",  # inherited
        "robot:Arm.move_by",  # on what a function returns
        "robot:Arm.go_to",
        "robot:Arm.pose",  # only the tests read it
        "robot:Arm.distance_mm",  # a property
        "robot:Gripper.command",  # a class imported by name
        "robot:Gripper.open",
        "robot:Gripper.close",
        "robot:wait",  # imported under another name
        "robot:Conveyor.set_output",  # a parameter named like the class
        "robot:Camera.colour",  # an annotated parameter, kept in self
        "robot:Camera.locate",
    }


def test_arguments_get_kind_axis_unit_and_mode_from_their_names(project: Path) -> None:
    propose(project)
    move = operations(project)["robot:Arm.move_by"]
    found = {one.name: (one.kind, one.axis, one.unit, one.mode) for one in move.arguments}
    assert found == {
        "dx": (Kind.TRANSLATION, "x", "m", Mode.BY),
        "dy": (Kind.TRANSLATION, "y", "m", Mode.BY),
        "yaw_deg": (Kind.ROTATION, "z", "deg", Mode.BY),
    }
    assert move.current == "robot:Arm.pose"
    assert move.refusals == ("errors:OutOfReach",)


def test_fields_of_an_argument_are_absolute_targets(project: Path) -> None:
    propose(project)
    found = operations(project)["robot:Arm.go_to"].arguments
    assert {(one.name, one.unit, one.mode) for one in found} == {
        ("target.x", "mm", Mode.TO),
        ("target.y", "mm", Mode.TO),
        ("target.yaw", "deg", Mode.TO),
    }


def test_results_are_read_from_annotations_and_names(project: Path) -> None:
    propose(project)
    found = operations(project)
    assert {(one.name, one.kind, one.unit) for one in found["robot:Arm.pose"].result} == {
        (".x", Kind.POSITION, "mm"),
        (".y", Kind.POSITION, "mm"),
        (".yaw", Kind.ORIENTATION, "deg"),
    }
    assert [(one.kind, one.unit) for one in found["robot:Arm.distance_mm"].result] == [(Kind.DISTANCE, "mm")]
    assert [(one.name, one.axis) for one in found["robot:Camera.locate"].result] == [
        ("[0]", "x"),
        ("[1]", "y"),
        ("[2]", "z"),
    ]


def test_values_come_from_what_the_program_sends_and_compares_with(project: Path) -> None:
    propose(project)
    found = operations(project)
    assert found["robot:Gripper.command"].arguments[0].values == (0, 1)
    assert found["robot:Camera.colour"].result[0].values == ("red", "blue", "green")
    assert found["robot:Conveyor.set_output"].arguments[0].values == (False, True)
    assert found["robot:Gripper.open"].opposite == "robot:Gripper.close"


def test_every_guess_is_marked(project: Path) -> None:
    propose(project)
    text = (project / "robot.toml").read_text()
    for line in text.splitlines():
        if line.startswith(("arguments", "result", "current", "opposite", "refusals")):
            assert "# guess" in line
    assert "robot:log" in text  # named, but not proposed


def test_what_comes_next_is_told(project: Path) -> None:
    lines = "\n".join(propose(project))
    assert "mission.py (guessed" in lines
    assert "mutabot check" in lines


def test_text_commands_become_patterns(tmp_path: Path) -> None:
    (tmp_path / "link.py").write_text("def send(text): ...\ndef read(name): ...\n")
    (tmp_path / "sorter.py").write_text(
        "import link\ndef run(h):\n    link.send('pick'); link.send('lift/5'); link.send('lift/7')\n"
        "    link.send(f'drop/{h}'); link.send('turn/90.5'); link.send('release'); link.read('color')\n"
    )
    propose(tmp_path)
    found = operations(tmp_path)
    patterns = {one.text: one for one in found["link:send"].patterns}
    assert set(patterns) == {"pick", "release", "lift/{height:g}", "drop/{h:g}", "turn/{angle:g}"}
    assert patterns["pick"].opposite == "release"
    assert patterns["lift/{height:g}"].arguments[0].axis == "z"
    assert not found["link:read"].command


def test_files_can_be_named(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(project.parent)
    propose(project, [Path("tests/sensors.py")])
    assert load_configuration(project).program == ("tests/sensors.py",)


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
    ("given", "words"),
    [
        (["nowhere.py"], "no such file"),
        (["constants.py"], "no call that looks like a robot's"),
        (["/etc/hosts"], "does not lie in"),
    ],
)
def test_what_cannot_be_proposed_is_a_usage_error(project: Path, given: list[str], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        propose(project, [Path(name) for name in given])
    assert not (project / "robot.toml").exists()


def test_an_empty_folder_is_a_usage_error(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="name the files"):
        propose(tmp_path)


def test_files_that_are_no_python_do_not_stop_it(project: Path) -> None:
    (project / "broken.py").write_text("def (")
    (project / "binary.py").write_bytes(b"\0\xff")
    propose(project)
    assert "robot:Arm.move_by" in operations(project)


def test_imports_in_a_circle_do_not_stop_it(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("from b import Arm\nclass X(Arm): ...\n")
    (tmp_path / "b.py").write_text("from a import Arm, X\nclass Y(X): ...\narm = arm\n")
    (tmp_path / "mission.py").write_text(
        "import a, b\ny = b.Y()\nz = z\ny.home(); z.home(); a.Arm().home()\n"
    )
    with pytest.raises(UsageError):
        propose(tmp_path)


def test_the_command_writes_both_files(project: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "mutabot.cli", "init"],
        cwd=project,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "wrote robot.toml" in done.stdout
    assert tomllib.loads((project / "mutabot.toml").read_text())["seed"] == 1


@pytest.mark.parametrize(
    ("name", "words", "expected"),
    [
        ("x", "arm_move_to", {"kind": "translation", "axis": "x", "unit": "m", "mode": "to"}),
        ("dz_mm", "arm_move", {"kind": "translation", "axis": "z", "unit": "mm", "mode": "by"}),
        ("theta_z", "arm_rotate", {"kind": "rotation", "axis": "z", "unit": "deg", "mode": "by"}),
        ("angle_rad", "arm_turn", {"kind": "rotation", "unit": "rad", "mode": "by"}),
        ("j3", "arm_move_joints", {"kind": "rotation", "axis": "j3", "unit": "deg", "mode": "to"}),
        ("height", "lift_by", {"kind": "translation", "axis": "z", "unit": "m", "mode": "by"}),
        ("seconds", "wait", {"kind": "duration", "unit": "s"}),
        ("milliseconds", "wait", {"kind": "duration", "unit": "ms"}),
        ("width", "gripper_move", {"kind": "opening", "unit": "m", "range": [0.0, 0.1]}),
        ("position", "gripper_move", {"kind": "opening", "unit": "fraction", "range": [0.0, 1.0]}),
        ("value", "io_set_digital_output", {"kind": "output", "values": [False, True]}),
        ("speed", "arm_move", {}),
        ("name", "arm_move", {}),
    ],
)
def test_an_argument_is_guessed_from_its_name(name: str, words: str, expected: dict[str, Any]) -> None:
    assert guess_argument(name, Setting(words)).table == expected


@pytest.mark.parametrize(
    ("name", "setting", "expected"),
    [
        ("z", Setting(""), {"kind": "position", "axis": "z", "unit": "m"}),
        ("roll", Setting(""), {"kind": "orientation", "axis": "x", "unit": "deg"}),
        ("j1", Setting(""), {"kind": "angle", "axis": "j1", "unit": "deg"}),
        ("read", Setting("distance_sensor_read"), {"kind": "distance", "unit": "m"}),
        ("height_mm", Setting("read_height"), {"kind": "distance", "unit": "mm"}),
        ("is_closed", Setting("gripper"), {"kind": "flag"}),
        (
            "colour",
            Setting("", annotation="Literal['red', 'blue']"),
            {"kind": "label", "values": ["red", "blue"]},
        ),
        ("name", Setting("log"), {}),
    ],
)
def test_a_reading_is_guessed_from_its_name(name: str, setting: Setting, expected: dict[str, Any]) -> None:
    assert guess_reading(name, setting).table == expected
