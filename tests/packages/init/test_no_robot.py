"""What a program calls that is no call of a robot: the draft has no line for it."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from mutabot.config.vocabulary import load_vocabulary
from mutabot_init.guess import NameContext, guess_argument, guess_elements, guess_reading
from mutabot_init.layout import look
from mutabot_init.observations import WatchedPart
from mutabot_init.propose import propose

FILES = {
    "bus.py": """
        class Bus:
            def __init__(self, channel): self.channel, self.sent = channel, []
            def __str__(self): return f"Virtual bus, channel {self.channel}"
            def send(self, frame): self.sent.append(frame)

        def parse_reply(text):
            LOG.append(text)
            return {"is_open": text == "1"}

        LOG = []

        def text_property(command):
            return property(lambda self: self.bus.send(command))
    """,
    "program.py": """
        import threading
        import bus

        class Drive:
            position = bus.text_property("POS?")
            def __init__(self, bus, seen):
                self.bus, self.seen, self.stopped = bus, seen, threading.Event()
            def move(self, target):
                self.bus.send((7, target))
                assert bus.parse_reply("1")["is_open"]
                self.seen.start(target)
                self.stopped.wait(1.0)
    """,
    "tests/test_program.py": """
        import unittest
        from unittest.mock import MagicMock, patch
        import program
        from bus import Bus

        class TestDrive(unittest.TestCase):
            def start(self, target): self.target = target

            @patch("program.threading.Event")
            def test_one(self, event):
                program.Drive(Bus(1), self).move(0.5)
                program.Drive(Bus(2), self).move(0.25)
                assert self.target == 0.25

        class TestPlain:
            def start(self, target): self.target = target

            def test_two(self):
                with patch.object(program.threading.Event, "wait", lambda self, timeout=None: True):
                    program.Drive(Bus(1), self).move(0.5)
    """,
}


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("drive")
    for name, text in FILES.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(dedent(text))
    propose(folder, [folder / "program.py"])
    return folder


def test_callbacks_of_tests_factories_parsers_and_mocked_events_are_none(project: Path) -> None:
    found = load_vocabulary(["robot.toml"], project).operations
    assert [operation.target for operation in found] == ["bus:Bus.send"]


def test_a_description_of_an_object_tells_no_commands_apart(project: Path) -> None:
    (sending,) = load_vocabulary(["robot.toml"], project).operations
    assert sending.message is None
    assert sending.command


@pytest.mark.parametrize("path", ["sys_test/rig.py", "unit-tests/rig.py", "cell/rig_tests.py"])
def test_files_of_tests_are_no_program(tmp_path: Path, path: str) -> None:
    for name in (path, "cell/mission.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("import math\n")
    layout = look(tmp_path, [])
    assert [layout.relative(file) for file in layout.program] == ["cell/mission.py"]
    assert layout.arguments == [path if path.startswith("cell") else path.partition("/")[0]]


@pytest.mark.parametrize("name", ["pulse_width", "min_pulse_width", "frame_width"])
def test_the_width_of_a_signal_is_no_length(name: str) -> None:
    assert guess_reading(name, NameContext((name,), values=[0.0005])).table == {}
    assert guess_argument(name, NameContext(("set",), values=[0.0005])).table == {}


def test_the_width_of_a_part_is_a_length() -> None:
    found = guess_reading("part_width", NameContext((), values=[0.05])).table
    assert found == {"kind": "distance", "unit": "m"}


@pytest.mark.parametrize(("length", "is_joints"), [(6, True), (7, True), (8, False), (16, False)])
def test_more_angles_than_an_arm_has_joints_are_no_joints(length: int, is_joints: bool) -> None:
    values: list[Any] = [[0.5] * length]
    part = WatchedPart("", values=values, length=length)
    assert bool(guess_elements(part, "angles", NameContext(values=values), written=False)) is is_joints
