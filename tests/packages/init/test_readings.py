"""What devices answer and are sent: tuples, members of enumerations, numbers on a scale, texts, addresses."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

import mutabot_init.propose
from mutabot.config.vocabulary import load_vocabulary
from mutabot.model.operation import Operation
from mutabot.model.quantity import Kind
from mutabot_init.guess import Guess, NameContext, guess_argument, guess_elements, guess_reading
from mutabot_init.layout import look
from mutabot_init.observations import WatchedPart
from mutabot_init.propose import propose
from mutabot_init.watching.returned import names_of_elements
from mutabot_init.words import words_of
from tests.command import mutabot

LAB = {
    "lab.py": """
        import enum
        from dataclasses import dataclass

        class State(enum.IntEnum):
            MOVING = 0
            STOPPED = 1

        @dataclass
        class Status:
            roll: float = 0.0
            battery: float = 100.0
            mode: str = "auto"

            @property
            def speed_kept(self): return self.roll * 2.0

        class Line:
            def __init__(self): self.sent = []
            def ask(self, *what):
                self.sent.append(what)
                return 40.5

        class Device:
            def __init__(self): self.line = Line()
            def read_flow_rate(self):
                value = self.line.ask("flow")
                units = "sccm"
                return value, units
            def get_position(self):
                'Returns: tuple of (latitude, longitude, level)'
                return (22.5, 113.9, self.line.ask("gps"))[0:3]
            def get_orientation(self):
                'Get the attitude in degrees.'
                roll, yaw = self.line.ask("roll"), 90.0
                return roll, yaw
            def get_state(self):
                self.line.ask("state")
                return State.STOPPED
            def get_status(self):
                return Status(self.line.ask("status"))
            def measure_power(self): return str(self.line.ask("power"))
            def set_current(self, current): self.line.ask("current", current)
            def run_task(self): return self.line.ask("run"), 90.0
            def publish(self, topic_name, message): self.line.ask(topic_name, message)
            def post(self, url, json=None): self.line.ask(url, json)
        """,
    "program.py": """
        def run(device):
            device.set_current(2.0)
            device.publish("/arm/goal", {"speed": 1.0, "closed": True})
            device.publish("/arm/home", {})
            for level in (1, 3):
                device.post("http://cell/api/lamp", json={"on": True, "level": level})
            found = [device.read_flow_rate(), device.get_position(), device.get_orientation()]
            return found, device.get_state(), device.get_status().battery, device.measure_power()
        """,
    "tests/test_program.py": """
        import program, lab
        def test_it():
            device = lab.Device()
            assert program.run(device)[0][0] == (40.5, "sccm")
            assert device.run_task()[1] == 90.0
        """,
}


def write(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        (folder / name).parent.mkdir(exist_ok=True, parents=True)
        (folder / name).write_text(dedent(text))
    return folder


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = write(tmp_path_factory.mktemp("lab"), LAB)
    propose(folder)
    return folder


@pytest.fixture(scope="module")
def drafted(lab: Path) -> dict[str, Operation]:
    """The drafted operations, by the names of their methods."""
    found = load_vocabulary(["robot.toml"], lab).operations
    return {operation.target.rpartition(".")[2]: operation for operation in found}


def result(operation: Operation) -> dict[str, tuple[Any, ...]]:
    return {str(part.path): (part.kind, part.axis, part.unit, part.values) for part in operation.result}


def test_elements_of_a_tuple_mean_what_the_text_and_the_docstring_call_them(
    drafted: dict[str, Operation],
) -> None:
    assert result(drafted["read_flow_rate"]) == {"[0]": (Kind.NUMBER, None, None, None)}
    assert result(drafted["get_orientation"]) == {
        "[0]": (Kind.ORIENTATION, "x", "deg", None),
        "[1]": (Kind.ORIENTATION, "z", "deg", None),
    }
    assert "get_position" not in drafted  # latitude and longitude are no x and y


def test_what_a_task_ends_with_is_no_reading(drafted: dict[str, Operation]) -> None:
    assert "run_task" not in drafted


def test_a_member_of_an_enumeration_is_a_label_with_all_its_members(drafted: dict[str, Operation]) -> None:
    assert result(drafted["get_state"]) == {"": (Kind.LABEL, None, None, ("MOVING", "STOPPED"))}


def test_a_record_with_coordinates_is_read_by_all_its_fields(drafted: dict[str, Operation]) -> None:
    assert result(drafted["get_status"]) == {
        ".roll": (Kind.ORIENTATION, "x", "deg", None),
        ".battery": (Kind.NUMBER, None, None, None),
    }
    assert "speed_kept" not in drafted


def test_a_number_in_a_text_is_no_label(drafted: dict[str, Operation]) -> None:
    assert "measure_power" not in drafted


def test_setting_a_current_writes(drafted: dict[str, Operation]) -> None:
    assert drafted["set_current"].command


def test_what_is_sent_to_a_topic_or_an_address_of_http_is_a_command_with_its_fields(
    lab: Path, drafted: dict[str, Operation]
) -> None:
    written = {
        pattern.text: {str(part.path): part.values for part in pattern.arguments}
        for name in ("publish", "post")
        for pattern in drafted[name].patterns
    }
    assert written == {
        "/arm/goal": {"message['closed']": (False, True)},  # a speed without a unit is no line
        "/arm/home": {},
        "http://cell/api/lamp": {"json['on']": (False, True), "json['level']": (1, 3)},
    }
    assert mutabot(lab, "check").returncode == 0


def _three(a: float, b: list[float]) -> tuple[float, float, float]:
    low, high = a, a + 1
    if a:
        return low, round(high, 1), b[0]
    return low, float(high), b[1]


def _two(robot: Any) -> Any:
    """Where it is.

    :returns: (x, angle) of the tool
    """
    return robot.ask()


def _other(a: int) -> Any:
    def inner() -> tuple[int, int]:
        return a, a

    return inner


@pytest.mark.parametrize(
    ("function", "names"),
    [(_three, ["low", "high", ""]), (_two, ["x", "angle"]), (_other, []), (len, [])],
)
def test_elements_are_named_where_all_returned_tuples_agree(function: Any, names: list[str]) -> None:
    assert names_of_elements(function) == names


@pytest.mark.parametrize(
    ("doc", "table"),
    [
        (":param force: 0-255 (0 = least)", {"kind": "output", "range": [0.0, 255.0]}),
        ("force: raw value, 0..1023", {"kind": "output", "range": [0.0, 1023.0]}),
        ("force: 0 – 127", {"kind": "output", "range": [0.0, 127.0]}),
        ("force: over RS-485, since 2019-255", {"kind": "force", "unit": "N"}),
    ],
)
def test_a_range_in_a_docstring_is_written_in_several_ways(doc: str, table: dict[str, Any]) -> None:
    setting = NameContext(("move",), ("gripper",), doc, values=[40], names=frozenset({"position", "force"}))
    assert guess_argument("force", setting).table == table


def test_the_fingers_of_a_gripper_are_written_and_read_in_steps_of_its_drive() -> None:
    doc = "position: 0-255 (255 = closed)"
    setting = NameContext(("move",), ("gripper",), doc, values=[200], names=frozenset({"position"}))
    assert guess_argument("position", setting).table == {"kind": "output", "range": [0.0, 255.0]}
    read = NameContext(("get", "position"), ("gripper",), "0 = open, 255 = closed", values=[150, 90])
    assert guess_reading("get_position", read).table == {"kind": "number"}
    other = NameContext(("get", "position"), ("gripper",), "in millimetres", values=[0.5])
    assert guess_reading("get_position", other).table != {"kind": "number"}


def test_whole_numbers_of_an_encoder_have_no_length() -> None:
    def is_sure(value: list[float]) -> bool:
        part, context = WatchedPart("", length=3), NameContext(("read", "pos"), values=[value])
        return guess_elements(part, "read_pos", context, written=False)["[0:3]"].is_sure

    assert not is_sure([2048, 0, 1024])
    assert is_sure([300.5, 0.0, 200.0])


@pytest.mark.parametrize(
    ("name", "values", "kind"),
    [
        ("gyro_range", [2000, 500], None),
        ("get_range", [1.25, 0.5], "distance"),
        ("get_humidity", [40], "number"),
        ("flow_temperature", [21.5], "temperature"),
        ("flow_count", [3], None),
    ],
)
def test_what_a_sensor_measures_is_told_from_its_settings(name: str, values: list[Any], kind: str) -> None:
    guess = guess_reading(name, NameContext(words_of(name), values=values))
    assert guess.table.get("kind") == kind


def test_a_mode_is_set_and_no_label_of_a_sensor() -> None:
    def label(name: str) -> Guess:
        return guess_reading(name, NameContext(words_of(name), members=("A", "B")))

    assert label("get_state").table == {"kind": "label", "values": ["A", "B"]}
    assert label("get_mode").table == {}
    assert label("get_type").table.get("values") != ["A", "B"]


LIBRARY = """
    class Client:
        def __init__(self): self.bits = {}
        def write_bit(self, address, value): self.bits[address] = value
        def read_bit(self, address): return self.bits.get(address, False)
"""
LAYERS = {
    "main.py": """
        from station import Station
        def cycle(client):
            Station(client).fill()
            client.write_bit("M1", True)
        """,
    "station.py": """
        from vendor_plc import Client
        class Station:
            def __init__(self, client: Client): self.client = client
            def fill(self):
                if not self.client.read_bit("X1"):
                    self.client.write_bit("Y1", True)
        """,
    "tests/test_main.py": """
        import main, vendor_plc
        def test_it():
            client = vendor_plc.Client()
            main.cycle(client)
            assert client.bits == {"Y1": True, "M1": True}
        """,
}


@pytest.fixture
def layers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A program in two files, and the library that both call, which is installed elsewhere."""
    write(tmp_path / "installed", {"vendor_plc.py": LIBRARY})
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "installed"))
    return write(tmp_path / "line", LAYERS)


def test_files_that_import_the_library_of_the_program_are_part_of_it(
    layers: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    limits, watch = [], mutabot_init.propose.watch

    def watched(layout: Any, limit: float) -> Any:
        limits.append(limit)
        return watch(layout)

    monkeypatch.setattr(mutabot_init.propose, "watch", watched)
    monkeypatch.setattr(mutabot_init.propose, "monotonic", iter([0.0, 50.0]).__next__)
    told: list[str] = []
    lines = propose(layers, limit=180.0, notify=told.append)
    assert lines[0].startswith("program: main.py, station.py (guessed")
    assert "once more, with other files that import its library" in told[-1]
    found = {one.target.rpartition(".")[2]: one for one in load_vocabulary(["robot.toml"], layers).operations}
    assert [pattern.text for pattern in found["write_bit"].patterns] == ["Y1", "M1"]
    assert not found["read_bit"].command
    assert limits == [180.0, 130.0]  # both runs together have this time


def test_a_file_that_does_not_import_the_library_stays_below_the_program(layers: Path) -> None:
    layout = look(layers, [])
    assert [path.name for path in layout.program] == ["main.py"]
    assert [path.name for path in layout.importing({"vendor_plc"})] == ["station.py"]
    assert layout.importing({"another"}) == []


def test_what_a_package_hands_on_to_its_users_stands_in_for_the_device_all_the_same(tmp_path: Path) -> None:
    files = {
        "drive/__init__.py": "from drive import mock\nfrom drive.driver import Drive\n",
        "drive/driver.py": "import socket\nclass Drive:\n    def go(self, line): line.send(b'go')\n",
        "drive/mock.py": "from drive.driver import Drive\nclass Mock(Drive): ...\n",
        "tests/test_drive.py": "from drive.mock import Mock\ndef test_it(): Mock()\n",
    }
    layout = look(write(tmp_path, files), [])
    assert [path.name for path in layout.program] == ["driver.py"]


@pytest.mark.parametrize(
    ("name", "kind", "unit"),
    [
        ("velocity_rad_s", "speed", "rad/s"),
        ("speed_mm_s", "speed", "mm/s"),
        ("torque_nm", "torque", "Nm"),
        ("temperature_c", "temperature", "degC"),
        ("bus_voltage_v", "voltage", "V"),
        ("position_rad", "angle", "rad"),
        ("motor_c", None, None),
        ("m_s", None, None),
    ],
)
def test_units_at_the_end_of_a_name_are_written_in_words_and_letters(name: str, kind: str, unit: str) -> None:
    guess = guess_reading(name, NameContext(values=[1.5]))
    assert (guess.table.get("kind"), guess.table.get("unit")) == (kind, unit)
    assert guess.is_sure or kind is None
