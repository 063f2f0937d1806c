"""A campaign of ten thousand mutants: is the controller's memory flat, and does no mutant cost more than
the first ones?

The program is made for it: many tests of equal length with equally many mutants each, so that what a mutant
costs does not depend on where it stands. Watched from outside while it runs: the journal's outcomes, the
memory of the controller, and the time of the clock and of the processors. Then the same size once more:
``results``, ``list``, and a second ``run`` that takes over every outcome.

Promises, each a ratio within the one run, for the machine may be busy with other things:

- the last tenth of the outcomes takes at most 10 % longer per mutant than the first, in processor time and
  measured by a yardstick: a fork with a little work in it, over and over beside the campaign, which takes
  longer as well while others use the same processors;
- the controller's memory grows by at most 5 % from 10 % of the outcomes to all of them;
- ``results``, ``list`` and the second ``run`` each take less than a tenth of the campaign.

Use: ``python benchmarks/ten_thousand.py [--mutants 10000] [--jobs 2] [--json]``. The exit code is 1 if a
promise is broken.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from statistics import linear_regression, mean
from textwrap import dedent
from typing import Any

from mutabot.journal.database import LAST, connect_to_read

MOVES = 34  # per test
MUTANTS_PER_MOVE = 3  # skip, repeat, reverse
TESTS_PER_FILE = 25
#: seconds between two looks at the campaign, and looks between two uses of the yardstick
PAUSE, EVERY, YARDSTICKS = 0.1, 5, 5
FIRST_TENTH, LAST_TENTH = (0.001, 0.1), (0.9, 0.999)
SLOWER, LARGER, SHARE = 1.10, 1.05, 0.1
TICKS = os.sysconf("SC_CLK_TCK")
#: with fewer mutants a tenth has too few tests to say what a mutant costs
COMPARABLE = 4000

FILES = {
    "mutabot.toml": """
        program = ["missions"]
        vocabulary = ["robot.toml"]
        pytest_args = ["-o", "pythonpath=."]
    """,
    "robot.toml": """
        [[operation]]
        call = "robot:Arm.move_by"
        arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }

        [[probe]]
        call = "robot:position"
        tolerance = 1e-6
    """,
    "robot.py": """
        class Arm:
            x = 0.0

            def move_by(self, dx):
                Arm.x += dx

        def position():
            return Arm.x
    """,
}


@dataclass(frozen=True, slots=True)
class Sample:
    """One look at the running campaign.

    Attributes:
        outcomes: how many are in the journal.
        clock: seconds since the start.
        cpu: processor seconds of the controller and all below it.
        memory: the controller's resident memory, MB.
    """

    outcomes: int
    clock: float
    cpu: float
    memory: float


@dataclass
class Campaign:
    """The project, and what was seen of its campaign.

    Attributes:
        folder: the project.
        tests: number of its tests.
        jobs: how many processes compute at a time.
        samples: what was seen, in order.
        yardsticks: processor seconds that the yardstick took, with the number of outcomes by then.
    """

    folder: Path
    tests: int
    jobs: int
    samples: list[Sample] = field(default_factory=list)
    yardsticks: list[tuple[int, float]] = field(default_factory=list)

    @property
    def log(self) -> Path:
        """Where the campaign's output goes: beside the project, for it depends on all files inside."""
        return self.folder.with_suffix(".log")

    @property
    def mutants(self) -> int:
        """How many there are."""
        return self.tests * MOVES * MUTANTS_PER_MOVE

    def write(self) -> None:
        """Write the project."""
        for name, text in FILES.items():
            self._write(name, dedent(text))
        for number, start in enumerate(range(0, self.tests, TESTS_PER_FILE)):
            numbers = range(start, min(start + TESTS_PER_FILE, self.tests))
            self._write(f"missions/mission_{number}.py", "".join(map(mission, numbers)))
            head = f"import robot\nfrom missions import mission_{number} as mission\n"
            self._write(f"tests/test_{number}.py", head + "".join(map(test, numbers)))

    def _write(self, name: str, text: str) -> None:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def run(self) -> float:
        """Run the whole campaign and watch it; its seconds."""
        began = time.monotonic()
        with self.log.open("w", encoding="utf-8") as log:
            process = subprocess.Popen(self.command("run", "--engine", "fork"), stdout=log, stderr=log)
            for look in count():
                if process.poll() is not None:
                    break
                with suppress(OSError, sqlite3.Error):  # it is about to begin, or to end
                    self.samples.append(self._look(process.pid, time.monotonic() - began))
                if look % EVERY == 0 and self.samples:
                    self.yardsticks.append((self.samples[-1].outcomes, yardstick()))
                time.sleep(PAUSE)
        if process.returncode != 0:
            sys.exit(f"the campaign ended with {process.returncode}: {self.said()[-2000:]}")
        return time.monotonic() - began

    def said(self) -> str:
        """What the campaign printed."""
        return self.log.read_text(encoding="utf-8")

    def command(self, *words: str) -> list[str]:
        """The command line of the tool in this project."""
        jobs = ["-j", str(self.jobs)] if words[0] != "results" else []
        return [sys.executable, "-m", "mutabot.cli.app", "-C", str(self.folder), *words, *jobs]

    def timed(self, *words: str) -> float:
        """Seconds of another command in the project."""
        began = time.monotonic()
        done = subprocess.run(self.command(*words), capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"mutabot {' '.join(words)} ended with {done.returncode}: {done.stderr[-2000:]}")
        return time.monotonic() - began

    def counts(self) -> dict[str, int]:
        """How many outcomes the journal holds, by verdict."""
        with self._journal() as connection:
            rows = connection.execute(
                f"SELECT verdict, count(*) FROM outcome WHERE rowid IN ({LAST}) GROUP BY verdict"
            )
            return dict(rows)

    def reused(self) -> int:
        """How many outcomes the last campaign took over."""
        with self._journal() as connection:
            return int(connection.execute("SELECT count(*) FROM outcome WHERE reused").fetchone()[0])

    def _journal(self) -> sqlite3.Connection:
        return connect_to_read(self.folder / ".mutabot" / "journal.sqlite")

    def _look(self, pid: int, clock: float) -> Sample:
        connection = self._journal()
        try:
            (outcomes,) = connection.execute("SELECT max(rowid) FROM outcome").fetchone()
        finally:
            connection.close()
        return Sample(outcomes or 0, clock, sum(map(cpu_of, family(pid))), memory_of(pid))

    def at(self, share: float) -> Sample:
        """The first look at which this share of the outcomes was in the journal."""
        reached = (sample for sample in self.samples if sample.outcomes >= share * self.mutants)
        return next(reached, self.samples[-1])


def mission(number: int) -> str:
    """One function of the robot program: large steps, which a test notices, and small ones."""
    steps = (0.2 if step % 2 else 0.001 for step in range(MOVES))
    return f"\n\ndef run_{number}(arm):\n" + "".join(f"    arm.move_by({step})\n" for step in steps)


def test(number: int) -> str:
    """The test of one such function."""
    expected = (MOVES // 2) * 0.201
    return dedent(f"""

        def test_{number}():
            robot.Arm.x = 0.0
            mission.run_{number}(robot.Arm())
            assert abs(robot.position() - {expected}) < 0.05
    """)


def family(pid: int) -> Iterator[int]:
    """A process and all that it started and that still run."""
    yield pid
    for child in Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii").split():
        yield from family(int(child))


def cpu_of(pid: int) -> float:
    """Processor seconds of a process and of all it has waited for; none of one that has just ended."""
    with suppress(OSError):
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
        return sum(map(int, fields[11:15])) / TICKS
    return 0.0


def memory_of(pid: int) -> float:
    """Resident memory of a process, MB."""
    pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def yardstick() -> float:
    """Processor seconds of a fork with a little work in it."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    pid = os.fork()
    if pid == 0:
        sum(len(str(number)) for number in range(20_000))
        os._exit(0)
    os.waitpid(pid, 0)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def within(samples: Sequence[Sample], first: int, last: int) -> Sequence[Sample]:
    """The looks between two numbers of outcomes, with the last before them and the first after them.

    On a fast machine a tenth may pass between two looks: those around it still tell its slope.
    """
    start = max((at for at, sample in enumerate(samples) if sample.outcomes < first), default=0)
    ends = (at for at, sample in enumerate(samples) if sample.outcomes > last)
    return samples[start : next(ends, len(samples)) + 1]


def per_mutant(campaign: Campaign, tenth: tuple[float, float]) -> dict[str, float]:
    """Milliseconds per mutant within a tenth: by the clock, of the processors, and these in yardsticks."""
    first, last = (round(share * campaign.mutants) for share in tenth)
    seen = within(campaign.samples, first, last)
    outcomes = [sample.outcomes for sample in seen]
    # a slope, and not a difference: outcomes come in heaps, and a look may fall into the middle of one
    clock = linear_regression(outcomes, [sample.clock for sample in seen]).slope
    cpu = linear_regression(outcomes, [sample.cpu for sample in seen]).slope
    middle = (first + last) / 2
    nearest = sorted(campaign.yardsticks, key=lambda yard: abs(yard[0] - middle))[:YARDSTICKS]
    used = mean(took for _, took in nearest)
    return {
        "clock_ms": round(1e3 * clock, 3),
        "cpu_ms": round(1e3 * cpu, 3),
        "yardsticks": round(cpu / used, 3),
    }


def tenths(campaign: Campaign) -> dict[str, Any]:
    """What a mutant costs in the first tenth and in the last, how they compare, and how memory has grown."""
    first, last = per_mutant(campaign, FIRST_TENTH), per_mutant(campaign, LAST_TENTH)
    return {
        "first_tenth": first,
        "last_tenth": last,
        "slower": {name: round(last[name] / first[name], 3) for name in first},
        "larger": round(campaign.at(1.0).memory / campaign.at(0.1).memory, 3),
    }


def measure(campaign: Campaign) -> dict[str, Any]:
    """Run everything; the numbers."""
    campaign.write()
    seconds = campaign.run()
    counts = campaign.counts()
    began, ended = campaign.at(0.1), campaign.samples[-1]
    shares = {word: round(campaign.timed(word) / seconds, 3) for word in ("results", "list", "run")}
    return {
        "mutants": campaign.mutants,
        "outcomes": counts,
        "seconds": round(seconds, 1),
        **(tenths(campaign) if campaign.mutants >= COMPARABLE else {}),
        "memory_mb": {"at 10 %": round(began.memory, 1), "at 100 %": round(campaign.at(1.0).memory, 1),
                      "last seen": round(ended.memory, 1)},
        "reused": campaign.reused(),
        "share_of_campaign": shares,
    }  # fmt: skip


def broken(found: dict[str, Any]) -> list[str]:
    """The promises that were not kept."""
    promises = {
        "some outcomes are missing": sum(found["outcomes"].values()) == found["mutants"],
        "some outcomes are errors": not {"error", "unstable", "timeout"} & found["outcomes"].keys(),
        "the second run did not take over all outcomes": found["reused"] == found["mutants"],
        **{f"`{word}` takes long": share < SHARE for word, share in found["share_of_campaign"].items()},
    }
    if "slower" in found:
        promises["the last mutants cost more than the first"] = found["slower"]["yardsticks"] <= SLOWER
        promises["the controller's memory grows"] = found["larger"] <= LARGER
    return [text for text, is_kept in promises.items() if not is_kept]


def show(found: dict[str, Any]) -> None:
    """Print the numbers."""
    verdicts = ", ".join(f"{count} {verdict}" for verdict, count in found["outcomes"].items())
    memory, shares = found["memory_mb"], found["share_of_campaign"]
    print(f"{found['mutants']} mutants in {found['seconds']} s: {verdicts}")
    units = {
        "yardsticks": "in yardsticks",
        "cpu_ms": "in ms of the processors",
        "clock_ms": "in ms by the clock",
    }
    for name, text in units.items() if "slower" in found else ():
        first, last = found["first_tenth"][name], found["last_tenth"][name]
        ratio = found["slower"][name]
        print(f"time per mutant {text}: first tenth {first}, last tenth {last}, ratio {ratio}")
    print("memory of the controller: " + ", ".join(f"{mb} MB {when}" for when, mb in memory.items()))
    if "larger" in found:
        print(f"  from 10 % to 100 % of the outcomes: ratio {found['larger']}")
    print(
        "of the campaign's time take: " + ", ".join(f"{word} {share:.1%}" for word, share in shares.items())
    )
    print(f"the second run took over {found['reused']} outcomes")


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--mutants",
        type=int,
        default=10_000,
        help=f"at least so many; tenths are compared from {COMPARABLE} on",
    )
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--json", action="store_true", help="print JSON instead of text")
    given = parser.parse_args()
    tests = -(-given.mutants // (MOVES * MUTANTS_PER_MOVE))
    with tempfile.TemporaryDirectory() as name:
        found = measure(Campaign(Path(name).resolve() / "project", tests, given.jobs))
    wrong = broken(found)
    if given.json:
        print(json.dumps({**found, "broken": wrong}, indent=2))
    else:
        show(found)
        print("\n".join(f"BROKEN: {text}" for text in wrong) or "all promises are kept")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
