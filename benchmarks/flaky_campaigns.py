"""What tests that fail at random do to campaigns: false kills.

    python benchmarks/flaky_campaigns.py --count 100 --chance 3 --chance 10

A small project has a test that lets nearly everything through and fails at random, and one that checks. Each
campaign has another seed. It is compared with the same campaign without chance, whose verdicts are the truth:
a kill of a mutant that survives there is false, and a survivor that is killed there as well. Prints the false
kills per campaign that repeats left, how many there were before, and how often the interval that the
campaign reports held the number that was left.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path
from textwrap import dedent

from mutabot.campaign.request import Progress, Request
from mutabot.campaign.run import run_campaign
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot.errors import MutabotError
from mutabot.journal.journal import Journal
from mutabot.model import Verdict
from mutabot.results.results import Results, read_results
from mutabot.results.statistics import Estimate, false_kills, false_survivors

_FILES = {
    "robot.py": """
        class Arm:
            def __init__(self):
                self.x = self.y = 0.0

            def move_x(self, dx):
                self.x += dx

            def move_y(self, dy):
                self.y += dy
        """,
    "mission.py": """
        def run(arm):
        {calls}
        """,
    "tests/test_mission.py": """
        import random

        import mission
        import pytest
        from robot import Arm

        @pytest.fixture
        def arm():
            return Arm()

        def test_flaky(arm):
            mission.run(arm)
            assert random.SystemRandom().random() >= {chance}

        def test_checks_x(arm):
            mission.run(arm)
            assert arm.x == {x}
        """,
    "robot.toml": """
        [[operation]]
        call = "robot:Arm.move_x"
        arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }

        [[operation]]
        call = "robot:Arm.move_y"
        arguments.dy = { kind = "translation", axis = "y", unit = "m", mode = "by" }
        """,
    "mutabot.toml": """
        program = ["mission.py"]
        vocabulary = ["robot.toml"]
        pytest_args = ["-o", "pythonpath=."]
        unstable_limit = 1.0
        """,
}


@dataclass(slots=True)
class Tally:
    """What a series of campaigns came to.

    Attributes:
        campaigns: that ended with verdicts.
        before, left, most: false kills before and after repeats, and the most that were left in a campaign.
        unstable: outcomes that are unstable.
        told, held: campaigns whose interval speaks of all kills, and in how many it held the number left.
        survivors: false survivors.
        stopped: campaigns that ended without verdicts, by how.
        seconds: their wall time.
    """

    campaigns: int = 0
    before: int = 0
    left: int = 0
    most: int = 0
    unstable: int = 0
    told: int = 0
    held: int = 0
    survivors: int = 0
    stopped: int = 0
    seconds: float = 0.0


class _Silent(Progress):
    """A progress that shows nothing."""


def write_project(folder: Path, chance: float, moves: int) -> None:
    """A program with so many moves along x and twice as many along y, which only x is checked of."""
    calls = [f"arm.move_x({2.0**-n})" for n in range(1, moves + 1)]
    calls += [f"arm.move_y({2.0**-n})" for n in range(1, 2 * moves + 1)]
    values = {
        "{calls}": "\n".join(f"    {call}" for call in calls),
        "{chance}": str(chance),
        "{x}": str(sum(2.0**-n for n in range(1, moves + 1))),
    }
    for name, text in _FILES.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        content = dedent(text)
        for key, value in values.items():
            content = content.replace(key, value)
        path.write_text(content, encoding="utf-8")


def campaign(folder: Path, seed: int, *, repeats: bool = True) -> Results:
    """One campaign; raises MutabotError if it ends without verdicts."""
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, configuration.root)
    request = Request(configuration, vocabulary, rounds=1, seed=seed, jobs=2, fresh=True)
    path = run_campaign(replace(request, repeats=repeats), _Silent())
    with Journal.open(path) as journal:
        return read_results(journal)


def add(tally: Tally, results: Results, truth: dict[str, Verdict]) -> None:
    """Count one campaign."""
    left = before = survivors = 0
    for result in results.mutants:
        for outcome in result.outcomes:
            is_true = truth[result.mutant.id].is_killed
            was_killed = outcome.verdict is Verdict.KILLED or (outcome.message or "").startswith("killed")
            before += was_killed and not is_true
            left += outcome.verdict is Verdict.KILLED and not is_true
            survivors += outcome.verdict is Verdict.SURVIVED and is_true
            tally.unstable += outcome.verdict is Verdict.UNSTABLE
    tally.campaigns += 1
    tally.before += before
    tally.left += left
    tally.most = max(tally.most, left)
    tally.survivors += survivors
    estimate = false_kills(results.repeats)
    if estimate is not None and not estimate.unknown:
        tally.told += 1
        tally.held += _holds(estimate, left) and _holds(false_survivors(results.repeats), survivors)


def _holds(estimate: Estimate | None, number: int) -> bool:
    return estimate is None or estimate.low <= number <= estimate.high


def series(chance: float, count: int, moves: int) -> Tally:
    """So many campaigns with this probability."""
    tally = Tally()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_project(folder, 0.0, moves)
        exact = campaign(folder, 1, repeats=False)
        truth = {result.mutant.id: result.outcomes[0].verdict for result in exact.mutants}
        write_project(folder, chance, moves)
        started = time.monotonic()
        for seed in range(count):
            try:
                add(tally, campaign(folder, seed), truth)
            except MutabotError as error:
                tally.stopped += 1
                print(f"\rstopped: {error}", file=sys.stderr)
            with contextlib.suppress(OSError):
                print(f"\r{seed + 1}/{count} ", end="", file=sys.stderr, flush=True)
        tally.seconds = time.monotonic() - started
    return tally


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--count", type=int, default=100, help="campaigns per row")
    parser.add_argument("--chance", type=float, action="append", help="percent of runs that fail at random")
    parser.add_argument("--moves", type=int, default=4, help="size of the program")
    options = parser.parse_args()
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"  # they only take time here
    print("| chance | campaigns | stopped | false kills, first | left, most in one "
          "| unstable | false survivors | interval held | s each |")  # fmt: skip
    print("|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    wrong = 0
    for percent in options.chance or [3.0, 10.0]:
        tally = series(percent / 100, options.count, options.moves)
        n = max(1, tally.campaigns)
        print(
            f"\r| {percent:g} % | {tally.campaigns} | {tally.stopped} "
            f"| {tally.before / n:.2f} | {tally.left / n:.2f}, {tally.most} | {tally.unstable / n:.2f} "
            f"| {tally.survivors / n:.2f} | {tally.held} of {tally.told} "
            f"| {tally.seconds / options.count:.1f} |",
            flush=True,
        )
        wrong += tally.told > 0 and tally.held / tally.told < 0.9
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
