"""Campaigns in hardware mode, on a robot at the other end of a connection."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from mutabot.cli.app import main
from tests.campaign.project import outcomes
from tests.packages.hardware.robot_server import GUARD, RobotServer, robot_server, write_project

HARDWARE = (
    GUARD
    + """
    [hardware]
    safe_state = "cell_io:retreat"
    heartbeat = "cell_io:is_alive"
    period = 0.1
    """
)
PROGRAM = """
    def place(arm):
        arm.move_to(0.4, 0.6)
        arm.grip(True)
    """
#: the same, sending for eight seconds
LONG = """
    import time

    def place(arm):
        arm.move_to(0.4, 0.6)
        for _ in range(400):
            arm.grip(True)
            time.sleep(0.02)
    """
TESTS = """
    import program
    from robot import Arm

    def test_it_is_placed():
        arm = Arm()
        program.place(arm)
        assert arm.pose() == {"x": 0.4, "z": 0.6}
    """
CELL_IO = """
    import os
    import time
    from pathlib import Path

    def retreat():
        with open("safe.log", "a") as file:
            file.write(f"{time.monotonic()}\\n")

    def is_alive():
        if Path("fault").exists():
            raise RuntimeError("drive 2 is off")
    """


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Iterator[RobotServer]:
    with robot_server() as found:
        monkeypatch.setenv("ROBOT_PORT", str(found.port))
        yield found


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return write_project(tmp_path, PROGRAM, TESTS, HARDWARE, CELL_IO)


def mutabot(folder: Path, *words: str) -> int:
    code = main(["-C", str(folder), *words])
    assert isinstance(code, int)
    return code


def log(folder: Path) -> list[dict[str, object]]:
    text = (folder / ".mutabot" / "hardware.jsonl").read_text(encoding="utf-8")
    return [json.loads(line) for line in text.splitlines()]


@pytest.mark.whole
def test_a_campaign_runs_one_mutant_at_a_time_between_safe_states(folder: Path, server: RobotServer) -> None:
    assert mutabot(folder, "run", "--hardware", "yes", "-o", "hardware.stop=[]") == 0
    told = ["begin" if "begin" in row else "end" if "end" in row else row.get("safe") for row in log(folder)
            if "sent" not in row]  # fmt: skip
    assert told == ["before", "begin", "after", "end"] * (len(told) // 4)
    assert len((folder / "safe.log").read_text(encoding="utf-8").splitlines()) == len(told) // 2
    found = outcomes(folder / ".mutabot" / "journal.sqlite")
    assert {outcome.engine for outcome in found} == {"replay"}
    assert [line for line in server.lines() if line.startswith("at") and "-" in line] == []


@pytest.mark.whole
def test_every_command_that_reached_the_robot_is_in_the_log(folder: Path, server: RobotServer) -> None:
    mutabot(folder, "run", "--hardware", "yes", "-o", "hardware.stop=[]")
    server.settle()
    sent = [entry["sent"] for entry in log(folder) if "sent" in entry]
    assert sent.count("robot:Arm.move_to") == sum(line.startswith("at") for line in server.lines())
    assert sent.count("robot:Arm.grip") == sum(line in ("open", "closed") for line in server.lines())


@pytest.mark.whole
def test_a_surprise_stops_the_campaign_and_the_next_run_goes_on_after_it(
    folder: Path, server: RobotServer, capsys: pytest.CaptureFixture[str]
) -> None:
    assert mutabot(folder, "run", "--hardware", "yes") == 4
    assert "stopped at a surprise: a guard kept a command back" in capsys.readouterr().err
    known = {outcome.mutant for outcome in outcomes(folder / ".mutabot" / "journal.sqlite")}
    before = len([entry for entry in log(folder) if "begin" in entry and entry.get("mutant") in known])
    while mutabot(folder, "run", "--hardware", "yes") == 4:
        pass
    again = [entry["mutant"] for entry in log(folder) if "begin" in entry and entry.get("mutant") in known]
    assert (len(again), before) == (len(known), len(known))


@pytest.mark.whole
def test_a_missing_heartbeat_stops_the_campaign_at_once(
    folder: Path, server: RobotServer, capsys: pytest.CaptureFixture[str]
) -> None:
    slow = PROGRAM.replace(
        "arm.grip(True)", "[arm.grip(True) for _ in range(400) if not __import__('time').sleep(0.02)]"
    )
    write_project(folder, slow, TESTS, HARDWARE, CELL_IO)
    process = start(folder)
    wait_for(lambda: len(server.received) > 20)
    (folder / "fault").touch()
    came = time.monotonic()
    _, error = process.communicate(timeout=120)
    assert process.returncode == 4
    assert "no heartbeat: cell_io:is_alive raises RuntimeError: drive 2 is off" in error
    late = [
        message for message in server.received if message[0] > came + 5.0
    ]  # a period, the question, and a busy machine
    assert late == []


@pytest.mark.parametrize(
    "number",
    [
        signal.SIGINT,
        *(
            pytest.param(signal_number, marks=pytest.mark.whole)
            for signal_number in (signal.SIGTERM, signal.SIGKILL)
        ),
    ],
)
def test_nothing_more_is_sent_when_the_controller_ends(
    folder: Path, server: RobotServer, number: signal.Signals
) -> None:
    slow = PROGRAM.replace(
        "arm.grip(True)", "[arm.grip(True) for _ in range(400) if not __import__('time').sleep(0.02)]"
    )
    write_project(folder, slow, TESTS, HARDWARE, CELL_IO)
    process = start(folder)
    wait_for(lambda: len(server.received) > 20)
    process.send_signal(number)
    process.communicate(timeout=120)
    count = len(server.received)
    time.sleep(1.0)
    assert len(server.received) - count <= (1 if number == signal.SIGKILL else 0)
    if number != signal.SIGKILL:
        assert "stop" in log(folder)[-2] or "stop" in log(folder)[-1]
        assert any(entry.get("safe") == "after" for entry in log(folder))


@pytest.mark.whole
def test_a_motion_that_was_stopped_is_not_repeated_unasked(folder: Path, server: RobotServer) -> None:
    mutabot(folder, "run", "--hardware", "yes", "-o", "hardware.stop=[]")
    first = outcomes(folder / ".mutabot" / "journal.sqlite")
    with (folder / ".mutabot" / "hardware.jsonl").open("a", encoding="utf-8") as file:
        file.write(json.dumps({"begin": True, "mutant": first[0].mutant}) + "\n")
    mutabot(folder, "run", "--fresh", "--hardware", "yes", "-o", "hardware.stop=[]")
    found = {outcome.mutant: outcome for outcome in outcomes(folder / ".mutabot" / "journal.sqlite")}
    assert "no motion is repeated unasked" in str(found[first[0].mutant].message)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("-o", "guard.box=[]", "-o", "guard.limit=[]", "--hardware", "yes"), "nothing runs without a guard"),
        (
            ("-o", 'guard.limit=[{kind="force",max=9}]', "--hardware", "yes"),
            "guard.limit concerns no quantity that the vocabulary describes: kind = force, max = 9.0",
        ),
        (
            ("-o", 'guard.forbid=["robot:Arm.halt"]', "--hardware", "yes"),
            "guard: the vocabulary describes no command robot:Arm.halt",
        ),
        (("--engine", "fork", "--hardware", "yes"), "copies of a program cannot share a robot"),
        (("--hardware", "perhaps"), "--hardware perhaps: ask, yes, repeat"),
        (("-o", "hardware.safe_state='cell_io:nowhere'", "--hardware", "yes"), "has no attribute 'nowhere'"),
        ((), "each mutant needs a confirmation, but this is no terminal"),
    ],
)
def test_what_is_missing_is_reported_before_anything_moves(
    folder: Path, server: RobotServer, words: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert mutabot(folder, "run", *words) == 2
    assert said in capsys.readouterr().err
    assert server.received == []


@pytest.mark.parametrize("surprises", ["[]", pytest.param('["guard"]', marks=pytest.mark.whole)])
def test_a_guard_that_the_original_violates_is_reported_before_a_mutant_moves(
    folder: Path, server: RobotServer, surprises: str, capsys: pytest.CaptureFixture[str]
) -> None:
    narrow = ("-o", "guard.box=[{x=[0.5,0.7]}]", "-o", f"hardware.stop={surprises}")
    assert mutabot(folder, "run", "--hardware", "yes", *narrow) != 0
    assert "x leads to 0.4 m, the workspace is 0.5 to 0.7 m" in capsys.readouterr().err
    assert [entry for entry in log(folder) if "mutant" in entry or "sent" in entry] == []
    assert server.received == []


def start(folder: Path) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "mutabot", "-C", str(folder), "run", "--hardware", "yes"]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ}
    )


def wait_for(is_there: object) -> None:
    assert callable(is_there)
    until = time.monotonic() + 120.0
    while not is_there():
        assert time.monotonic() < until
        time.sleep(0.01)
