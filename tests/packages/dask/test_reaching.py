"""A cluster that cannot be used is an error that says what would have been right."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from distributed import Security

from mutabot.cli.request import request_of
from mutabot.errors import ConfigurationError, UsageError
from mutabot.execution.versions import versions
from mutabot_dask import link
from mutabot_dask.bundle import Bundle
from mutabot_dask.choice import ClusterChoice
from mutabot_dask.local import LocalCluster, address_in
from mutabot_dask.roster import Roster
from mutabot_dask.settings import ClusterSettings
from tests.campaign.project import CONFIGURATION

from .clusters import cluster, processes, shipment_of, strange_worker, until, write, write_slow


@pytest.mark.parametrize(
    ("address", "says"),
    [
        ("local:0", "local:2 starts two"),
        (
            "local:99999999",
            r"local:99999999: at most \d+ workers can be started on this machine, which has \d+",
        ),
        ("local:" + "9" * 5000, r"local:9+…: at most \d+ workers"),
        ("local:many", "neither an address"),
        ("x" * 5000, "neither an address"),
        ("tcp://host:99999", "an address is like tcp://host:8786"),
        ("no/such/file.json", "nor a scheduler file that is there"),
        ("http://host:8786", "an address is like tcp://host:8786"),
        ("tcp://host", "an address is like tcp://host:8786"),
        ("tls://host:8786", "needs certificates"),
    ],
)
def test_what_is_no_cluster_is_refused(address: str, says: str) -> None:
    with pytest.raises(UsageError, match=says):
        ClusterSettings(address).check()


def test_a_missing_certificate_is_named() -> None:
    with pytest.raises(UsageError, match=r"cluster\.ca = .*nowhere\.pem.*: there is no such file"):
        ClusterSettings("tls://host:8786", ca="nowhere.pem").check()


def test_certificates_may_stand_in_the_configuration(tmp_path: Path) -> None:
    project = write(
        tmp_path, configuration=CONFIGURATION + '    cluster = { ca = "ca.pem", key = "key.pem" }\n'
    )
    for name in ("ca.pem", "key.pem", "mine.pem"):
        (project / name).touch()
    mine = str(project / "mine.pem")
    given = ["cluster.cert=mine.pem", "cluster.key=mine.pem"]
    request = request_of(project, executor=("cluster", "tls://host:1"), settings=given)
    settings = ClusterSettings("tls://host:1", str(project / "ca.pem"), mine, mine)
    assert request.executor == ClusterChoice(settings)
    assert request_of(project, executor=("cluster", "local:2")).executor == ClusterChoice(
        ClusterSettings("local:2")
    )
    write(tmp_path, configuration=CONFIGURATION + '    cluster = { cq = "ca.pem" }\n')
    with pytest.raises(ConfigurationError, match=r"cluster.*'cq'; did you mean 'ca'"):
        request_of(project)


def test_certificates_without_encryption_are_refused(tmp_path: Path) -> None:
    (tmp_path / "ca.pem").touch()
    with pytest.raises(UsageError, match="certificate files go with tls://"):
        ClusterSettings("tcp://host:8786", ca=str(tmp_path / "ca.pem")).check()


def test_nobody_at_an_address(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(link, "PATIENCE", 0.5)
    with pytest.raises(
        UsageError, match=r"no scheduler answers at tcp://127\.0\.0\.1:9: .*is the port right"
    ):
        link.Link(ClusterSettings("tcp://127.0.0.1:9"), "tcp://127.0.0.1:9")


def test_a_client_that_fails_to_close_is_not_closed_again_when_it_is_collected(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As one does whose scheduler has ended while it was connecting to it again."""
    with cluster(tmp_path, 0) as settings:
        there = link.Link(settings, settings.address)
        client = there._client
        with monkeypatch.context() as patch:
            patch.setattr(client, "_close", failing)
            there.close()
            client.__del__()  # raised ValueError
        client.status = "running"
        client.close()


async def failing(*given: object, **named: object) -> None:
    raise ValueError("IOStream is not idle; cannot convert to SSL")


NO_ROOM = """
from mutabot_dask.worker_side import Store
def take(*given):
    raise OSError(28, "No space left on device")
Store.take = take
"""


@pytest.mark.whole
@pytest.mark.parametrize(
    ("how", "has_bundle", "says"),
    [("sys.modules['mutabot'] = None", False, "mutabot"), (NO_ROOM, True, "No space left on device")],
    ids=["no mutabot", "no room"],
)
def test_a_worker_that_cannot_take_part_is_reported_and_lives_on(
    how: str, has_bundle: bool, says: str, tmp_path: Path
) -> None:
    with cluster(tmp_path, 0) as settings, strange_worker(settings, tmp_path, how) as process:
        try:
            there = link.Link(settings, settings.address)
            roster = Roster(there, versions(), lambda text: None)
            if has_bundle:
                roster.bundle = Bundle.make(shipment_of(write(tmp_path / "project")))
            assert until(lambda: roster.update() is not None and there.workers)
            assert until(lambda: _has_refused(roster))
            (why,) = roster.refusals.values()
            assert "is the same mutabot installed there, and room on its disk?" in why
            assert says in why.partition("(")[2]
            assert process.poll() is None
            there.close()
        finally:
            process.kill()


def _has_refused(roster: Roster) -> bool:
    roster.update()
    while not roster.link.replies.empty():
        roster.take(roster.link.replies.get())
    return bool(roster.refusals)


def test_a_file_that_is_no_scheduler_file(tmp_path: Path) -> None:
    (tmp_path / "s.json").write_text("{}")
    with pytest.raises(UsageError, match=r"is not a scheduler file: `dask scheduler --scheduler-file"):
        address_in(tmp_path / "s.json")


def test_without_dask_the_extra_is_named() -> None:
    code = "import sys; sys.modules['distributed'] = None; import mutabot_dask.link"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "pip install 'path/to/mutabot[cluster]'" in done.stderr.splitlines()[-1]


@pytest.mark.whole
def test_certificates_that_do_not_fit_are_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(link, "PATIENCE", 3.0)
    ours, others = (_certificates(tmp_path / name) for name in ("ours", "others"))
    ca, cert, key = ours
    words = [
        "--tls-ca-file", ca, "--tls-cert", cert, "--tls-key", key, "--protocol", "tls", "--port", "0",
        "--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(tmp_path / "s.json"),
    ]  # fmt: skip
    process = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_scheduler", *words], stderr=subprocess.DEVNULL
    )
    try:
        assert until(lambda: (tmp_path / "s.json").exists() and (tmp_path / "s.json").read_text())
        address = address_in(tmp_path / "s.json")
        assert address.startswith("tls://")
        link.Link(ClusterSettings(address, ca=ca, cert=cert, key=key), address).close()
        with pytest.raises(UsageError, match="Do the certificate files belong to it"):
            link.Link(ClusterSettings(address, *others), address)
    finally:
        process.kill()
        process.wait()


def _certificates(folder: Path) -> tuple[str, str, str]:
    """Files with a certificate that is its own authority, and its key."""
    folder.mkdir()
    made = Security.temporary()
    texts = {"ca": made.tls_ca_file, "cert": made.tls_client_cert, "key": made.tls_client_key}
    for name, text in texts.items():
        (folder / f"{name}.pem").write_text(text)
    ca, cert, key = (str(folder / f"{name}.pem") for name in texts)
    return ca, cert, key


@pytest.mark.whole
def test_an_interruption_leaves_no_process(tmp_path: Path) -> None:
    project = write_slow(tmp_path / "project")
    mark = {"OF_TEST_INTERRUPTION": str(tmp_path)}
    words = ["-C", str(project), "run", "--engine", "replay", "--cluster", "local:2"]
    with subprocess.Popen(
        [sys.executable, "-m", "mutabot.cli.app", *words],
        env={**os.environ, **mark},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stderr is not None
        try:
            for line in process.stderr:
                if line.startswith("mutants "):  # the first have their outcomes
                    break
            process.send_signal(signal.SIGINT)
            said = process.stderr.read()
            assert process.wait(30) == 130, said
        finally:
            process.kill()
    assert "Traceback" not in said
    entry = f"OF_TEST_INTERRUPTION={tmp_path}".encode()
    assert until(lambda: not processes(entry), 5.0), processes(entry)


@pytest.mark.whole
def test_workers_on_this_machine_end_with_whoever_started_them(tmp_path: Path) -> None:
    code = (
        "import os, sys\n"
        "from pathlib import Path\n"
        "from mutabot_dask.local import LocalCluster\n"
        "print(LocalCluster(1, Path(sys.argv[1])).start())\n"
        "os.kill(os.getpid(), 9)\n"
    )
    environment = {**os.environ, "OF_TEST_ORPHANS": str(tmp_path)}
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], env=environment, check=False)
    entry = f"OF_TEST_ORPHANS={tmp_path}".encode()
    assert until(lambda: not processes(entry), 10.0)


def test_a_scheduler_that_cannot_start_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DASK_DISTRIBUTED__SCHEDULER__PRELOAD", '["no.such.module"]')
    with pytest.raises(UsageError, match="a scheduler could not be started on this machine"):
        LocalCluster(1, tmp_path).start()
