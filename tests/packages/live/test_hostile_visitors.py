"""Whatever is sent to the page, or held open there: the page stays, and the campaign does not notice."""

from __future__ import annotations

import contextlib
import random
import re
import resource
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from mutabot.errors import ExitCode
from mutabot.journal.reader import JournalReader
from mutabot_live import server as serving
from mutabot_live.pages import Pages
from mutabot_live.server import MOST, LiveFeed, Server
from packages.live.visits import PATIENCE, ask
from report.html import reports
from tests.campaign.project import write_project

IDLE, MESSAGES = 1010, 1000
#: open files that the campaign may have: enough for one worker and a page, far too few for all connections
FILES = 320
MISSION = "def run(arm):\n    arm.move_by(0.25)\n    arm.move_by(-0.5)\n"
TESTS = """
    import time
    from pathlib import Path

    import mission
    from robot import Arm

    def test_it_is_where_it_should_be():
        Path("is_here").touch()
        while not Path("go_on").exists():
            time.sleep(0.02)
        arm = Arm()
        mission.run(arm)
        assert arm.x == -0.25
"""


def place(address: str) -> tuple[str, int]:
    parts = urlsplit(address)
    assert parts.hostname is not None
    assert parts.port is not None
    return parts.hostname, parts.port


def messages(address: str, count: int, chance: random.Random) -> Iterator[bytes]:
    """Random bytes, requests of which something is wrong, and halves of requests."""
    path, port = urlsplit(address).path, urlsplit(address).port
    host = f"Host: 127.0.0.1:{port}\r\n"
    for number in range(count):
        request = (
            f"GET {path}{chance.choice(('', 'events', 'data/campaign.js', '../x'))} HTTP/1.1\r\n{host}"
            f"Last-Event-ID: {chance.choice(('1', '9' * 40, '-1', 'x'))}\r\n\r\n"
        ).encode()
        match number % 8:
            case 0:
                yield chance.randbytes(chance.randrange(1, 3000))
            case 1:  # bytes that are others
                changed = bytearray(request)
                for _ in range(chance.randrange(1, 6)):
                    changed[chance.randrange(len(changed))] = chance.randrange(256)
                yield bytes(changed)
            case 2:
                yield request[: chance.randrange(1, len(request))]
            case 3:
                yield b"GET / HTTP/1.1\r\n" + b"X: " + b"y" * chance.randrange(70_000) + b"\r\n\r\n"
            case 4:
                yield b"GET / HTTP/1.1\r\n" + b"".join(b"X%d: y\r\n" % n for n in range(150)) + b"\r\n"
            case 5:
                method = chance.choice(("PUT", "HEAD", "", "\0", "POST" * 999))
                yield f"{method} {path} HTTP/{'9' * chance.randrange(1, 9)}.1\r\n{host}\r\n".encode()
            case 6:  # a command from nowhere, with more to come that never does
                yield f"POST {path}stop HTTP/1.1\r\n{host}Content-Length: {'9' * 30}\r\n\r\n".encode()
            case _:
                yield request + request


def send(address: str, message: bytes) -> None:
    """A message, after which nothing is read, or a little."""
    with contextlib.suppress(OSError), socket.create_connection(place(address), PATIENCE) as connection:
        connection.sendall(message)
        connection.settimeout(0.01)
        connection.recv(100)


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Server]:
    journal, _ = reports.campaign(tmp_path)
    feed = LiveFeed()
    given: list[str] = []
    server = Server(Pages(journal, "cell", lambda: 1), feed, {"stop": lambda: given.append("stop")})
    yield server
    feed.close()
    server.close()
    assert given == []


@pytest.mark.whole
def test_a_thousand_messages_of_all_kinds_leave_the_page_as_it_was(served: Server) -> None:
    before = ask(served.address).text
    for message in messages(served.address, MESSAGES, random.Random(24)):
        send(served.address, message)
    assert answered(served.address) == before


def answered(address: str) -> str:
    """The page, once there is a place for one more connection."""
    until = time.monotonic() + PATIENCE
    while True:
        try:
            return ask(address).text
        except OSError:
            assert time.monotonic() < until
            time.sleep(0.05)


def is_closed(connection: socket.socket, *, wait: bool = True) -> bool:
    connection.settimeout(PATIENCE if wait else 0.0)
    try:
        return connection.recv(1) == b""
    except BlockingIOError:
        return False
    except ConnectionError:
        return True


def test_there_are_so_many_connections_at_a_time_and_no_more(
    served: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(serving, "WITHIN", 10 * PATIENCE)
    with contextlib.ExitStack() as stack:
        held = [
            stack.enter_context(socket.create_connection(place(served.address), PATIENCE))
            for _ in range(MOST + 5)
        ]
        assert all(map(is_closed, held[MOST:]))
        assert not any(is_closed(held_connection, wait=False) for held_connection in held[:MOST])
        for connection in held[:10]:
            connection.close()
        assert "<html" in answered(served.address)


def dribble(connection: socket.socket) -> None:
    """Each byte comes in time, the request never."""
    until = time.monotonic() + PATIENCE
    while time.monotonic() < until:
        connection.sendall(b"y")
        time.sleep(0.02)


def test_a_request_that_never_ends_does(served: Server, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(serving, "WITHIN", 0.5)
    with socket.create_connection(place(served.address), PATIENCE) as connection:
        connection.sendall(b"GET / HTTP/1.1\r\nX: ")
        with pytest.raises(ConnectionError):
            dribble(connection)
    assert "<html" in answered(served.address)


def wait_for(file: Path, process: subprocess.Popen[str]) -> None:
    until = time.monotonic() + PATIENCE
    while not file.exists():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < until
        time.sleep(0.02)


@pytest.mark.whole
def test_a_campaign_loses_nothing_to_a_thousand_connections_and_messages(tmp_path: Path) -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard != resource.RLIM_INFINITY and hard < 2 * IDLE:
        pytest.skip(f"no more than {hard} files may be open here")
    write_project(tmp_path, MISSION, TESTS)
    configuration = tmp_path / "mutabot.toml"
    configuration.write_text(configuration.read_text() + "private_files = false\n")
    few = f"import resource as r, runpy; r.setrlimit(r.RLIMIT_NOFILE, ({FILES}, {FILES}))"
    few += "; runpy.run_module('mutabot', run_name='__main__', alter_sys=True)"
    words = [sys.executable, "-c", few, "live", "-o", "repeats=false", "-j", "1"]
    process = subprocess.Popen(words, cwd=tmp_path, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, 2 * IDLE), hard))
    try:
        assert process.stderr is not None
        found = re.fullmatch(r"mutabot: live at (http://127\.0\.0\.1:\d+/\S+/)\n", process.stderr.readline())
        assert found is not None
        wait_for(tmp_path / "is_here", process)
        with contextlib.ExitStack() as stack:
            for number in range(IDLE):
                connection = stack.enter_context(socket.socket())
                connection.setblocking(number < FILES - 20)  # others than these would wait for a place
                connection.connect_ex(place(found[1]))
                if number == FILES - 20:
                    (tmp_path / "go_on").touch()
            for message in messages(found[1], MESSAGES, random.Random(42)):
                if process.poll() is not None:
                    break
                send(found[1], message)
            _, err = process.communicate(timeout=10 * PATIENCE)
    finally:
        process.kill()
        process.communicate()
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    assert process.returncode == ExitCode.FINE, err
    with JournalReader.open(tmp_path / ".mutabot" / "journal.sqlite") as journal:
        assert journal.finished == "complete"
        assert len(journal.outcomes()) == len(journal.mutants()) > 0
        assert {outcome.verdict.value for outcome in journal.outcomes()} <= {"killed", "survived"}
