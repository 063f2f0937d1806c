"""What `mutabot suggest` does for the examples: scores before and after, and false alarms in fresh seeds.

    python benchmarks/suggested_checks.py [--seeds N] [example ...]

Runs `mutabot run` and `mutabot suggest` on a copy of each example, with all mutants of family `robot`,
applies the diff, runs the campaign again, and then the changed tests by plain pytest once per seed, 200 of a
campaign seed that nothing was measured with. Prints both scores per family and role, the survivors that are
left with the reason, and how many runs failed. Exits with 1 if one did, or if no score rose although the diff
has a check: those that are to be added by hand, as to scenarios, are only listed.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import pytest

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
NAMES = ("paper", "pick_and_place", "scales")
#: campaign seed of the runs that look for false alarms; the examples' own is 1
OTHER_SEED = "20260"


def main() -> int:
    """All examples that are named; the exit code says whether each did as it should."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("examples", nargs="*", default=NAMES)
    parser.add_argument("--seeds", type=int, default=200)
    parser.add_argument("--alarms", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.alarms:
        print(json.dumps(_run_all(given.examples, given.seeds)))
        return 0
    good = [_example(name, given.seeds) for name in given.examples]
    return int(not all(good))


def _example(name: str, seeds: int) -> bool:
    with tempfile.TemporaryDirectory(prefix="suggested-") as home:
        project = Path(home, name)
        shutil.copytree(EXAMPLES / name, project, ignore=shutil.ignore_patterns(".mutabot", "__pycache__"))
        before = _mutabot(project, "run", "--family", "robot", "--json")
        found = _mutabot(project, "suggest", "--json")
        tests = sorted({proposal["test"] for proposal in found["suggestions"] if not proposal["by_hand"]})
        if tests:
            subprocess.run(["patch", "-p1", "-s"], cwd=project, input=found["diff"], text=True, check=True)
        after = _mutabot(project, "run", "--family", "robot", "--json")
        alarms = _alarms(project, tests, seeds) if tests else []
    print(f"\n## {name}\n")
    print("| family · role | score before | after | check score before | after |\n|---|---|---|---|---|")
    for old, new in zip(before["groups"], after["groups"], strict=True):
        cells = [old["score"], new["score"], old["check_score"], new["check_score"]]
        print(
            f"| {old['family']} · {old['role']} |", " | ".join(f"{100 * cell:.1f} %" for cell in cells), "|"
        )
    for suggestion in found["suggestions"]:
        kills = ", ".join(f"#{kill['mutant']['number']}" for kill in suggestion["kills"])
        print(f"\n- `{suggestion['statement']}` ({suggestion['runs']} runs) kills {kills}")
    for survivor in found["unsolved"]:
        mutant = survivor["mutant"]
        word = "never" if survivor["never"] else "not"
        print(f"- {word}: #{mutant['number']} {mutant['description']}: {survivor['reason']}")
    print(f"\nfalse alarms: {len(alarms)} of {seeds} runs {alarms[:3] or ''}", flush=True)
    print(f"dropped in the proof: {len(found['dropped'])}", flush=True)
    rose = [new["score"] > old["score"] for old, new in zip(before["groups"], after["groups"], strict=True)]
    return not alarms and (any(rose) or not tests)


def _mutabot(project: Path, *words: str) -> dict[str, Any]:
    command = [sys.executable, "-m", "mutabot", "-C", str(project), *words]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def _alarms(project: Path, tests: list[str], seeds: int) -> list[str]:
    """The seeds with which a test fails on the original, each with the last lines of what pytest said."""
    command = [sys.executable, __file__, "--alarms", "--seeds", str(seeds), *tests]
    done = subprocess.run(command, cwd=project, stdout=subprocess.PIPE, text=True, check=True)
    found: list[str] = json.loads(done.stdout.splitlines()[-1])
    return found


def _run_all(tests: list[str], seeds: int) -> list[str]:
    """One plain pytest per seed, each a fork of this process, which has imported what takes long."""
    for name in ("numpy", "mujoco", "mink", "ruckig"):
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
    os.environ["MUTABOT_CAMPAIGN_SEED"] = OTHER_SEED
    sys.path.insert(0, "")  # as `python -m pytest` has it
    found = []
    with tempfile.TemporaryFile() as said:
        for round in range(1, seeds + 1):
            child = os.fork()
            if child == 0:
                os.environ["MUTABOT_ROUND"] = str(round)
                os.dup2(said.fileno(), 1)
                code = pytest.main(["-q", "-p", "no:cacheprovider", *tests])
                sys.stdout.flush()
                os._exit(code)
            _, status = os.waitpid(child, 0)
            if status:
                said.seek(max(0, said.seek(0, os.SEEK_END) - 600))
                found.append(f"{round}: {said.read().decode(errors='replace')}")
    return found


if __name__ == "__main__":
    sys.exit(main())
