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


PROTOCOL = {
    "plc/__init__.py": "",
    "plc/codec.py": """
        import re
        TEXTS = {"length": "too long"}
        ADDRESS = re.compile(r"([DM])([0-9]+)")

        def _(text): return TEXTS.get(text, text)

        def _check(words):
            if len(words) > 9: raise ValueError(_("length"))

        def translate_address(text):
            found = ADDRESS.fullmatch(text.strip())
            if found is None or not found.group(2).isdigit(): raise ValueError(_("address"))
            return found.group(1), int(found.group(2))

        def build_write(address, words):
            _check(words)
            body = b"".join(word.to_bytes(2, "big") for word in words)
            return translate_address(address)[0].encode("ascii") + body

        def get_level(code): return TEXTS.get(code, "INFO")

        LOG = []

        def is_logged():
            LOG.append(1)
            return True
        """,
    "plc/state.py": """
        from dataclasses import dataclass
        from enum import Enum
        from typing import NamedTuple

        class Coding(Enum):
            ASCII = 1
            BINARY = 2
            @property
            def is_active(self): return self is Coding.ASCII

        class Pose(NamedTuple):
            x: float
            y: float
            @property
            def xy(self): return [self.x, self.y]

        @dataclass
        class State:
            mode: int
            @property
            def is_heating(self): return self.mode == 3
            @property
            def is_configured(self): return self.mode > 0
            @property
            def is_cooling(self): return self.mode == 2
        """,
    "plc/client.py": """
        from plc.state import State

        class Metrics:
            def __init__(self): self.began = None
            def start_timer(self): self.began = 1

        class Monitor:
            def __init__(self): self.threads = []
            @property
            def running(self): return len(self.threads) > 0

        class Line:
            def __init__(self): self.sent, self.read_only = [], False
            def send(self, data): self.sent.append(data)
            def on_change(self, callback): self.sent.append(callback)
            def set_timeout(self, seconds): self.sent.append(seconds)
            def state(self): return State(len(self.sent))
            @property
            def connected(self): return len(self.sent) >= 0
            def ping(self): self.sent.append(1); return True
            def read_sensor(self): self.sent.append(1); return True

        class Spare(Line):
            pass
        """,
    "plc/run.py": """
        from http.cookies import SimpleCookie
        from plc import codec
        from plc.client import Line, Metrics
        from plc.state import Coding, Pose

        def run(line):
            Metrics().start_timer()
            line.on_change(print)
            line.set_timeout(2.0)
            settings = SimpleCookie()
            settings["mode"] = "1"
            line.send(codec.build_write("D1", [1, 2]))
            state = line.state()
            return state.is_heating, state.is_configured, Coding.ASCII.is_active, Pose(1.0, 2.0).xy
        """,
    "tests/test_plc.py": """
        from plc.client import Line, Monitor
        from plc.codec import get_level, is_logged
        from plc.run import run
        from plc.state import State

        def test_it():
            line = Line()
            assert run(line)[0]
            assert line.connected and line.ping() and line.read_sensor()
            assert State(2).is_cooling and not Monitor().running and get_level("a") == "INFO"
            assert is_logged()
        """,
}


def test_of_a_protocols_library_what_reaches_the_line_is_an_operation_and_no_codec_or_data(
    tmp_path: Path,
) -> None:
    reached = ["plc.client:Line.send", "plc.state:State.is_heating", "plc.client:Line.read_sensor"]
    assert written(tmp_path, PROTOCOL) == reached


@pytest.mark.parametrize(("call", "name"), [("read", "length"), ("get_height", "x")])
def test_an_argument_of_what_only_reads_is_no_motion(call: str, name: str) -> None:
    assert guess_argument(name, NameContext(words_of(call), values=[4])).table == {}


@pytest.mark.parametrize("name", ["segment_gap_s", "time_to_target_ms"])
def test_what_is_in_seconds_by_its_name_is_no_length(name: str) -> None:
    assert guess_reading(name, NameContext(values=[0.02])).table == {}
    part = WatchedPart("", values=[[0.02, 0.05]], length=2)
    assert guess_elements(part, name, NameContext(values=part.values), written=False) == {}


def test_what_nothing_is_known_of_is_proposed_unless_it_sets_a_connection_up(tmp_path: Path) -> None:
    files = {
        "vendor.py": """
            class Bus:
                def __init__(self): self.log = []
                def set_timeout(self, seconds): self.log.append(seconds)
                def load(self, path): self.log.append(path)
                def execute(self, code): self.log.append(code)
            """,
        "program.py": """
            import vendor
            def run():
                bus = vendor.Bus()
                bus.set_timeout(2)
                bus.load("a")
                bus.execute(6)
            """,
        "test_it.py": "import program\ndef test_it(): program.run()\n",
    }
    assert written(tmp_path, files) == ["vendor:Bus.execute"]
