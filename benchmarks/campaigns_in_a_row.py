"""Many campaigns in a row: is anything left behind, by any of them?

Small campaigns with both engines, on programs of which some mutants hang and some kill their process. Part
of them are left in peace, part are interrupted at a random moment: by SIGINT in this process, or by SIGINT
or SIGKILL in a process of their own. All others run in this one process, so that what one does not close
adds up.

After each of them: no process that works in the project, no child, and as many open descriptors as before.
At the end of all, after one more campaign on each project: no file of mutabot's own but its journals, no
temporary file, and the user's files as they were. Outcomes are the same whenever a campaign gets to its end.

Use: ``python benchmarks/campaigns_in_a_row.py [--count 200] [--seed 1] [--json]``. The exit code is 1 if
anything is left behind or differs.
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
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from textwrap import dedent
from typing import Any

from mutabot.campaign.request import Progress, Request
from mutabot.campaign.run import run_campaign
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot.journal.journal import Journal

ENGINES = ("fork", "replay")
PEACE, INTERRUPTED, SIGINT, SIGKILL = "left in peace", "interrupted here", "SIGINT", "SIGKILL"
#: how campaigns end, in this order again and again; the first of each kind is left in peace, to be timed
ENDINGS = (PEACE, INTERRUPTED, SIGKILL, PEACE, SIGINT)
JOBS = 2
#: seconds that what is left of a campaign may take to end
DYING = 60.0
#: what mutabot may leave in its folder
KEPT = {".gitignore", "journal.previous.sqlite"}
KEPT |= {f"journal.sqlite{end}" for end in ("", "-shm", "-wal", ".lock")}
#: recordings, of campaigns of the command; those in this process have none
KEPT |= {f"journal-evidence.sqlite{end}" for end in ("", "-shm", "-wal")}

FILES = {
    "mutabot.toml": """
        program = ["mission.py"]
        vocabulary = ["robot.toml"]
        pytest_args = ["-o", "pythonpath=."]
        timeout_seconds = 2
    """,
    "robot.toml": """
        [[operation]]
        call = "robot:Arm.move_by"
        arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
    """,
    "robot.py": """
        import os
        import time

        class Arm:
            def __init__(self):
                self.x = 0.0

            def move_by(self, dx):
                time.sleep(0.005)
                self.x += dx
    """,
    "tests/test_mission.py": """
        import mission
        from robot import Arm

        def test_mission(tmp_path):
            arm = Arm()
            (tmp_path / "log.txt").write_text("begun")
            mission.run(arm)
            assert abs(arm.x - 0.3) < 0.05

        def test_again():
            arm = Arm()
            mission.run(arm)
            assert arm.x > 0.1
    """,
}
#: project -> what its program does after its move
PROGRAMS = {
    "plain": "pass",
    "hanging": "while arm.x < 0: time.sleep(0.01)",
    "dying": "if arm.x < 0: os.kill(os.getpid(), signal.SIGSEGV)",
}
#: exit codes of the command; of a process that dies after the mutated call nothing is known
EXIT_CODES = {"plain": 0, "hanging": 0, "dying": 4}
MISSION = """
    import os, signal, time

    def run(arm):
        arm.move_by(0.3)
        {after}
"""


class Silent(Progress):
    """A progress that shows nothing."""


@dataclass
class Series:
    """Campaigns in a row, and what is not as it must be.

    Attributes:
        home: folder of the projects.
        chance: tells when campaigns are interrupted.
        tell: told what is not as it must be, at once.
        faults: what was not as it must be.
        ends: how many campaigns ended how.
        seconds: what an undisturbed campaign took, by project and engine.
        expected: outcomes of the first one that got to its end, by project.
    """

    home: Path
    chance: random.Random
    tell: Callable[[str], None]
    faults: list[str] = field(default_factory=list)
    ends: Counter[str] = field(default_factory=Counter)
    seconds: dict[tuple[str, str], float] = field(default_factory=dict)
    expected: dict[str, dict[str, str]] = field(default_factory=dict)

    def write(self) -> None:
        """Write the projects."""
        for project, after in PROGRAMS.items():
            for name, text in {**FILES, "mission.py": MISSION.format(after=after)}.items():
                path = self.home / project / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(dedent(text), encoding="utf-8")

    def run(self, number: int) -> None:
        """The campaign of this number, and a look at what it left."""
        project = list(PROGRAMS)[number % 3]
        engine, ending = ENGINES[number // 3 % 2], ENDINGS[number // 6 % len(ENDINGS)]
        what = f"campaign {number + 1} ({project}, {engine}, {ending})"
        before = descriptors()
        if ending in (PEACE, INTERRUPTED):
            self._here(project, engine, None if ending == PEACE else self._moment(project, engine), what)
        else:
            self._elsewhere(project, engine, getattr(signal, ending), what)
        self._expect(self._is_quiet(), f"{what}: processes are left: {self.processes()}")
        after = descriptors()
        self._expect(after == before, f"{what}: descriptors are left: {_difference(after, before)}")

    def finish(self) -> None:
        """One more campaign on each project removes what killed ones left; then nothing may be there."""
        for project in PROGRAMS:
            self._here(project, "fork", None, f"last campaign ({project})")
            folder = self.home / project / ".mutabot"
            left = sorted({path.name for path in folder.iterdir()} - KEPT)
            self._expect(not left, f"files are left in {project}: {left}")

    def _moment(self, project: str, engine: str) -> float:
        """When to interrupt a campaign, s."""
        return self.chance.uniform(0.0, 1.1) * self.seconds[project, engine]

    def _here(self, project: str, engine: str, moment: float | None, what: str) -> None:
        """Run a campaign in this process, and interrupt it if that is asked for."""
        folder, began = self.home / project, time.monotonic()
        try:
            with interrupting(moment):
                run_campaign(request_for(folder, engine), Silent())
        except KeyboardInterrupt:
            self._expect(moment is not None, f"{what}: interrupted by nobody")
            self.ends["interrupted here"] += 1
            return
        if moment is None:
            self.seconds[project, engine] = time.monotonic() - began
        self._finished(project, what)

    def _elsewhere(self, project: str, engine: str, number: signal.Signals, what: str) -> None:
        """Run a campaign in a process of its own, and send it a signal."""
        words = ["-C", str(self.home / project), "run", "--fresh", "-j", str(JOBS), "--engine", engine]
        process = subprocess.Popen(
            [sys.executable, "-m", "mutabot.cli.app", *words],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            process.wait(self._moment(project, engine))
        except subprocess.TimeoutExpired:
            process.send_signal(number)
        _, said = process.communicate()
        too_young = said.rstrip().endswith("KeyboardInterrupt")  # to say so itself
        if process.returncode in (130, -number) or too_young:
            self.ends[f"ended by {number.name}"] += 1
        elif self._expect(
            process.returncode == EXIT_CODES[project], f"{what}: {process.returncode}: {said[-500:]}"
        ):
            self._finished(project, what)

    def _finished(self, project: str, what: str) -> None:
        """A campaign got to its end: it must have found what the first one did."""
        with Journal.open(self.home / project / ".mutabot" / "journal.sqlite") as journal:
            self._expect(journal.finished == "complete", f"{what}: {journal.finished}")
            found = {
                outcome.mutant: f"{outcome.verdict} by {outcome.by} in {outcome.test}"
                for outcome in journal.outcomes()
            }
        expected = self.expected.setdefault(project, found)
        self._expect(found == expected, f"{what}: {_difference(found, expected)}")
        self.ends["complete"] += 1

    def processes(self) -> list[str]:
        """Children of this process, and whatever else names the projects' folder."""
        children = Path(f"/proc/self/task/{os.getpid()}/children").read_text(encoding="ascii").split()
        return [f"child {pid}" for pid in children] + [
            text for entry in Path("/proc").iterdir() if (text := self._named_by(entry)) is not None
        ]

    def _named_by(self, entry: Path) -> str | None:
        """The command line of a process that has to do with the projects; None for all others."""
        if not entry.name.isdigit() or int(entry.name) == os.getpid():
            return None
        home = os.fsencode(self.home)
        try:
            command = (entry / "cmdline").read_bytes()
            words = (command, (entry / "environ").read_bytes(), os.fsencode((entry / "cwd").readlink()))
        except OSError:  # it has just ended, or is not ours
            return None
        return command.replace(b"\0", b" ").decode() if any(home in text for text in words) else None

    def _is_quiet(self) -> bool:
        until = time.monotonic() + DYING
        while self.processes():
            if time.monotonic() > until:
                return False
            time.sleep(0.02)
        return True

    def files(self) -> dict[str, bytes]:
        """The user's files."""
        return {
            str(path.relative_to(self.home)): path.read_bytes()
            for path in sorted(self.home.rglob("*"))
            if path.is_file() and ".mutabot" not in path.parts
        }

    def _expect(self, is_so: bool, otherwise: str) -> bool:
        if not is_so:
            self.faults.append(otherwise)
            self.tell(f"FAULT: {otherwise}")
        return is_so


class interrupting:  # noqa: N801  # reads as a statement
    """Send this process SIGINT after some seconds, unless the block has ended before."""

    def __init__(self, moment: float | None) -> None:
        self._timer = None if moment is None else threading.Timer(moment, self._send)
        self._lock = threading.Lock()
        self._is_over = False

    def _send(self) -> None:
        with self._lock:
            if not self._is_over:
                os.kill(os.getpid(), signal.SIGINT)

    def __enter__(self) -> None:
        if self._timer is not None:
            self._timer.start()

    def __exit__(self, *error: object) -> None:
        if self._timer is not None:
            with self._lock:
                self._is_over = True
            self._timer.cancel()
            self._timer.join()


def request_for(folder: Path, engine: str) -> Request:
    """A campaign on a project that runs everything."""
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, configuration.root)
    return Request(configuration, vocabulary, 1, 1, JOBS, engine=engine, fresh=True)


def descriptors() -> dict[str, str]:
    """The open descriptors of this process, and where they lead."""
    found = {}
    for entry in Path("/proc/self/fd").iterdir():
        try:
            found[entry.name] = str(entry.readlink())
        except OSError:  # the descriptor of the listing itself
            continue
    return found


def _difference(found: dict[str, str], expected: dict[str, str]) -> dict[str, tuple[str | None, str | None]]:
    keys = {*found, *expected}
    return {key: (expected.get(key), found.get(key)) for key in keys if found.get(key) != expected.get(key)}


def run(home: Path, count: int, seed: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """So many campaigns; what came of it."""
    series = Series(home, random.Random(seed), tell)
    series.write()
    files = series.files()
    series._here("plain", "fork", None, "the first campaign")  # what is opened only once is open now
    threads = threading.active_count()
    before = descriptors()
    for number in range(count):
        series.run(number)
        if (number + 1) % 20 == 0:
            tell(f"{number + 1} campaigns: {_counts(series.ends)}; {len(series.faults)} faults")
    series.finish()
    after = descriptors()
    series._expect(len(after) == len(before), f"descriptors are left: {_difference(after, before)}")
    series._expect(threading.active_count() == threads, f"threads are left: {threading.enumerate()}")
    series._expect(series.files() == files, "the user's files have changed")
    return {
        "campaigns": count,
        "ends": dict(series.ends),
        "descriptors": {"before": len(before), "after": len(after)},
        "outcomes": series.expected,
        "faults": series.faults,
    }


def _counts(ends: Counter[str]) -> str:
    return ", ".join(f"{count} {end}" for end, count in sorted(ends.items()))


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", action="store_true", help="print JSON instead of text")
    given = parser.parse_args()
    tell = (lambda text: None) if given.json else (lambda text: print(text, flush=True))
    with tempfile.TemporaryDirectory() as name:
        home, temporary = Path(name).resolve() / "projects", Path(name).resolve() / "tmp"
        temporary.mkdir()
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have had it ignored
        # All temporary files go to a folder of our own: others may be at work in the system's.
        os.environ["TMPDIR"] = tempfile.tempdir = str(temporary)
        found = run(home, given.count, given.seed, tell)
        shutil.rmtree(next(temporary.glob("pytest-of-*"), temporary / "none"), ignore_errors=True)
        left = sorted(
            path.name for path in temporary.iterdir()
        )  # bar the last folders of tests, which pytest keeps by design
        found["faults"] += [f"temporary files are left: {left}"] if left else []
        tempfile.tempdir = None
    if given.json:
        print(json.dumps(found, indent=2))
    else:
        show(found)
    return 1 if found["faults"] else 0


def show(found: dict[str, Any]) -> None:
    """Print the summary."""
    print(f"{found['campaigns']} campaigns in a row: {_counts(Counter(found['ends']))}")
    for project, outcomes in found["outcomes"].items():
        counts = Counter(text.partition(" in ")[0].removesuffix(" by None") for text in outcomes.values())
        print(f"  {project}: {_counts(counts)}")
    print("open descriptors: {before} before, {after} after".format(**found["descriptors"]))
    if found["faults"]:
        print(f"{len(found['faults'])} faults, see above")
    else:
        print("nothing is left: no process, no descriptor, no temporary file")


if __name__ == "__main__":
    sys.exit(main())
