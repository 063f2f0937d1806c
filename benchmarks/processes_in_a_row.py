"""Campaigns in a row whose tests start processes: is anything left behind, and do they find the same?

Each runs on a copy of an example: that of ROS 2 and that of ROS 1 where these are installed, and the script
of ``scales``. After each of them there must be no process that began below it, and with these no port that
one waits at; of ROS, no shared memory that nobody uses any more, and no log outside the copy. The copy's
files must be as they were, and outcomes must end alike every time. No other program of ROS may run meanwhile.

Use: ``python benchmarks/processes_in_a_row.py [--count 20] [--examples ros2 …] [--rounds 1]
[--families robot,middleware …] [--selection published.txt] [--engine auto]``. The exit code is 1 if anything
is left behind or differs.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib.util
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from mutabot.campaign.request import Progress, Request
from mutabot.campaign.run import run_campaign
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot.families import USUAL
from mutabot.journal.journal import Journal

ROOT = Path(__file__).resolve().parent.parent
#: example to the folder in it with the project, and the module that it needs
EXAMPLES = {"ros2": (".", "rclpy"), "ros1": (".", "rospy"), "scales": ("script", "pytest")}
SHARED = Path("/dev/shm")
LOGS = Path.home() / ".ros" / "log"


class Silent(Progress):
    """A progress that shows nothing."""


def request_for(folder: Path, given: argparse.Namespace) -> Request:
    """Nothing is taken over from the last campaign."""
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, configuration.root)
    jobs = len(os.sched_getaffinity(0))
    return Request(
        configuration,
        vocabulary,
        given.rounds,
        configuration.seed,
        jobs,
        engine=given.engine,
        families=tuple(given.families.split(",")),
        only=(f"@{folder / given.selection}",) if given.selection else (),
        fresh=True,
    )


def ends(request: Request) -> dict[str, str]:
    """Run a campaign: how each mutant ends in each round."""
    with Journal.open(run_campaign(request, Silent())) as journal:
        return {
            f"{outcome.mutant} in round {outcome.round + 1}": f"{outcome.verdict} {outcome.by}"
            for outcome in journal.outcomes()
        }


def processes_below(folder: Path) -> list[str]:
    """Processes that carry the folder in their environment, or work in it."""
    own, found = os.fsencode(folder), []
    for process in Path("/proc").iterdir():
        if not process.name.isdigit() or int(process.name) == os.getpid():
            continue
        try:
            works = own in os.fsencode((process / "cwd").readlink())
            if works or own in (process / "environ").read_bytes():
                found.append(
                    (process / "cmdline").read_bytes().replace(b"\0", b" ").decode("utf-8", "replace")
                )
        except OSError:  # it has just ended, or is another user's
            continue
    return found


def unused(names: set[str]) -> list[str]:
    """Those of these files in shared memory that no process has mapped or opened."""
    used: set[str] = set()
    for process in Path("/proc").iterdir():
        if process.name.isdigit():
            try:
                used.update(
                    line.split("/dev/shm/")[1] for line in lines_of(process / "maps") if "/dev/shm/" in line
                )
                used.update(path.readlink().name for path in (process / "fd").iterdir())
            except OSError:
                continue
    return sorted(names - used)


def lines_of(file: Path) -> list[str]:
    """A file's lines."""
    return file.read_text("utf-8", "replace").splitlines()


def digest(folder: Path) -> str:
    """What the user's files are."""
    found = hashlib.sha256()
    for file in sorted(folder.rglob("*")):
        if file.is_file() and ".mutabot" not in file.parts:
            found.update(os.fsencode(file.relative_to(folder)) + file.read_bytes())
    return found.hexdigest()


def entries(folder: Path) -> set[str]:
    """Names in a folder, if it is there."""
    return {path.name for path in folder.iterdir()} if folder.is_dir() else set()


def run(example: str, given: argparse.Namespace) -> list[str]:
    """So many campaigns: what is wrong."""
    wrong: list[str] = []
    below = EXAMPLES[example][0]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve() / example
        shutil.copytree(
            ROOT / "examples" / example, folder, ignore=shutil.ignore_patterns(".mutabot", "__pycache__")
        )
        files = digest(folder)
        first: dict[str, Any] = {}
        for number in range(1, given.count + 1):
            shared, logs, began = entries(SHARED), entries(LOGS), time.monotonic()
            found = ends(request_for(folder / below, given))
            first = first or found
            left = [f"process {process}" for process in processes_below(folder)]
            if example != "scales":
                left += [f"shared memory {segment}" for segment in unused(entries(SHARED) - shared)]
                left += [f"log {entry}" for entry in sorted(entries(LOGS) - logs)]
            left += [f"files of {example} have changed"] if digest(folder) != files else []
            left += [
                f"{key}: {first.get(key)}, then {end}" for key, end in found.items() if first.get(key) != end
            ]
            wrong += [f"{example}, campaign {number}: {left_over}" for left_over in left]
            place = f"{example} {number}/{given.count}"
            seconds = time.monotonic() - began
            print(f"{place}: {len(found)} outcomes, {seconds:.1f} s, {len(left)} wrong", flush=True)
    return wrong


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--examples", nargs="+", default=list(EXAMPLES), choices=list(EXAMPLES))
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--families", default=",".join(USUAL))
    parser.add_argument("--selection", help="a file of the example with the ids of mutants")
    given = parser.parse_args()
    there = [
        example for example in given.examples if importlib.util.find_spec(EXAMPLES[example][1]) is not None
    ]
    for missing in sorted(set(given.examples) - set(there)):
        print(f"{missing} is left out: {EXAMPLES[missing][1]} is not installed")
    wrong = [finding for example in there for finding in run(example, given)]
    print("\n".join(wrong) or "nothing is left behind, and all campaigns find the same")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
