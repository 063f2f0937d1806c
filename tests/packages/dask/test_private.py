"""A cluster on this machine is closed to everybody else on it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import urllib.error
import urllib.request
from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from ipaddress import IPv4Address, IPv6Address, ip_address
from pathlib import Path

import pytest

from mutabot.errors import UsageError
from mutabot_dask import connection
from mutabot_dask.local import Certificates
from mutabot_dask.settings import ClusterSettings
from tests.campaign.project import Quiet, request_for

from . import intruder
from .clusters import cluster, processes, write

NOBODY = 65534
_LISTENS = "0A"
_MARK = f"OF_TEST_PRIVATE={os.getpid()}"


@dataclass(frozen=True)
class Opened:
    """A cluster with a worker, and what it listens on."""

    settings: ClusterSettings
    listening: list[tuple[IPv4Address | IPv6Address, int]]

    @property
    def ports(self) -> list[str]:
        return [str(port) for _, port in self.listening]

    @property
    def scheduler(self) -> str:
        return self.settings.address.rpartition(":")[2]


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Opened]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(*_MARK.split("="))
        patch.setenv("DASK_DISTRIBUTED__COMM__REQUIRE_ENCRYPTION", "False")  # a user's own setting
        with cluster(tmp_path_factory.mktemp("dask"), 1) as settings:
            yield Opened(settings, listening())


def own() -> list[int]:
    return processes(_MARK.encode())


def listening() -> list[tuple[IPv4Address | IPv6Address, int]]:
    """Where the processes of the cluster wait for connections."""
    inodes = {
        found[1]
        for pid in own()
        for descriptor in Path(f"/proc/{pid}/fd").iterdir()
        if descriptor.is_symlink()
        and (found := re.fullmatch(r"socket:\[(\d+)\]", str(descriptor.readlink())))
    }
    tables = [Path(f"/proc/net/{name}").read_text() for name in ("tcp", "tcp6")]
    rows = [line.split() for table in tables for line in table.splitlines()]
    return [_place(row[1]) for row in rows if row[3] == _LISTENS and row[9] in inodes]


def _place(text: str) -> tuple[IPv4Address | IPv6Address, int]:
    """The address and port in a row of the kernel's table: words of four bytes in the machine's order."""
    address, _, port = text.partition(":")
    words = array("I", bytes.fromhex(address))
    if sys.byteorder == "little":
        words.byteswap()
    return ip_address(words.tobytes()), int(port, 16)


def intrude(opened: Opened, file: Path, *given: str, user: str = "-") -> str:
    """Let somebody attack it; returns what they were told."""
    words = [user, str(file), opened.scheduler, ",".join(opened.ports), *given]
    done = subprocess.run(
        [sys.executable, intruder.__file__, *words], capture_output=True, text=True, check=True, timeout=300
    )
    return done.stdout


def test_every_port_is_on_the_loopback(opened: Opened) -> None:
    assert len(opened.listening) >= 3  # scheduler, nanny, worker
    assert {str(address) for address, _ in opened.listening if not address.is_loopback} == set()


@pytest.mark.parametrize(
    "path", ["/", "/status", "/info/main/workers.html", "/metrics", "/health", "/json/identity.json"]
)
def test_no_port_is_a_dashboard(path: str, opened: Opened) -> None:
    found = {}
    for port in opened.ports:
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{port}{path}", timeout=30) as answer:
                found[port] = answer.status
        except urllib.error.HTTPError as error:
            found[port] = error.code
        except OSError:
            continue
    assert set(found.values()) <= {404}


@pytest.mark.whole
def test_whoever_has_the_certificate_gets_in(opened: Opened, tmp_path: Path) -> None:
    """The attack works: what keeps others out is the certificate."""
    own = opened.settings
    told = intrude(opened, tmp_path / "ran", str(own.ca), str(own.cert), str(own.key))
    assert told == ""
    assert (tmp_path / "ran").read_text().count("ran") >= 3  # by a client, in the scheduler, in the worker


@pytest.mark.whole
def test_whoever_has_none_does_not(opened: Opened, tmp_path: Path) -> None:
    assert len(intrude(opened, tmp_path / "ran").splitlines()) == 2
    assert not (tmp_path / "ran").exists()


@pytest.mark.whole
@pytest.mark.skipif(os.getuid() != 0, reason="only root can be another user")
def test_another_user_neither_gets_in_nor_reads_the_key(opened: Opened, tmp_path: Path) -> None:
    user = str(NOBODY)
    assert len(intrude(opened, tmp_path / "ran", user=user).splitlines()) == 2
    own = opened.settings
    told = intrude(opened, tmp_path / "ran", str(own.ca), str(own.cert), str(own.key), user=user)
    assert "PermissionError" in told
    assert not (tmp_path / "ran").exists()


def test_only_its_user_can_read_the_key(tmp_path: Path) -> None:
    previous = os.umask(0)
    try:
        made = Certificates.make(tmp_path / "certificates")
    finally:
        os.umask(previous)
    assert {Path(file).stat().st_mode & 0o777 for file in (made.ca, made.cert, made.key)} == {0o600}
    assert Path(made.key).parent.stat().st_mode & 0o777 == 0o700


def test_no_command_line_and_no_environment_holds_the_key(opened: Opened) -> None:
    secret = Path(str(opened.settings.key)).read_bytes().splitlines()[1]
    for pid in own():
        for name in ("cmdline", "environ"):
            assert secret not in Path(f"/proc/{pid}/{name}").read_bytes()


def test_without_cryptography_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cryptography", None)
    with pytest.raises(UsageError, match=r"pip install 'path/to/mutabot\[cluster\]'"):
        Certificates.make(tmp_path / "certificates")


@pytest.mark.whole
def test_nothing_is_left_of_a_cluster_that_cannot_be_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "cryptography", None)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    project = write(tmp_path / "project")
    with pytest.raises(UsageError):
        connection.ClusterConnection(request_for(project), ClusterSettings("local:1"), print)
    assert not list(tmp_path.glob("mutabot-cluster-*"))


class Nobody:
    """A connection to a scheduler without workers."""

    def __init__(self, settings: ClusterSettings, address: str) -> None:
        self.address, self.workers, self.is_lost = address, dict[str, int](), True

    def close(self) -> None:
        pass


@pytest.mark.whole
@pytest.mark.parametrize(
    ("address", "warnings"),
    [
        ("tcp://192.0.2.1:8786", 1),
        ("tls://192.0.2.1:8786", 0),
        ("tcp://127.0.0.1:8786", 0),
        ("tcp://[::1]:8786", 0),
        ("tcp://localhost:8786", 0),
    ],
)
def test_a_link_that_others_can_read_is_reported_once(
    address: str, warnings: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connection, "Link", Nobody)
    told = Quiet()
    found = connection.ClusterConnection(request_for(write(tmp_path)), ClusterSettings(address), told.note)
    assert found.reconnect()
    assert sum("is not encrypted" in line for line in told.lines) == warnings
