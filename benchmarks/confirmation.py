"""What does it cost that the whole suite judges, and what does a sample of the survivors cost?

Each campaign runs three times in turn, in processes of its own: with the tests that reach the mutants alone
(what is noticed after one was left out is still judged by the whole suite), with all tests for all mutants,
and as ``mutabot run`` does by itself. Told are the processor seconds of all processes together, and what the
campaign says of its confirmation. The generated suite has functions that its tests check at once, late or
never; nineteen of twenty of its tests reach none of them.

Use: ``python benchmarks/confirmation.py [NAME …] [--tests N] [--pairs N]``; names are ``many``, ``scales``
and ``paper``.
"""

from __future__ import annotations

import argparse
import json
import math
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median
from textwrap import dedent

from mutabot.campaign import confirmation
from mutabot.campaign.request import Request
from mutabot.campaign.run import run_campaign
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot.journal.journal import Journal
from mutabot.model import Verdict
from mutabot.results.results import read_results

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
NAMES = ("many", "scales", "paper")
#: how a campaign is run
REACHING, WHOLE, USUAL = "reaching", "whole", "usual"
MODES = (REACHING, WHOLE, USUAL)
#: of the generated suite: functions of the program, tests for each, and a test's milliseconds
FUNCTIONS, EACH, WORK = 10, 5, 1
ROBOT = """
    class Arm:
        def __init__(self):
            self.x = 0.0

        def move_by(self, dx):
            self.x += dx
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Arm.move_by"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
"""
CONFIGURATION = """
    program = ["mission.py"]
    vocabulary = ["robot.toml"]
    pytest_args = ["-o", "pythonpath=."]
"""
WORKING = f"""
    from time import process_time

    def work():
        until = process_time() + {WORK / 1e3}
        while process_time() < until:
            pass

"""


class Silent:
    """A progress that says nothing."""

    def stage(self, text: str, total: int | None = None) -> None:
        """Ignore it."""

    def advance(self, line: str | None = None) -> None:
        """Ignore it."""

    def note(self, text: str) -> None:
        """Ignore it."""


def generate(folder: Path, tests: int) -> Path:
    """Tests of one function come every so often; most functions are checked at once, few late, few never."""
    lines = [dedent(WORKING), "import mission\nfrom robot import Arm\n"]
    mission = [
        f"def go_{number}(arm):\n    arm.move_by(0.25)\n    arm.move_by(0.5)\n" for number in range(FUNCTIONS)
    ]
    step = tests // (FUNCTIONS * EACH)
    for number in range(tests):
        lines.append(f"\ndef test_{number}():\n    work()\n")
        if number % step == 0 and number // step < FUNCTIONS * EACH:
            function, time = (number // step) % FUNCTIONS, (number // step) // FUNCTIONS
            lines.append(f"    arm = Arm()\n    mission.go_{function}(arm)\n")
            is_late, is_never = function % 10 == 0, function % 10 in (4, 7)
            if not is_never and (not is_late or time == EACH - 1):
                lines.append("    assert arm.x == 0.75\n")
    files = {
        "mission.py": "\n".join(mission), "robot.py": dedent(ROBOT), "robot.toml": dedent(VOCABULARY),
        "mutabot.toml": dedent(CONFIGURATION), "tests/test_many.py": "".join(lines),
    }  # fmt: skip
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def campaign(folder: Path, mode: str) -> None:
    """One campaign; prints what came of it."""
    if mode != USUAL:
        confirmation.LEAST = math.inf if mode == WHOLE else -1.0
    if mode == REACHING:
        confirmation._fixed = lambda campaign: -math.inf  # all else is dearer
        confirmation._affordable = lambda *given: iter(())
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, configuration.root)
    request = Request(
        configuration, vocabulary, rounds=1, seed=configuration.seed, jobs=2, fresh=True, repeats=False
    )
    with Journal.open(run_campaign(request, Silent())) as journal:
        outcomes = journal.outcomes()
        confirmed = read_results(journal).confirmation
    print(
        json.dumps(
            {
                "mutants": len(outcomes),
                "survived": sum(one.verdict is Verdict.SURVIVED for one in outcomes),
                "verdicts": sorted((one.mutant, one.verdict) for one in outcomes),
                "text": confirmed.text if confirmed is not None else "",
            }
        )
    )


def timed(folder: Path, mode: str) -> tuple[float, dict[str, object]]:
    """Processor seconds of a campaign in a process of its own, and what came of it."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, __file__, "--campaign", str(folder), mode]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{folder.name} {mode} ended", file=sys.stderr, flush=True)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return seconds, json.loads(done.stdout.splitlines()[-1])


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", default=NAMES, metavar="NAME")
    parser.add_argument("--tests", type=int, default=1000, help="tests of the generated suite")
    parser.add_argument("--pairs", type=int, default=1, help="how often each is run; medians are told")
    parser.add_argument("--campaign", nargs=2, metavar=("FOLDER", "MODE"), help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.campaign:
        campaign(Path(given.campaign[0]), given.campaign[1])
        return
    print("| suite | mutants | survivors | reaching tests alone, s | whole suite for all, s | "
          "share beyond the reaching tests | `mutabot run`, s | of the first |")  # fmt: skip
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    told = []
    for name in given.names:
        with tempfile.TemporaryDirectory() as home:
            folder = Path(home).resolve() / name
            if name == "many":
                generate(folder, given.tests)
            else:
                shutil.copytree(EXAMPLES / name, folder, ignore=shutil.ignore_patterns(".mutabot"))
            runs = [{mode: timed(folder, mode) for mode in MODES} for _ in range(given.pairs)]
        seconds = {mode: median(run[mode][0] for run in runs) for mode in MODES}
        end = runs[-1][USUAL][1]
        beyond = 1 - seconds[REACHING] / seconds[WHOLE]
        print(
            f"| {name} | {end['mutants']} | {end['survived']} | {seconds[REACHING]:.1f} "
            f"| {seconds[WHOLE]:.1f} | {beyond:.0%} | {seconds[USUAL]:.1f} "
            f"| {seconds[USUAL] / seconds[REACHING]:.2f} |",
            flush=True,
        )
        told.append(f"{name}: {end['text'] or 'all were run with the whole suite'}")
        differing = [run for run in runs if len({str(run[mode][1]["verdicts"]) for mode in MODES}) > 1]
        told += [f"{name}: VERDICTS DIFFER in {len(differing)} of {len(runs)}"] if differing else []
    print("\n".join(["", *told]))


if __name__ == "__main__":
    main()
