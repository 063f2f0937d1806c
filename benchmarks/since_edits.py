"""Edit small projects at random, run `--since HEAD`, and hold what it gives against a whole fresh campaign.

Use: ``python benchmarks/since_edits.py [--edits 40] [--seed 1] [--start 0] [--together 1] [--rounds 2]
[--projects errands,scales,paper,rescue] [--kinds program,moved,renamed,test,vocabulary,helper,hidden,kept,new
test]``. Campaigns are forks of one process that has loaded mutabot, without the plugins of pytest that are
installed if the paper is not among the projects. Prints a line per edit (or per ``--together`` edits of one
project) and JSON at the end; the exit
code is 1 if any outcome differs in anything but cost.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest import mock

from mutabot.campaign.reuse import parts
from mutabot.cli import campaign as _loaded_before_the_forks  # noqa: F401
from mutabot.cli.app import main as mutabot
from mutabot.execution.versions import versions
from mutabot.journal.reader import JournalReader
from mutabot.model.codec import to_data
from random_edits import EDITS, SUBJECTS, NotPossibleError, Subject

#: how often an edit of a kind is tried: many are not possible, or make the tests fail
TRIES = 8
#: what a run costs, which no two runs have alike; and how often probes were read, which follows from that
COST = {"wall", "cpu", "shared", "compared"}


@dataclass
class Tally:
    """What came of the edits.

    Attributes:
        edits: by kind.
        outcomes: of all campaigns after edits.
        run: how many of them ``--since`` ran.
        altered: how many of these differ from before the edit, or are new.
        wrong: what differs from the whole campaign.
    """

    edits: Counter[str] = field(default_factory=Counter)
    outcomes: int = 0
    run: Counter[str] = field(default_factory=Counter)
    altered: Counter[str] = field(default_factory=Counter)
    of_kind: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)


def campaign(folder: Path, rounds: int, *options: str) -> str | None:
    """Run one in a fork; returns what it said, or None where its baseline fails."""
    arguments = ["run", "--rounds", str(rounds), "--jobs", "1", "-o", "repeats=false", *options]
    with tempfile.TemporaryFile("w+", encoding="utf-8") as said:
        child = os.fork()
        if not child:
            code = 1
            try:
                os.chdir(folder)
                os.dup2(said.fileno(), 2)
                os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
                code = mutabot(arguments)
            finally:
                sys.stderr.flush()
                os._exit(code)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        said.seek(0)
        told = said.read()
    if code in (2, 3):
        return None
    if code:
        raise RuntimeError(f"mutabot {' '.join(arguments)} ended with {code}:\n{told[-3000:]}")
    return told


def outcomes_of(folder: Path) -> tuple[dict[tuple[str, int], dict[str, Any]], set[tuple[str, int]]]:
    """All outcomes without their cost, and which of them were taken over."""
    with JournalReader.open(folder / ".mutabot" / "journal.sqlite") as journal:
        found = {(outcome.mutant, outcome.round): to_data(outcome) for outcome in journal.outcomes()}
        reused = journal.reused()
    return {pair: without_cost(data) for pair, data in found.items()}, reused


def without_cost(outcome: dict[str, Any]) -> dict[str, Any]:
    """An outcome without what no two runs have alike: times of the wall clock."""
    kept = {name: value for name, value in outcome.items() if name not in COST}
    kept["diverged"] = [
        divergence if divergence["is_simulated"] else {**divergence, "at": None, "fault": None}
        for divergence in outcome["diverged"]
    ]
    return kept


def git(folder: Path, *command: str) -> None:
    identity = ["-c", "user.name=edits", "-c", "user.email=edits@localhost"]
    subprocess.run(["git", *identity, *command], cwd=folder, check=True, capture_output=True)


def before(folder: Path, subject: Subject, rounds: int) -> dict[tuple[str, int], dict[str, Any]]:
    """Write the project, commit it, and run it whole."""
    for name, text in subject.files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    git(folder, "init", "-q")
    git(folder, "add", "-A")
    git(folder, "commit", "-qm", "before")
    if campaign(folder, rounds, *subject.options) is None:
        raise RuntimeError(f"the tests of {folder} fail")
    return outcomes_of(folder)[0]


def one_edit(
    work: Path, original: Path, subject: Subject, kinds: list[str], chance: random.Random, rounds: int
) -> tuple[str, str, Path, Path] | None:
    """Edit a copy and run both campaigns; None if the edit cannot be made, or the tests fail after it."""
    folder, whole = work / "since", work / "whole"
    for folder_to_remove in (folder, whole):
        shutil.rmtree(folder_to_remove, ignore_errors=True)
    shutil.copytree(original, folder)
    try:
        told = " and ".join(EDITS[kind](folder, subject, chance) for kind in kinds)
    except NotPossibleError:
        return None
    shutil.copytree(folder, whole, ignore=shutil.ignore_patterns(".mutabot"))
    said = campaign(folder, rounds, "--since", "HEAD", *subject.options)
    if said is None or campaign(whole, rounds, *subject.options) is None:
        return None
    return told, said, folder, whole


def compare(
    tally: Tally, kind: str, told: str, old: dict[Any, Any], folder: Path, whole: Path
) -> tuple[int, int, int]:
    """Note what differs; returns how many outcomes there are, were run, and are not as before."""
    (found, reused), (right, _) = outcomes_of(folder), outcomes_of(whole)
    if (
        kind == "new test"
    ):  # a test that does not reach a mutant is not asked: how much was run and compared differs
        for outcome in (*found.values(), *right.values()):
            for fact in ("tests", "simulated"):
                outcome.pop(fact, None)
    for pair in sorted(found.keys() | right.keys()):
        if found.get(pair) != right.get(pair):
            first, second = found.get(pair) or {}, right.get(pair) or {}
            fields = [name for name in {**first, **second} if first.get(name) != second.get(name)]
            how = "taken over" if pair in reused else "run"
            shown = {name: (first.get(name), second.get(name)) for name in fields}
            tally.wrong.append(f"{told}: {pair} ({how}): {shown}")
    run = found.keys() - reused
    altered = {pair for pair in run if lasting(old.get(pair)) != lasting(right.get(pair))}
    tally.edits[kind] += told.count(" and ") + 1
    tally.outcomes += len(found)
    tally.of_kind[kind] += len(found)
    tally.run[kind] += len(run)
    tally.altered[kind] += len(altered)
    return len(found), len(run), len(altered)


def lasting(outcome: dict[str, Any] | None) -> str:
    """An outcome without lines, which every edit above them moves."""
    return re.sub(r"\.py:\d+", ".py", json.dumps(outcome, sort_keys=True, default=str))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--edits", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--start", type=int, default=0, help="number of the first edit: go on where one ended"
    )
    parser.add_argument("--together", type=int, default=1, help="edits of one kind for each campaign")
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--projects", default="errands,scales,errands,paper,scales")
    parser.add_argument("--kinds", default=",".join(EDITS))
    given = parser.parse_args()
    names, kinds = given.projects.split(","), given.kinds.split(",")
    tally = Tally()
    if "paper" not in names:  # whose tests need a plug-in
        os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    found = versions()
    mock.patch.object(parts, "versions", return_value=found).start()  # no package changes meanwhile
    with tempfile.TemporaryDirectory(prefix="mutabot-edits-") as place:
        work = Path(place)
        known: dict[str, tuple[Path, Subject, dict[Any, Any]]] = {}
        number = given.start
        while sum(tally.edits.values()) < given.edits:
            seed = f"{given.seed}:{number}"
            chance = random.Random(seed)
            name, kind = names[number % len(names)], kinds[number % len(kinds)]
            number += 1
            if name not in known:
                subject, folder = SUBJECTS[name](), work / name
                known[name] = folder, subject, before(folder, subject, given.rounds)
            original, subject, old = known[name]
            edits = [kind] * given.together
            tries = (one_edit(work, original, subject, edits, chance, given.rounds) for _ in range(TRIES))
            done = next((attempt for attempt in tries if attempt is not None), None)
            if done is None:
                continue
            told, said, since, whole = done
            wrong = len(tally.wrong)
            count, run, altered = compare(tally, kind, told, old, since, whole)
            state = "SAME" if len(tally.wrong) == wrong else "DIFFERS"
            print(
                f"{seed:>5} {name:8} {kind:10} {state}: {run:3} of {count} run, {altered:3} altered; {told}",
                flush=True,
            )
            for line in said.splitlines():
                if "to run: " in line or "not judged" in line:
                    print(f"        {line.strip()}", flush=True)
    print(json.dumps({
        "seed": given.seed, "next": number, "edits": dict(tally.edits), "outcomes": tally.outcomes,
        "run": dict(tally.run), "altered": dict(tally.altered), "of": dict(tally.of_kind),
        "wrong": [line[:300] for line in tally.wrong[:20]],
    }, indent=1))  # fmt: skip
    return 1 if tally.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
