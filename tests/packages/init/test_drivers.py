"""What drivers, PLC clients and their users call: which lines are drafted, and which are comments."""

from __future__ import annotations

import re
from pathlib import Path
from textwrap import dedent

import pytest

from mutabot.config.vocabulary import load_vocabulary
from mutabot.model.operation import Operation
from mutabot_init.guess import NameContext, guess_argument, guess_reading
from mutabot_init.layout import look
from mutabot_init.propose import propose
from mutabot_init.words import words_of
from tests.command import mutabot


def draft(folder: Path, files: dict[str, str]) -> str:
    """The vocabulary that init writes for a project."""
    for name, text in files.items():
        (folder / name).parent.mkdir(exist_ok=True, parents=True)
        (folder / name).write_text(dedent(text))
    propose(folder)
    return (folder / "robot.toml").read_text()


def operations(folder: Path) -> dict[str, Operation]:
    """The operations of a draft, by their targets."""
    return {found.target: found for found in load_vocabulary(["robot.toml"], folder).operations}


PLC = {
    "melsec.py": """
        class Client:
            def __init__(self): self.bits = {"X20": [1], "Y10": [0]}
            def batchread_bits(self, device, size): return self.bits[device][:size]
            def batchwrite_bits(self, device, values): self.bits.update({device: list(values), "X20": [0]})
            def close(self): self.bits.clear()
        """,
    "filling.py": """
        def fill(plc):
            while plc.batchread_bits("X20", 1)[0]:
                plc.batchwrite_bits("Y10", [1])
            plc.batchwrite_bits(device="Y10", values=[0])
            plc.close()
        """,
    "tests/test_filling.py": """
        import filling, melsec
        def test_it():
            plc = melsec.Client()
            filling.fill(plc)
            assert plc.bits == {}
        """,
}


def test_what_is_written_to_an_address_of_a_controller_is_a_command_whatever_the_argument_is_called(
    tmp_path: Path,
) -> None:
    text = draft(tmp_path, PLC)
    write, read = (operations(tmp_path)[f"melsec:Client.batch{name}_bits"] for name in ("write", "read"))
    assert [(str(found.path), found.values) for found in write.patterns[0].arguments] == [
        ("values[0]", (1, 0))
    ]
    assert write.command
    assert write.patterns[0].text == "Y10"
    assert [(str(found.path), found.values) for found in read.patterns[0].result] == [("[0]", (0, 1))]
    assert not read.command
    assert mutabot(tmp_path, "check").returncode == 0
    # what closes, and nothing opens, may be a gate or a socket
    assert '# call = "melsec:Client.close"\n# command = true  # question: does it move something' in text


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("batchread_bits", ("batch", "read", "bits")),
        ("randomwrite", ("random", "write")),
        ("multithread", ("multithread",)),
        ("spread", ("spread",)),
        ("rewrite", ("rewrite",)),
    ],
)
def test_a_joined_word_that_ends_in_read_or_write_is_two(name: str, expected: tuple[str, ...]) -> None:
    assert words_of(name) == expected


METER = {
    "flow/__init__.py": "",
    "flow/mock.py": """
        from flow.link import Link
        class Fake(Link):
            def write_and_read(self, command): return "1.5" if command == "A" else ""
        """,
    "flow/link.py": """
        class Link:
            def write_and_read(self, command): raise NotImplementedError
        """,
    "flow/driver.py": """
        from flow import link
        class Meter:
            def __init__(self): self.link = link.Link()
            def flow(self): return float(self.link.write_and_read("A"))
            def set_flow(self, value): self.link.write_and_read(f"AS {value:.2f}")
        """,
    "flow/extra.py": "from flow.driver import Meter\nclass Other(Meter):\n    size = 2\n",
    "tests/test_driver.py": """
        from unittest import mock
        from flow import driver, extra
        from flow.mock import Fake
        def test_it():
            with mock.patch("flow.link.Link", Fake):
                meter = extra.Other()
                meter.set_flow(2.5)
                assert meter.flow() == 1.5
        """,
}


def test_a_file_that_stands_in_for_a_device_is_no_program(tmp_path: Path) -> None:
    draft(tmp_path, METER)
    layout = look(tmp_path, [])
    assert "mock.py" not in {path.name for path in (*layout.program, *layout.below)}
    assert "mock.py" in {path.name for path in layout.tests}
    assert layout.arguments == ["tests"]


def test_a_stand_in_that_the_program_imports_belongs_to_it(tmp_path: Path) -> None:
    files = {**METER, "flow/extra.py": "from flow.mock import Fake\nclass Other(Fake):\n    size = 2\n"}
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(dedent(text))
    assert "mock.py" not in {path.name for path in look(tmp_path, []).tests}


def test_where_the_program_calls_no_robot_what_it_imports_is_watched_as_well(tmp_path: Path) -> None:
    draft(tmp_path, METER)
    assert 'program = ["flow/extra.py", "flow/driver.py"]' in (tmp_path / "mutabot.toml").read_text()
    assert [*operations(tmp_path)] == ["flow.link:Link.write_and_read"]


def test_of_what_the_program_imports_only_what_reaches_a_stand_in_of_the_tests_is_an_operation(
    tmp_path: Path,
) -> None:
    driver = """
        from flow import codec, link
        class Meter:
            def __init__(self): self.link = link.Link()
            def flow(self): return float(self.link.write_and_read("A"))
            def set_flow(self, value): self.link.write_and_read(f"AS {codec.push_down(value)}")
        """
    codec = "LOG = []\ndef push_down(value):\n    LOG.append(value)\n    return f'{value:.2f}'\n"
    draft(tmp_path, {**METER, "flow/driver.py": driver, "flow/codec.py": codec})
    assert [*operations(tmp_path)] == ["flow.link:Link.write_and_read"]


def test_where_what_the_program_imports_reaches_no_stand_in_either_the_first_draft_is_kept(
    tmp_path: Path,
) -> None:
    files = {
        "tool/__init__.py": "",
        "tool/top.py": "from tool import middle\nSIZE = middle.SIZE\n",
        "tool/middle.py": "from tool import low\nSIZE = 1\ndef run(): low.push_down(2)\n",
        "tool/low.py": "LOG = []\ndef push_down(value): LOG.append(value)\n",
        "tests/test_top.py": "from tool import middle, top\ndef test_it(): middle.run()\n",
    }
    text = draft(tmp_path, files)
    assert 'program = ["tool/top.py"]' in (tmp_path / "mutabot.toml").read_text()
    assert "push_down" not in text


def test_a_text_that_is_answered_is_a_command_if_it_says_a_number_and_else_a_question(tmp_path: Path) -> None:
    text = draft(tmp_path, METER)
    patterns = operations(tmp_path)["flow.link:Link.write_and_read"].patterns
    assert [pattern.text for pattern in patterns] == ["AS {value:g}"]
    assert '  # { text = "A" },  # question: does it command, or only ask?' in text


def test_a_mock_in_the_place_of_an_objects_method_is_what_it_replaces(tmp_path: Path) -> None:
    files = {
        "link.py": "class Link:\n    def send_rpc(self, rpc): raise OSError\n",
        "bot.py": """
            class Bot:
                def __init__(self, link): self.link = link
                def water(self, plant): return self.link.send_rpc({"water": plant})
            """,
        "test_bot.py": """
            from unittest.mock import AsyncMock, MagicMock, patch
            from bot import Bot
            from link import Link
            def test_object():
                link = Link()
                link.send_rpc = MagicMock()
                Bot(link).water(4)
                link.send_rpc.assert_called_once()
            def test_class():
                with patch.object(Link, "send_rpc", new_callable=AsyncMock):
                    Bot(Link()).water(5).close()
            """,
    }
    draft(tmp_path, files)
    assert [*operations(tmp_path)] == ["link:Link.send_rpc"]
    assert "2 passed" in mutabot(tmp_path, "check").stdout


NO_COMMANDS = {
    "lab.py": """
        class Metrics:
            def __init__(self): self.total = 0.0
            def record_write(self, duration): self.total += duration

        class Reply:
            def __init__(self, data): self.data = data
            def parse(self): LOG.append(self.data); return {"type": self.data[0], "state": "ok"}

        class Robot:
            def __init__(self): self.on = False
            def lights_on(self): LOG.append("?"); return self.on
            def set_lights(self, on): self.on = on
            def raise_for_error(self): LOG.append("!")
            def open_transport(self): LOG.append("+"); return self
            def modules(self): LOG.append("?"); return {"type": "shaker", "has_update": False}

        class Handler:
            def on_home(self, robot): LOG.append(robot)
            def handle(self, message): LOG.append(message)
            def notify(self, event, delay): LOG.append((event, delay))
            def adopt_park(self, place): LOG.append(place)

        def prepare_write(values): LOG.append(values); return bytes(values)

        LOG = []
        """,
    "program.py": """
        import lab
        def run():
            robot, metrics, handler = lab.Robot(), lab.Metrics(), lab.Handler()
            robot.open_transport()
            robot.set_lights(True)
            assert robot.lights_on()
            robot.modules()
            robot.raise_for_error()
            metrics.record_write(0.25)
            handler.on_home(robot)
            handler.handle("stop 4")
            handler.notify("moved", delay=0.5)
            handler.adopt_park("left")
            return lab.Reply(lab.prepare_write([1, 2])).parse()
        """,
    "test_program.py": "import program\ndef test_it(): assert program.run()['type'] == 1\n",
}


def test_what_counts_builds_decodes_raises_connects_or_is_told_is_no_command(tmp_path: Path) -> None:
    text = draft(tmp_path, NO_COMMANDS)
    found = operations(tmp_path)
    assert [*found] == ["lab:Robot.set_lights", "lab:Robot.lights_on"]
    assert not found["lab:Robot.lights_on"].command
    assert re.findall(r"^\S*(?:type|update).*kind", text, re.MULTILINE) == []


def test_texts_with_different_answers_are_asked_about_and_those_that_are_confirmed_are_commands(
    tmp_path: Path,
) -> None:
    files = {
        "link.py": """
            class Link:
                def __init__(self): self.sent = []
                def send(self, command):
                    self.sent.append(command)
                    return {"ver": "9.4", "curpos": "1;2"}.get(command, "ok")
                def send_order(self, order): self.sent.append(order); return "ok"
            """,
        "program.py": """
            def run(link):
                link.send("ver"); link.send("curpos"); link.send("lift 4"); link.send("100.0")
                link.send_order("open"); link.send_order("stop")
            """,
        "test_program.py": "import link, program\ndef test_it(): program.run(link.Link())\n",
    }
    draft(tmp_path, files)
    found = {name: [pattern.text for pattern in one.patterns] for name, one in operations(tmp_path).items()}
    assert found == {"link:Link.send": ["lift {height:g}"], "link:Link.send_order": ["open", "stop"]}


def test_what_kind_of_message_it_is_is_no_reading() -> None:
    assert not guess_reading(
        "is_sensor", NameContext(("is", "sensor"), ("sensor", "frame"), values=[True])
    ).table
    assert guess_reading("is_moving", NameContext(("is", "moving"), ("arm",), values=[True])).table


def test_a_time_beside_a_verb_of_motion_is_no_motion() -> None:
    assert not guess_argument("x_ms", NameContext(("move",), values=[20])).table


@pytest.mark.parametrize(
    ("words", "name", "doc", "values", "expected"),
    [
        ("set_diameter", "diameter_mm", "", [14.4], None),
        ("move_relative", "distance", "distance: in encoder steps", [17152], "counts of the drive"),
        ("move_relative", "distance", "distance: how far", [17152], "mm"),
        ("move", "speed_perc", "", [40], "percent"),
        ("move", "speed_perc", "", [0.4], "percent, or a fraction?"),
    ],
)
def test_a_size_is_no_way_and_counts_and_shares_are_no_units_of_length(
    words: str, name: str, doc: str, values: list[float], expected: str | None
) -> None:
    guess = guess_argument(name, NameContext(words_of(words), doc=doc, values=values))
    if expected is None:
        assert not guess.table
    elif guess.questions:
        assert expected in guess.questions[0]
    else:
        assert guess.table["unit"] == expected


@pytest.mark.parametrize(
    ("call", "mode"),
    [
        ("move_to_relative_point", "by"),
        ("move_relative_to", None),
        ("move_to_point", "to"),
        ("run_for_distance", "by"),
        ("wait_for_point", None),
    ],
)
def test_a_relative_move_is_a_change_unless_it_is_relative_to_something(call: str, mode: str | None) -> None:
    guess = guess_argument("x", NameContext(words_of(call), values=[0.25]))
    assert guess.table["mode"] == mode or any("a change" in question for question in guess.questions)


def test_an_unknown_call_of_an_installed_library_is_asked_about(tmp_path: Path) -> None:
    files = {
        "program.py": "import yaml_like\ndef run(): yaml_like.frobnicate(1)\n",
        "test_program.py": "import program\ndef test_it(): program.run()\n",
        "../site/yaml_like.py": "LOG = []\ndef frobnicate(value): LOG.append(value)\n",
        "pytest.ini": "[pytest]\npythonpath = . ../site\n",
    }
    (tmp_path / "project").mkdir()
    text = draft(tmp_path / "project", files)
    assert (
        '# call = "yaml_like:frobnicate"\n# command = true  # question: does it make the robot act?' in text
    )


@pytest.mark.parametrize("name", ["scan_length", "slit_width", "length_mm"])
@pytest.mark.parametrize("call", ["set_profile", "profile"])
def test_a_size_without_a_verb_of_motion_has_a_mode_and_is_asked_about(call: str, name: str) -> None:
    guess = guess_argument(name, NameContext(words_of(call), values=[5000]))
    assert guess.questions
    assert "mode" in guess.table


MOTORS = {
    "motors.py": """
        import random
        BUS = []
        class Motor:
            def __init__(self, name): self.name, self.angle, self._limp = name, 12.5, True
            def __repr__(self): return f"<Motor {self.name} pos={self.angle}>"
            @property
            def limp(self): return self._limp
            @limp.setter
            def limp(self, value): BUS.append(value); self._limp = value
            def on_for_seconds(self, seconds, block=True): BUS.append(seconds)
            def on_stalled(self, action): BUS.append(action)
            def run_forever(self): BUS.append("run")
            def coast(self): BUS.append("coast")
            def run_for_degrees(self, degrees): BUS.append(degrees)
        class MotorThread:
            def run(self): BUS.append("loop")
        class Task:
            def run_all(self): BUS.append("all")
        class Arm:
            def __init__(self): self.last = []
            def random_joints(self, count=3): self.last = [random.random()] * count; return self.last
            def ik(self, pose, q): self.last = q; return q
        """,
    "program.py": """
        def run(left, right, arm, *others):
            for motor in (left, right):
                motor.limp = False
            left.on_for_seconds(0.5)
            left.on_stalled("beep")
            left.run_forever()
            left.coast()
            left.run_for_degrees(90)
            for other in others:
                getattr(other, "run", None) and other.run()
            others[1].run_all()
            return arm.ik([0.1, 0.2, 0.3], q=arm.random_joints())
        """,
    "test_program.py": """
        import motors, program
        def test_it():
            both = motors.Motor("elbow"), motors.Motor("wrist")
            assert program.run(*both, motors.Arm(), motors.MotorThread(), motors.Task())
        """,
}


@pytest.fixture(scope="module")
def motors(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, dict[str, Operation]]:
    folder = tmp_path_factory.mktemp("motors")
    return draft(folder, MOTORS), operations(folder)


def test_a_motor_is_switched_on_for_a_while_and_runs_and_coasts_and_no_event_thread_or_task_does(
    motors: tuple[str, dict[str, Operation]],
) -> None:
    _, found = motors
    assert found.keys() == {
        f"motors:Motor.{name}" for name in ("on_for_seconds", "run_forever", "coast", "run_for_degrees")
    }
    assert [part.mode for part in found["motors:Motor.run_for_degrees"].arguments] == ["by"]


def test_no_command_is_known_by_the_text_of_an_object_that_says_where_it_is(
    motors: tuple[str, dict[str, Operation]],
) -> None:
    assert "pos=12.5" not in motors[0]


def test_what_an_inverse_or_a_random_pose_is_computed_from_is_no_command(
    motors: tuple[str, dict[str, Operation]],
) -> None:
    assert "motors:Arm" not in motors[0]
