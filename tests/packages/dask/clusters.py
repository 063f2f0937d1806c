"""A project for campaigns on clusters, and what is needed to look at them from outside."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from mutabot.campaign.request import Request
from mutabot.campaign.run import run_campaign
from mutabot.config.configuration import load_configuration
from mutabot.model import Vocabulary
from mutabot.model.codec import to_data
from mutabot_dask.choice import ClusterChoice
from mutabot_dask.link import Link
from mutabot_dask.local import LocalCluster
from mutabot_dask.settings import ClusterSettings
from mutabot_dask.shipping import Shipment
from tests.campaign.project import Quiet, outcomes, request_for, write_project

MISSION = """
    def fetch(arm):
        arm.move_by(0.4)
        arm.move_by(0.3)
        if arm.position() < 0.6:
            raise RuntimeError("not there, says " + __file__)
        arm.move_by(-0.5)

    def wander(arm):
        for step in range(6):
            arm.move_by(0.1 if arm.position() < 0.3 else -0.2)
        arm.move_by(0.5)

    def back(arm):
        arm.move_by(0.2)
        arm.move_by(-0.1)
        arm.move_by(-0.1)
    """
#: what a failing test says depends on the project's folder, and on how texts are hashed
TESTS = """
    import os
    from pathlib import Path
    from mission import back, fetch, wander
    from robot import Arm

    HERE = Path(__file__).parents[1]

    def test_fetch():
        arm = Arm()
        fetch(arm)
        assert abs(arm.x - 0.2) < 0.05, (arm.x, str(HERE), hash("a"))

    def test_wander():
        arm = Arm()
        wander(arm)
        assert arm.x > 0.1, os.environ["PYTHONHASHSEED"]

    def test_back():
        arm = Arm()
        back(arm)
        assert abs(arm.x) < 0.15, sorted(one.name for one in HERE.iterdir() if one.suffix == ".toml")
    """
#: one test that takes a while, for campaigns that somebody is to disturb
SLOW_MISSION = """
    import time

    def run(arm):
        for step in (0.3, 0.2):
            time.sleep(0.2)
            arm.move_by(step)
        arm.move_by(-0.1)
        arm.move_by(0.2)
    """
SLOW_TESTS = """
    from mission import run
    from robot import Arm

    def test_run():
        arm = Arm()
        run(arm)
        assert abs(arm.x - 0.6) < 0.05
    """
#: what differs between equal runs: times, and how often probes were read, which depends on what that cost
_ACCIDENTAL = {"wall", "cpu", "compared"}

Ends = dict[tuple[str, int], dict[str, Any]]


def write(folder: Path, **changes: Any) -> Path:
    """The project."""
    return write_project(folder, **{"mission": MISSION, "tests": TESTS, **changes})


def write_slow(folder: Path) -> Path:
    """The project that takes a while."""
    return write_project(folder, SLOW_MISSION, SLOW_TESTS)


def shipment_of(folder: Path) -> Shipment:
    """What goes to workers of a project, whose vocabulary is not read."""
    return Shipment.of(Request(load_configuration(folder.resolve()), Vocabulary(()), 1, 0, 1))


def ends(path: Path) -> Ends:
    """All outcomes of a journal, bar what differs between equal runs."""
    found = {(outcome.mutant, outcome.round): to_data(outcome) for outcome in outcomes(path)}
    return {
        key: {name: item for name, item in value.items() if name not in _ACCIDENTAL}
        for key, value in found.items()
    }


def on_cluster(request: Request, where: str | ClusterSettings, **changes: Any) -> Request:
    """The same campaign on a cluster."""
    there = ClusterSettings(where) if isinstance(where, str) else where
    return replace(request, executor=ClusterChoice(replace(there, **changes)), fresh=True)


def run_twice(project: Path, where: str | ClusterSettings, **changes: Any) -> tuple[Ends, Ends, Quiet]:
    """Outcomes without a cluster and on one, and what the latter told."""
    request = request_for(project, **changes)
    plain = ends(run_campaign(request, Quiet()))
    told = Quiet()
    return plain, ends(run_campaign(on_cluster(request, where), told)), told


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[ClusterSettings]:
    """A cluster that is there already; gives what it takes to connect to it."""
    folder.mkdir(exist_ok=True)
    there = LocalCluster(workers, folder)
    own = there.certificates
    try:
        settings = ClusterSettings(there.start(), ca=own.ca, cert=own.cert, key=own.key)
        link = Link(settings, settings.address)
        assert until(lambda: len(link.workers) == workers, 120)
        link.close()
        yield settings
    finally:
        there.close()


def strange_worker(there: ClusterSettings, folder: Path, how: str) -> subprocess.Popen[bytes]:
    """A worker that runs some code before all else."""
    code = (
        f"import sys\n{how}\n"
        "from distributed.cli.dask_worker import main\n"
        "sys.argv[:] = ['dask-worker', *sys.argv[1:]]\n"
        "main()\n"
    )
    own = ["--no-nanny", "--nthreads", "1", "--no-dashboard", "--local-directory", str(folder)]
    own += ["--host", "127.0.0.1", "--protocol", "tls", "--dashboard-address", "127.0.0.1:0"]
    own += ["--tls-ca-file", str(there.ca), "--tls-cert", str(there.cert), "--tls-key", str(there.key)]
    return subprocess.Popen([sys.executable, "-c", code, there.address, *own], stderr=subprocess.DEVNULL)


def processes(mark: bytes, word: str = "") -> list[int]:
    """Processes with an entry in their environment and a word in their command line."""
    found = []
    for folder in Path("/proc").iterdir():
        if not folder.name.isdigit():
            continue
        try:
            is_marked = mark in (folder / "environ").read_bytes().split(b"\0")
            if is_marked and word.encode() in (folder / "cmdline").read_bytes():
                found.append(int(folder.name))
        except OSError:
            continue
    return found


def kill(pids: list[int], number: int = signal.SIGKILL) -> None:
    for pid in pids:
        os.kill(pid, number)


def until(condition: Any, seconds: float = 30.0) -> bool:
    """Whether something becomes so in time."""
    limit = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > limit:
            return False
        time.sleep(0.05)
    return True
