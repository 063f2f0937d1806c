"""Mutants of calls that only an excluded test reaches are planned, and no verdict is claimed."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from textwrap import dedent
from threading import Thread

import pytest

from mutabot.model import Verdict
from tests.campaign.project import CONFIGURATION, run, write_project

MISSION = """
    def run(arm):
        arm.move_by(0.5)

    def back(arm):
        arm.move_by(-0.25)
"""
TESTS = """
    import socket

    import mission
    from robot import Arm

    def test_runs():
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.5

    def test_varies():
        mission.back(Arm())
        with socket.create_connection(("127.0.0.1", {port})) as connection:
            assert connection.recv(1) == b"0"
"""


@pytest.fixture
def counter() -> Iterator[int]:
    """The port of a server that says how many have asked before: runs share no file."""
    with socket.create_server(("127.0.0.1", 0)) as server:

        def count() -> None:
            with suppress(OSError):
                for number in range(10):
                    with server.accept()[0] as connection:
                        connection.send(b"%d" % number)

        thread = Thread(target=count)
        thread.start()
        yield server.getsockname()[1]
        server.shutdown(socket.SHUT_RDWR)
        thread.join()


def test_a_call_that_only_an_excluded_test_reaches_is_unstable_and_does_not_vanish(
    tmp_path: Path, counter: int
) -> None:
    configuration = f"{dedent(CONFIGURATION)}unstable_limit = 0.6"
    write_project(tmp_path, MISSION, TESTS.format(port=counter), configuration=configuration)
    found = run(tmp_path, only=("*:repeat",))
    verdicts = {name.split(":")[1]: outcome.verdict for name, outcome in found.items()}
    assert verdicts == {"run": Verdict.KILLED, "back": Verdict.UNSTABLE}
