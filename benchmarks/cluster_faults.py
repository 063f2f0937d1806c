"""Kill workers and schedulers of clusters at random moments of campaigns, and compare with one left in peace.

Use: ``python benchmarks/cluster_faults.py [--workers 30] [--schedulers 3] [--links 0] [--seed 1] [--rounds 5]
[--engine auto] [--where local netns]``. The published selection of ``examples/paper`` runs again and again
until so many have been killed by SIGKILL, half of them under ``--cluster local:4`` and half on a scheduler
with two workers in network namespaces of their own (``ip netns``, which needs root; without it all are killed
under local:4, and that is said). ``--links``: so often the cable of a namespace is cut for 1 to 40 s. Prints
JSON; the exit code is 1 if an outcome differs or is lost, or if a fault has become a kill.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mutabot.journal.journal import Journal
from mutabot.model.codec import to_data

PAPER = Path(__file__).parents[1] / "examples" / "paper"
#: what differs between equal runs: times, and how often probes were read, which depends on what that cost
_ACCIDENTAL = {"wall", "cpu", "compared"}
#: marks the processes of a campaign in their environment
_MARK = "MUTABOT_BENCHMARK"
_PORT = 8786
#: to each namespace one; and how soon a scheduler takes a worker that is silent for dead
_CABLES = ("mb1", "mb2")
_SETTINGS = {"DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL": "15s"}

Pair = tuple[str, int]


@dataclass
class Trial:
    """One project, on which campaigns run on clusters.

    Attributes:
        folder: the project.
        rounds, engine: options of the campaigns.
        kills: how many were killed of what.
        faults: what was not as it must be.
    """

    folder: Path
    rounds: int
    engine: str
    chance: random.Random
    kills: dict[str, int] = field(default_factory=dict)
    campaigns: dict[str, int] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)

    @property
    def journal(self) -> Path:
        """Where campaigns write."""
        return self.folder / ".mutabot" / "journal.sqlite"

    def start(self, *more: str) -> subprocess.Popen[str]:
        """Start a campaign, as a user would."""
        words = [
            "-C", str(self.folder), "run", "--fresh", "--engine", self.engine, "--rounds", str(self.rounds),
            "--only", "@published.txt", *more,
        ]  # fmt: skip
        return subprocess.Popen(
            [sys.executable, "-m", "mutabot.cli.app", *words],
            env={**os.environ, _MARK: str(self.folder)},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )

    def outcomes(self) -> dict[Pair, dict[str, Any]]:
        """All outcomes, bar what differs between equal runs."""
        with Journal.open(self.journal) as journal:
            found = {(one.mutant, one.round): to_data(one) for one in journal.outcomes()}
        return {
            pair: {name: item for name, item in one.items() if name not in _ACCIDENTAL}
            for pair, one in found.items()
        }

    def finish(self, process: subprocess.Popen[str]) -> str:
        """Wait for the end of a campaign; returns what it said."""
        _, said = process.communicate()
        if process.returncode != 0:
            self.faults.append(f"a campaign ended with {process.returncode}: {said[-800:]}")
        return said

    def compare(self, expected: dict[Pair, dict[str, Any]], said: str) -> None:
        """Hold the outcomes of a campaign that was disturbed against those of one that was not."""
        found = self.outcomes()
        lost = expected.keys() - found.keys()
        if lost:
            self.faults.append(f"{len(lost)} outcomes are lost, such as {min(lost)}")
        for pair in expected.keys() & found.keys():
            if found[pair] != expected[pair]:
                names = [name for name in expected[pair] if found[pair].get(name) != expected[pair][name]]
                was, now = expected[pair]["verdict"], found[pair]["verdict"]
                more = f": {found[pair].get('message')}" if was != now else ""
                self.faults.append(f"{pair} is {now}, was {was}; other in {', '.join(names)}{more}")

    def kill(self, what: str, pid: int) -> None:
        """Kill a process."""
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
            self.kills[what] = self.kills.get(what, 0) + 1

    def cut(self, cable: str, seconds: float) -> None:
        """Cut a cable, and join it again after a while."""
        ip("link", "set", cable, "down")
        self.kills["link"] = self.kills.get("link", 0) + 1
        joining = threading.Timer(seconds, join, [cable])
        joining.daemon = True
        joining.start()


def join(cable: str) -> None:
    """Join a cable that was cut."""
    with suppress(subprocess.CalledProcessError):  # all is over
        ip("link", "set", cable, "up")


def processes(mark: str) -> Iterator[tuple[int, str]]:
    """The processes with a mark in their environment: number and command line."""
    entry = f"{_MARK}={mark}".encode()
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit():
            with suppress(OSError):
                if entry in (folder / "environ").read_bytes().split(b"\0"):
                    command = (
                        (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode("utf-8", "replace")
                    )
                    yield int(folder.name), command


def workers_of(mark: str) -> list[int]:
    """Dask's worker processes, below their nannies."""
    return [pid for pid, command in processes(mark) if "multiprocessing.spawn" in command]


def schedulers_of(mark: str) -> list[int]:
    """Dask's scheduler, as its command line has it."""
    return [pid for pid, command in processes(mark) if "dask_scheduler" in command]


def disturb(trial: Trial, mark: str, process: subprocess.Popen[str], plan: list[tuple[float, str]]) -> None:
    """Kill what the plan says after so many seconds each, as long as the campaign runs."""
    for pause, what in plan:
        with suppress(subprocess.TimeoutExpired):
            process.wait(pause)
        if process.poll() is not None:
            return
        if what == "link":
            trial.cut(trial.chance.choice(_CABLES), trial.chance.uniform(1, 40))
            continue
        found = workers_of(mark) if what == "worker" else schedulers_of(mark)
        if found:
            trial.kill(what, trial.chance.choice(found))


def on_local(trial: Trial, expected: dict[Pair, dict[str, Any]], workers: int, schedulers: int) -> None:
    """Campaigns under ``--cluster local:4`` until so many are killed."""
    before = dict(trial.kills)

    def left(what: str, of: int) -> int:
        return of - trial.kills.get(what, 0) + before.get(what, 0)

    while (left("worker", workers) > 0 or left("scheduler", schedulers) > 0) and not trial.faults:
        trial.campaigns["local:4"] = trial.campaigns.get("local:4", 0) + 1
        process = trial.start("--cluster", "local:4")
        wanted = ["worker"] * min(left("worker", workers), 6) + ["scheduler"] * min(
            left("scheduler", schedulers), 1
        )
        _run(trial, expected, process, wanted, str(trial.folder), 6.0)


def _run(
    trial: Trial, expected: dict[Pair, dict[str, Any]], process: subprocess.Popen[str], wanted: list[str],
    mark: str, first: float,
) -> None:  # fmt: skip
    trial.chance.shuffle(wanted)
    plan = [
        (first + trial.chance.uniform(0, 4) if not index else trial.chance.uniform(0.5, 5), what)
        for index, what in enumerate(wanted)
    ]
    began = time.monotonic()
    reader = reader_of(process)
    disturb(trial, mark, process, plan)
    process.wait()
    trial.seconds.append(round(time.monotonic() - began, 1))
    said = reader()
    if process.returncode != 0:
        trial.faults.append(f"a campaign ended with {process.returncode}: {said[-800:]}")
    trial.compare(expected, said)
    print(
        f"{trial.kills} in {trial.campaigns}, {trial.seconds[-1]} s, faults: {trial.faults}", file=sys.stderr
    )


def reader_of(process: subprocess.Popen[str]) -> Any:
    """Read what a process says beside; the function that is returned waits for it."""
    lines: list[str] = []

    def read() -> None:
        assert process.stderr is not None
        lines.extend(process.stderr)

    thread = threading.Thread(target=read)
    thread.start()

    def wait() -> str:
        thread.join()
        return "".join(lines)

    return wait


def ip(*words: str) -> None:
    """Run ``ip``."""
    subprocess.run(["ip", *words], check=True, capture_output=True, text=True)


@contextmanager
def namespaces(names: list[str]) -> Iterator[list[str]]:
    """Network namespaces, each joined to this one by a cable; gives the addresses of their near ends."""
    near = []
    try:
        for number, name in enumerate(names, 1):
            ip("netns", "add", name)
            cable = _CABLES[number - 1]
            ip("link", "add", cable, "type", "veth", "peer", "name", "eth0", "netns", name)
            ip("addr", "add", f"10.77.{number}.1/30", "dev", cable)
            ip("link", "set", cable, "up")
            ip("-n", name, "addr", "add", f"10.77.{number}.2/30", "dev", "eth0")
            ip("-n", name, "link", "set", "eth0", "up")
            ip("-n", name, "link", "set", "lo", "up")
            near.append(f"10.77.{number}.1")
        yield near
    finally:
        for number, name in enumerate(names, 1):
            for words in (("link", "del", _CABLES[number - 1]), ("netns", "del", name)):
                with suppress(subprocess.CalledProcessError):
                    ip(*words)


@dataclass
class Hosts:
    """A scheduler, and a worker in each namespace, started again when they are gone, as services would be."""

    mark: str
    folder: Path
    names: list[str]
    near: list[str]
    running: dict[str, subprocess.Popen[bytes]] = field(default_factory=dict)

    def tend(self) -> None:
        """Start what does not run."""
        host = ["--host", "0.0.0.0", "--port", str(_PORT), "--no-dashboard"]
        self._tend("scheduler", [sys.executable, "-m", "distributed.cli.dask_scheduler", *host])
        for name, address in zip(self.names, self.near, strict=True):
            folder = self.folder / name
            folder.mkdir(exist_ok=True)
            worker = ["ip", "netns", "exec", name, sys.executable, "-m", "distributed.cli.dask_worker"]
            own = ["--nthreads", "1", "--memory-limit", "0", "--no-dashboard", "--death-timeout", "20"]
            place = ["--local-directory", str(folder)]
            self._tend(name, [*worker, f"tcp://{address}:{_PORT}", *own, *place])

    def wait(self) -> None:
        """Wait until the workers have begun. Raises RuntimeError if they do not within a minute."""
        until = time.monotonic() + 60
        for name in self.names:
            while not any((self.folder / name).glob("dask-scratch-space/worker-*")):
                if time.monotonic() > until:
                    raise RuntimeError(f"no worker has begun in the namespace {name}")
                time.sleep(0.1)

    def _tend(self, name: str, command: list[str]) -> None:
        there = self.running.get(name)
        if there is None or there.poll() is not None:
            self.running[name] = subprocess.Popen(
                command, env={**os.environ, **_SETTINGS, _MARK: self.mark}, stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
            )  # fmt: skip

    def end(self) -> None:
        """End all."""
        for process in self.running.values():
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def on_hosts(
    trial: Trial, expected: dict[Pair, dict[str, Any]], workers: int, schedulers: int, links: int
) -> None:
    """Campaigns on a scheduler with workers in two namespaces, until so many are killed, and cables cut."""
    before = dict(trial.kills)
    names = ["mutabot-h1", "mutabot-h2"]
    mark = f"{trial.folder}-hosts"
    with tempfile.TemporaryDirectory() as folder, namespaces(names) as near:
        hosts, is_over = Hosts(mark, Path(folder), names, near), threading.Event()

        def tend() -> None:
            while not is_over.is_set():
                hosts.tend()
                is_over.wait(0.5)

        thread = threading.Thread(target=tend)
        thread.start()
        try:
            hosts.wait()
            while not trial.faults:
                wanted = [
                    what
                    for what, of, most in (
                        ("worker", workers, 5),
                        ("scheduler", schedulers, 1),
                        ("link", links, 2),
                    )
                    for _ in range(min(of - trial.kills.get(what, 0) + before.get(what, 0), most))
                ]
                if not wanted:
                    return
                trial.campaigns["two namespaces"] = trial.campaigns.get("two namespaces", 0) + 1
                process = trial.start("--cluster", f"tcp://127.0.0.1:{_PORT}")
                _run(trial, expected, process, wanted, mark, 4.0)
                for cable in _CABLES:
                    join(cable)
        finally:
            is_over.set()
            thread.join()
            hosts.end()


def can_have_namespaces() -> str | None:
    """Why there can be no network namespaces; None if there can."""
    try:
        with namespaces(["mutabot-try"]):
            return None
    except FileNotFoundError:
        return "there is no command ip"
    except subprocess.CalledProcessError as error:
        return str(error.stderr).strip()


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--workers", type=int, default=30)
    parser.add_argument("--schedulers", type=int, default=3)
    parser.add_argument("--links", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--where", nargs="+", choices=["local", "netns"], default=["local", "netns"])
    given = parser.parse_args()
    where = list(given.where)
    if "netns" in where and (why := can_have_namespaces()) is not None:
        print(f"no network namespaces, so all run under local:4: {why}", file=sys.stderr)
        where = ["local"]
    with tempfile.TemporaryDirectory() as folder:
        project = Path(folder).resolve() / "paper"
        shutil.copytree(PAPER, project, ignore=shutil.ignore_patterns(".mutabot", "__pycache__"))
        trial = Trial(project, given.rounds, given.engine, random.Random(given.seed))
        trial.finish(trial.start())
        expected = trial.outcomes()
        here = given.workers if len(where) == 1 else given.workers // 2
        of_schedulers = given.schedulers if len(where) == 1 else (given.schedulers + 1) // 2
        if "local" in where:
            on_local(trial, expected, here, of_schedulers)
        if "netns" in where:
            rest = (
                (given.workers, given.schedulers)
                if len(where) == 1
                else (given.workers - here, given.schedulers - of_schedulers)
            )
            on_hosts(trial, expected, *rest, given.links)
    found = {
        "engine": given.engine,
        "outcomes": len(expected),
        "killed": trial.kills,
        "campaigns": trial.campaigns,
        "seconds": trial.seconds,
        "lost, different, or kills by fault": trial.faults,
    }
    print(json.dumps(found, indent=2))
    return 1 if trial.faults else 0


if __name__ == "__main__":
    sys.exit(main())
