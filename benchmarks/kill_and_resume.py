"""Kill campaigns with SIGKILL at random moments, finish them by running again, and compare with one that was
left in peace.

Use: ``python benchmarks/kill_and_resume.py [--kills 30] [--seed 1] [--rounds 2] [--engine auto]``. Prints
JSON; the exit code is 1 if anything is not as it must be: an outcome that differs or was lost, a process or a
file that was left behind, a file of the user's that changed.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import random
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from textwrap import dedent
from typing import Any

from mutabot.journal.journal import Journal
from mutabot.model.codec import to_data
from mutabot.results.results import read_results

FILES = {
    "mutabot.toml": """
        program = ["mission.py"]
        vocabulary = ["robot.toml"]
        pytest_args = ["-o", "pythonpath=."]
    """,
    "robot.toml": """
        refusals = ["robot:Refused"]

        [[operation]]
        call = "robot:Arm.move_by"
        arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }

        [[operation]]
        call = "robot:Arm.position"
        result = { kind = "position", axis = "x", unit = "m", noise = 0.5 }
    """,
    "robot.py": """
        import time

        class Refused(Exception):
            pass

        class Arm:
            def __init__(self):
                self.x = 0.0

            def move_by(self, dx):
                time.sleep(0.005)
                if not -1.0 <= self.x + dx <= 1.0:
                    raise Refused(f"{self.x + dx} is out of reach")
                self.x += dx

            def position(self):
                return self.x
    """,
    "mission.py": """
        def fetch(arm):
            arm.move_by(0.4)
            arm.move_by(0.3)
            if arm.position() < 0.6:
                raise RuntimeError("not there")
            arm.move_by(-0.5)

        def wander(arm):
            for step in range(6):
                arm.move_by(0.1 if arm.position() < 0.3 else -0.2)
            arm.move_by(0.5)
    """,
    "tests/test_fetch.py": """
        from robot import Arm
        import mission

        def test_fetch():
            arm = Arm()
            mission.fetch(arm)
            assert abs(arm.x - 0.2) < 0.05, arm.x
    """,
    "tests/test_wander.py": """
        import random
        from robot import Arm
        import mission

        def test_wander():
            arm = Arm()
            arm.x = round(random.random() / 10, 2)
            mission.wander(arm)
            assert arm.x > 0

        def test_both():
            arm = Arm()
            mission.fetch(arm)
            mission.wander(arm)
    """,
}
#: what differs between equal runs: times, also of recordings, and how often probes were read
_ACCIDENTAL = {"wall", "cpu", "diverged", "compared"}
#: seconds that what is left of a killed campaign may take to end
_DYING = 60.0

Pair = tuple[str, int]


@dataclass
class Trial:
    """One project, on which campaigns are killed again and again.

    Attributes:
        folder: the project.
        engine, rounds: options of the campaigns.
        faults: what was not as it must be.
        kills: how many campaigns were killed, by how far they were.
    """

    folder: Path
    engine: str
    rounds: int
    faults: list[str] = field(default_factory=list)
    kills: dict[str, int] = field(default_factory=dict)

    @property
    def journal(self) -> Path:
        """Where the campaign writes."""
        return self.folder / ".mutabot" / "journal.sqlite"

    def write(self) -> None:
        """Write the project."""
        for name, text in FILES.items():
            path = self.folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(dedent(text), encoding="utf-8")

    def start(self) -> subprocess.Popen[str]:
        """Start a campaign, as a user would."""
        words = [
            "-C",
            str(self.folder),
            "run",
            "-j",
            "2",
            "--engine",
            self.engine,
            "--rounds",
            str(self.rounds),
        ]
        return subprocess.Popen(
            [sys.executable, "-m", "mutabot.cli.app", *words],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )

    def finish(self) -> tuple[list[str], float]:
        """Run a campaign to its end: its outcomes and its seconds."""
        began = time.monotonic()
        process = self.start()
        _, said = process.communicate()
        self.expect(process.returncode == 0, f"a campaign ended with {process.returncode}: {said[-500:]}")
        return self.outcomes(), time.monotonic() - began

    def kill(self, after: float) -> bool:
        """Kill a campaign after so many seconds; whether it had not ended before."""
        process = self.start()
        try:
            process.wait(after)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
        process.communicate()
        killed = process.returncode == -signal.SIGKILL
        self.expect(killed or process.returncode == 0, f"a campaign ended with {process.returncode}")
        self.expect(self.is_quiet(), f"processes are left: {self.processes()}")
        if killed:
            phase = self.phase()
            self.kills[phase] = self.kills.get(phase, 0) + 1
        return killed

    def phase(self) -> str:
        """How far the campaign in the journal was."""
        if not self.has_begun():
            return "start-up"
        with Journal.open(self.journal) as journal:
            results = read_results(journal)
        if results.state == "complete":  # it was over; the kill came while the results were printed
            whole = len(results.mutants) * self.rounds
            self.expect(results.done == whole, f"complete with {results.done} of {whole} outcomes")
            return "printing"
        self.expect(results.state == "killed", f"a killed campaign is shown as {results.state}")
        if results.mutants:
            return "mutants" if results.done else "controls"
        return "baseline"

    def has_begun(self) -> bool:
        """Whether there is a journal: its file is there a little earlier."""
        if not self.journal.exists():
            return False
        with closing(sqlite3.connect(self.journal)) as connection:
            return connection.execute("SELECT 1 FROM sqlite_master").fetchone() is not None

    def known(self) -> set[Pair]:
        """The mutants and rounds that the journal has an outcome of."""
        if not self.has_begun():
            return set()
        with Journal.open(self.journal) as journal:
            found = {(outcome.mutant, outcome.round) for outcome in journal.outcomes()}
            return found | journal.kept().keys()

    def reused(self) -> set[Pair]:
        """The mutants and rounds that the last campaign did not run."""
        with Journal.open(self.journal) as journal:
            return journal.reused()

    def outcomes(self) -> list[str]:
        """All outcomes, bar what differs between equal runs."""
        with Journal.open(self.journal) as journal:
            found: list[dict[str, Any]] = [to_data(outcome) for outcome in journal.outcomes()]
        kept = ({name: row[name] for name in row if name not in _ACCIDENTAL} for row in found)
        return sorted(json.dumps(row, sort_keys=True) for row in kept)

    def files(self) -> dict[str, str]:
        """The user's files with a hash of each."""
        return {
            str(path.relative_to(self.folder)): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(self.folder.rglob("*"))
            if path.is_file() and ".mutabot" not in path.parts
        }

    def is_quiet(self) -> bool:
        """Whether all processes of the campaign end soon."""
        until = time.monotonic() + _DYING
        while self.processes():
            if time.monotonic() > until:
                return False
            time.sleep(0.02)
        return True

    def processes(self) -> list[str]:
        """Processes that work in the project."""
        found = []
        for entry in Path("/proc").iterdir():
            try:
                if entry.name.isdigit() and (entry / "cwd").readlink() == self.folder:
                    found.append((entry / "cmdline").read_bytes().replace(b"\0", b" ").decode())
            except OSError:
                continue
        return found

    def expect(self, is_so: bool, otherwise: str) -> None:
        """Note what is not as it must be."""
        if not is_so:
            self.faults.append(otherwise)


def run(trial: Trial, kills: int, seed: int) -> dict[str, Any]:
    """Kill so many campaigns and finish each; what came of it."""
    chance = random.Random(seed)
    trial.write()
    before = trial.files()
    expected, seconds = trial.finish()
    begun = resumed = 0
    while sum(trial.kills.values()) < kills and not trial.faults:
        for file in trial.journal.parent.glob("journal.*"):
            file.unlink()
        begun += 1
        known: set[Pair] = set()
        for _ in range(chance.randint(2, 6)):
            if sum(trial.kills.values()) >= kills or not trial.kill(chance.uniform(0.05, 1.0) * seconds):
                break
            found = trial.known()
            trial.expect(found >= known, f"outcomes were lost: {sorted(known - found)}")
            known = found
        outcomes, _ = trial.finish()
        again = known - trial.reused()
        trial.expect(not again, f"outcomes were run again: {sorted(again)}")
        different = sorted(set(outcomes) ^ set(expected))
        trial.expect(outcomes == expected, f"outcomes differ: {different}")
        resumed += len(known)
    trial.expect(trial.files() == before, "the user's files have changed")
    left = [path.name for path in trial.journal.parent.glob("work-*")]
    trial.expect(not left, f"files are left: {left}")
    return {
        "engine": trial.engine,
        "kills": trial.kills,
        "campaigns": begun,
        "outcomes": len(expected),
        "reused": resumed,
        "undisturbed_seconds": round(seconds, 2),
        "faults": trial.faults,
    }


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--engine", default="auto")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        trial = Trial(Path(folder).resolve(), given.engine, given.rounds)
        found = run(trial, given.kills, given.seed)
    print(json.dumps(found, indent=2))
    return 1 if found["faults"] else 0


if __name__ == "__main__":
    sys.exit(main())
