"""What a program calls that is no call of a robot: the draft has no line for it."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from mutabot.config.vocabulary import load_vocabulary
from mutabot.errors import ConfigurationError
from mutabot_init.guess import NameContext, guess_argument, guess_elements, guess_reading
from mutabot_init.layout import look
from mutabot_init.observations import WatchedPart
from mutabot_init.propose import propose
from mutabot_init.words import words_of

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


def test_a_description_of_an_object_distinguishes_no_commands(project: Path) -> None:
    (sending,) = load_vocabulary(["robot.toml"], project).operations
    assert sending.message is None
    assert sending.command


@pytest.mark.parametrize(
    "path", ["sys_test/rig.py", "unit-tests/rig.py", "cell/rig_tests.py", "cell/tests.py"]
)
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


LIBRARY = {
    "link.py": """
        from types import SimpleNamespace
        LOG = []

        class Session:
            def __init__(self): self.closed, self.log = True, []
            def __enter__(self): self.open(); return self
            def __exit__(self, *_): self.close()
            def open(self): self.closed = False
            def close(self): self.closed = True
            def send(self, frame): self.log.append(frame)
            @property
            def pull_up(self): return bool(self.log)
            @property
            def is_pressed(self): return len(self.log) > 0

        class Listener:
            def __init__(self): self.log = []
            def start(self): self.log.append(1)

        class Tree:
            def __init__(self): self.rows = []
            def assign_child(self, location): self.rows.append(location)
            def recoverable(self): return bool(self.rows)
            def host(self) -> str: return "one" if self.rows else "two"
            def max_distance(self): return float(len(self.rows)) + 0.5

        def is_fault(code): return code > 3

        class Meter:
            def __init__(self, number): self.number = number
            def is_above(self, number): return self.number > number
            def set_handler(self, number): self.number = number
            @property
            def start_frequency(self):
                '''In Hz.'''
                LOG.append(1)
                return 100.0
            @property
            def stop_frequency(self):
                '''In Hz.'''
                LOG.append(2)
                return 200.0
            def max_velocity(self):
                LOG.append(3)
                return SimpleNamespace(x=1.0, y=0.5)
            def velocity(self):
                LOG.append(3)
                return SimpleNamespace(x=1.0, y=0.5)

        class Code:
            def __init__(self, number): self.number = number
            @property
            def is_fault(self): return self.number > 3
        """,
    "program.py": """
        from types import SimpleNamespace
        import link

        def run(tree):
            listener = link.Listener()
            listener.start()
            session = link.Session()
            session.open()
            session.send(b"1")
            tree.assign_child(SimpleNamespace(x=1, y=2))
            found = tree.recoverable(), tree.host(), tree.max_distance(), session.pull_up, session.is_pressed
            session.close()
            meter = link.Meter(4)
            meter.set_handler(4)
            meter.start_frequency, meter.stop_frequency, meter.max_velocity(), meter.velocity()
            return found, link.is_fault(4), meter.is_above(3)
        """,
    "test_it.py": """
        import link, program
        def test_it(): assert program.run(link.Tree())[1] and link.Code(4).is_fault
        """,
}


def written(folder: Path, files: dict[str, str]) -> list[str]:
    """The operations of the draft for a project."""
    for name, text in files.items():
        (folder / name).parent.mkdir(exist_ok=True, parents=True)
        (folder / name).write_text(dedent(text))
    propose(folder)
    return [operation.target for operation in load_vocabulary(["robot.toml"], folder).operations]


def test_connections_listeners_settings_and_what_computes_from_arguments_are_none(tmp_path: Path) -> None:
    frequencies = ["link:Meter.start_frequency", "link:Meter.stop_frequency"]
    assert written(tmp_path, LIBRARY) == ["link:Session.send", "link:Session.is_pressed", *frequencies]
    # readings undo nothing
    assert "opposite" not in (tmp_path / "robot.toml").read_text()


@pytest.mark.parametrize(
    ("name", "is_state"),
    [
        ("is_pressed", True), ("line_detected", True), ("in_range", True), ("part_found", True),
        ("pull_up", False), ("readable", False), ("active_high", False), ("max_reached", False),
    ],
)  # fmt: skip
def test_a_truth_value_is_a_reading_where_its_name_is_a_state(name: str, is_state: bool) -> None:
    setting = NameContext(words_of(name), annotation="bool", values=[True, False])
    assert (guess_reading(name, setting).table == {"kind": "flag"}) is is_state


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        ("set_time_scaling", {}),
        ("set_temperature_limit", {}),
        ("set_temperature", {"kind": "temperature", "unit": "degC"}),
    ],
)
def test_a_callable_is_about_the_last_word_of_its_name(call: str, expected: dict[str, str]) -> None:
    assert guess_argument("p", NameContext(words_of(call), values=[1])).table == expected


def test_a_letter_shows_a_time_only_beside_a_verb_that_waits() -> None:
    assert guess_argument("t", NameContext(words_of("wait"), values=[1])).is_sure
    assert not guess_argument("t", NameContext(words_of("set_rtc"), values=[1])).is_sure


def test_what_may_be_a_text_is_no_quantity() -> None:
    assert guess_reading("voltage", NameContext(values=[1.5])).table == {"kind": "voltage", "unit": "V"}
    assert guess_reading("voltage", NameContext(values=["MIN", 1.5])).table == {}


def test_what_tests_read_of_a_library_without_a_robot_is_none(tmp_path: Path) -> None:
    files = {
        "tree/nodes.py": """
            class Node:
                def __init__(self): self.children = []
                def add(self, child): self.children.append(child)
                @property
                def is_empty(self): return not self.children
            """,
        "tree/__init__.py": "",
        "tree/build.py": "from tree.nodes import Node\ndef run(node): node.add(Node())\n",
        "tests/test_tree.py": """
            from tree.build import run
            from tree.nodes import Node
            def test_it():
                node = Node()
                run(node)
                assert not node.is_empty
            """,
    }
    with pytest.raises(ConfigurationError, match="describes nothing"):
        written(tmp_path, files)
