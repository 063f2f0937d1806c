"""A stop at any moment: nothing more goes out."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from textwrap import dedent
from types import SimpleNamespace

import pytest

from mutabot.model import Call, Operation
from mutabot.model.operation import Pattern
from mutabot_hardware.command_guard import SOCKET_VARIABLE, HardwareGuard
from mutabot_hardware.log import HardwareLog
from mutabot_hardware.permission import Permissions

MOVE = Operation("robot:move", command=True)
#: a sender that asks the guard before each line, what gets the lines, and stops at random moments
MOMENTS = """
    import contextlib, json, os, random, signal, socket, sys, time
    from pathlib import Path
    from mutabot.model import Call, Operation
    from mutabot_hardware.permission import Permissions
    from mutabot_hardware.log import HardwareLog
    from mutabot_hardware.command_guard import HardwareGuard

    many, folder = int(sys.argv[1]), Path(sys.argv[2])
    listening = socket.create_server(("127.0.0.1", 0))
    draw, found = random.Random(1).uniform, []
    for number in range(many):
        stack = contextlib.ExitStack()
        leave = stack.enter_context(Permissions(HardwareLog(folder / "log")))
        stack.enter_context(leave.given())
        child = os.fork()
        if child == 0:
            connection = socket.create_connection(listening.getsockname())
            guard, call = HardwareGuard({"enabled": True}), Call(Operation("robot:move", command=True))
            while guard.why_not(call, {}) is None:
                connection.sendall(b"%r\\n" % time.monotonic())
            time.sleep(10.0)
            os._exit(0)
        connection, _ = listening.accept()
        lines = connection.makefile("rb")
        first = lines.readline()
        time.sleep(draw(0.0, 0.02))
        leave.stop("now")
        stopped = time.monotonic()
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        ended = time.monotonic()
        sent = [float(line) for line in lines if line.endswith(b"\\n")]
        connection.close()
        stack.close()
        found.append([sum(one > stopped for one in sent), sum(one > ended for one in sent), len(sent)])
    print(json.dumps(found))
    """


@pytest.mark.parametrize("many", [50, pytest.param(1000, marks=pytest.mark.whole)])
def test_after_a_stop_at_a_random_moment_nothing_more_is_sent(tmp_path: Path, many: int) -> None:
    command = [sys.executable, "-c", dedent(MOMENTS), str(many), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found = json.loads(done.stdout)
    assert len(found) == many
    # a command that had passed the guard when the stop came may still be on its way to the connection
    assert max(after_stop for after_stop, _, _ in found) <= 1
    assert sum(after_end for _, after_end, _ in found) == 0
    assert sum(sent for _, _, sent in found) > many  # it was stopped in the midst


@pytest.fixture
def leave(tmp_path: Path) -> Iterator[Permissions]:
    with Permissions(HardwareLog(tmp_path / "log")) as found:
        yield found


def why(call: Call = Call(MOVE), unread: Mapping[str, str] = {}) -> str | None:  # noqa: B008
    return HardwareGuard({"enabled": True}).why_not(call, unread)


def test_nothing_goes_out_before_a_run_and_after_it(leave: Permissions) -> None:
    assert why() == "no run has begun"
    with leave.given():
        assert why() is None
    assert why() == "no run has begun"


def test_after_a_stop_no_run_goes_out_any_more(leave: Permissions) -> None:
    with leave.given():
        leave.stop("a surprise")
        leave.stop("something else")
        assert why() == "a surprise"
    with leave.given():
        assert why() == "a surprise"


def test_each_command_is_in_the_log_before_it_goes_out(leave: Permissions, tmp_path: Path) -> None:
    with leave.given():
        assert why(Call(MOVE, values={"x": 0.3})) is None
        line = json.loads((tmp_path / "log").read_text(encoding="utf-8"))
        assert (line["sent"], line["values"]) == ("robot:move", {"x": 0.3})


def test_a_default_timeout_of_sockets_does_not_keep_a_command_back(leave: Permissions) -> None:
    socket.setdefaulttimeout(1.0)  # as xarm-python-sdk does
    try:
        with leave.given():
            guard = HardwareGuard({"enabled": True})
            assert [guard.why_not(Call(MOVE), {}) for _ in range(20)] == [None] * 20
    finally:
        socket.setdefaulttimeout(None)


def test_what_cannot_be_written_to_the_log_does_not_go_out(leave: Permissions, tmp_path: Path) -> None:
    with leave.given():
        (tmp_path / "log").unlink()
        assert "the log does not have it" in str(why())


def test_what_cannot_be_read_does_not_go_out(leave: Permissions) -> None:
    with leave.given():
        text = Operation("link:send", patterns=(Pattern("height {z:g}"),))
        assert "none of the commands that the vocabulary describes" in str(why(Call(text)))
        assert why(unread={"arguments.x": "it is a box"}) == "it cannot be read: it is a box"


def test_a_command_of_which_no_argument_is_described_goes_out_with_flags_alone(leave: Permissions) -> None:
    def given(*args: object, **kwargs: object) -> Call:
        return Call(MOVE, payload=SimpleNamespace(args=args, kwargs=kwargs))

    with leave.given():
        assert why(given(wait=True)) is None
        assert why(given(True, None)) is None
        assert why(given("movej([0])")) == (
            "it cannot be read: the vocabulary describes none of its arguments, and it gets 'movej([0])'"
        )
        assert len(str(why(given([9.0] * 100, wait=True)))) < 150  # a message is no list


def test_a_controller_that_is_gone_lets_nothing_pass(leave: Permissions) -> None:
    with leave.given():
        guard = HardwareGuard({"enabled": True})
        assert guard.why_not(Call(MOVE), {}) is None
        leave.__exit__()
        os.environ[SOCKET_VARIABLE] = "mutabot-hardware-nobody"
        assert "the controller does not answer" in str(why())
        assert guard.why_not(Call(MOVE), {}) == "the campaign is over"


def test_outside_a_hardware_campaign_nothing_goes_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(SOCKET_VARIABLE, raising=False)
    assert why() == "in hardware mode commands go out from campaigns with --hardware only"
    assert HardwareGuard({"enabled": False}).why_not(Call(MOVE), {}) is None
