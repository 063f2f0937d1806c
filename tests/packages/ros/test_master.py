"""Who answers at a master's port is the master only if it is the process that was started."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from threading import Thread
from xmlrpc.server import SimpleXMLRPCServer

import pytest

from mutabot_ros import _master


@pytest.fixture
def process() -> Iterator[subprocess.Popen[bytes]]:
    started = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    yield started
    started.kill()
    started.wait()


@pytest.fixture(autouse=True)
def _hasty(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_master, "_PATIENCE", 0.5)


@pytest.mark.parametrize("is_it", [True, False])
def test_a_master_of_somebody_else_is_not_taken_for_it(process: subprocess.Popen[bytes], is_it: bool) -> None:
    pid = process.pid if is_it else os.getpid()
    with SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as server:
        server.register_function(lambda caller: [1, "", pid], "getPid")
        Thread(target=server.serve_forever, daemon=True).start()
        assert _master._comes_up(process, server.server_address[1]) is is_it
        server.shutdown()


def test_a_port_that_takes_connections_and_says_nothing_of_a_master_is_none(
    process: subprocess.Popen[bytes],
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:

        def hang_up() -> None:
            while True:
                try:
                    server.accept()[0].close()
                except OSError:
                    return

        Thread(target=hang_up, daemon=True).start()
        assert not _master._comes_up(process, server.getsockname()[1])


def test_a_port_is_none_that_the_system_gives_to_connections() -> None:
    low, high = map(int, Path("/proc/sys/net/ipv4/ip_local_port_range").read_text("ascii").split())
    found = [_master._free_port(number) for number in range(3)]
    assert len(set(found)) == 3
    assert not any(low <= port <= high for port in found)
