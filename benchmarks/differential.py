"""Do both engines find the same? Mutants of the examples by ``fork`` and by ``replay``, side by side.

Every mutant, but of tracking and palletising a random sample: a suite that takes minutes takes replay hours.

Compared of each (mutant, round): verdict, what noticed it, the test, the message, and all else that an
outcome says but what it cost. The tests of a mutant run one after the other until one decides, so two equal
outcomes stand for as many equal (mutant, test, round) outcomes as tests were run.

Use: ``python benchmarks/differential.py [--examples paper …] [--rounds N] [--sample N]
[--families conventional …] [--json]``. Each example runs in a copy. The exit code is 1 if the engines
disagree anywhere, or if there is nothing to compare.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from mutabot.campaign.request import Progress, Request
from mutabot.campaign.run import run_campaign
from mutabot.config.configuration import load_configuration
from mutabot.config.options import Sample
from mutabot.config.vocabulary import load_vocabulary
from mutabot.journal.journal import Journal
from mutabot.model import Outcome
from mutabot.model.codec import to_data

ROOT = Path(__file__).resolve().parent.parent
#: example to its rounds; one round of pick_and_place takes replay minutes
EXAMPLES = {"paper": 5, "pick_and_place": 1, "scales": 1, "tracking": 1, "palletising": 1}
#: example to the number of mutants drawn by the campaign's seed; all of the others
SAMPLES = {"tracking": 40, "palletising": 20}
FAMILIES = ("robot", "conventional", "text")
ENGINES = ("fork", "replay")
#: what two engines may differ in: what an outcome cost, and who found it
COST = {"wall", "cpu", "shared", "engine", "repeats"}

Key = tuple[str, int]


@dataclass(frozen=True, slots=True)
class Disagreement:
    """A fact about a mutant in a round that the engines tell differently."""

    mutant: str
    round: int
    fact: str
    fork: Any
    replay: Any


@dataclass(frozen=True, slots=True)
class Row:
    """What came of one example.

    Attributes:
        example, rounds: what was run.
        mutants: number of mutants.
        mutant_rounds: number of outcomes compared.
        outcomes: number of (mutant, test, round) that these stand for.
        fallen_back: mutant-rounds that did not come from forks, because it was not safe to fork.
        disagreements: where the engines differ.
        seconds: what each engine took, baseline included.
    """

    example: str
    rounds: int
    mutants: int
    mutant_rounds: int
    outcomes: int
    fallen_back: int
    disagreements: tuple[Disagreement, ...]
    seconds: Mapping[str, float]


class Silent(Progress):
    """A progress that shows nothing."""


def compare(
    example: str, rounds: int, families: tuple[str, ...] = ("robot",), sample: int | None = None
) -> Row:
    """Run one example, or so many of its mutants, with both engines in the same copy of it."""
    found: dict[str, dict[Key, Outcome]] = {}
    seconds: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve() / example
        ignored = shutil.ignore_patterns(".mutabot", "__pycache__")
        shutil.copytree(ROOT / "examples" / example, folder, ignore=ignored)
        for engine in ENGINES:
            began = time.monotonic()
            request = request_for(folder, engine, rounds, families, sample)
            with Journal.open(run_campaign(request, Silent())) as journal:
                found[engine] = {(outcome.mutant, outcome.round): outcome for outcome in journal.outcomes()}
            seconds[engine] = round(time.monotonic() - began, 1)
    forked = found["fork"].values()  # some of them may have fallen back to replay
    return Row(
        example=example,
        rounds=rounds,
        mutants=len({outcome.mutant for outcome in forked}),
        mutant_rounds=len(found["fork"]),
        outcomes=sum(outcome.tests for outcome in forked),
        fallen_back=sum(bool(outcome.tests) and outcome.engine != "fork" for outcome in forked),
        disagreements=tuple(disagreements(found["fork"], found["replay"])),
        seconds=seconds,
    )


def request_for(
    folder: Path, engine: str, rounds: int, families: tuple[str, ...] = ("robot",), sample: int | None = None
) -> Request:
    """The campaign: all mutants or so many of them, and nothing taken over from the other engine."""
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, configuration.root)
    jobs = len(os.sched_getaffinity(0))
    return Request(
        configuration, vocabulary, rounds, configuration.seed, jobs,
        engine="auto" if engine == "fork" else engine, fresh=True, families=families,
        sample=None if sample is None else Sample.parse(str(sample)),
    )  # fmt: skip


def disagreements(fork: Mapping[Key, Outcome], replay: Mapping[Key, Outcome]) -> list[Disagreement]:
    """Every fact in which the outcomes of the engines differ."""
    found = []
    for mutant, number in sorted({*fork, *replay}):
        pair = [facts(outcomes.get((mutant, number))) for outcomes in (fork, replay)]
        for fact in dict.fromkeys([*pair[0], *pair[1]]):
            first, second = (outcome.get(fact) for outcome in pair)
            if first != second:
                found.append(Disagreement(mutant, number, fact, first, second))
    return found


def facts(outcome: Outcome | None) -> dict[str, Any]:
    """Everything about an outcome but its cost."""
    data = {"verdict": "no outcome"} if outcome is None else to_data(outcome)
    return {name: value for name, value in data.items() if name not in COST}


def show(rows: list[Row]) -> None:
    """Print the table, and each disagreement below it."""
    table = Table(title="fork and replay on the same mutants")
    for heading in ("example", "rounds", "mutants", "mutant-rounds", "(mutant, test, round)", "fallen back",
                    "fork s", "replay s", "disagreements"):  # fmt: skip
        table.add_column(heading, justify="left" if heading == "example" else "right")
    for row in rows:
        numbers = (row.rounds, row.mutants, row.mutant_rounds, row.outcomes, row.fallen_back)
        seconds = (f"{row.seconds[engine]:.1f}" for engine in ENGINES)
        table.add_row(row.example, *map(str, numbers), *seconds, str(len(row.disagreements)))
    console = Console(width=130)
    console.print(table)
    for row in rows:
        for disagreement in row.disagreements:
            place = (
                f"{row.example}: {disagreement.mutant}, round {disagreement.round + 1}, {disagreement.fact}"
            )
            console.print(
                f"{place}:\n  fork: {disagreement.fork!r}\n  replay: {disagreement.replay!r}", markup=False
            )
    outcomes = sum(row.outcomes for row in rows)
    wrong = len(
        {
            (row.example, difference.mutant, difference.round)
            for row in rows
            for difference in row.disagreements
        }
    )
    total = sum(row.mutant_rounds for row in rows)
    console.print(
        f"{total - wrong} of {total} mutant-rounds agree, over {outcomes} (mutant, test, round) outcomes"
    )


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--examples", nargs="+", default=list(EXAMPLES), choices=list(EXAMPLES))
    parser.add_argument("--rounds", type=int, help="of all examples; by default 5 of paper, 1 of the others")
    parser.add_argument("--sample", type=int, help="mutants of each example, instead of its own number")
    parser.add_argument("--families", nargs="+", default=["robot"], choices=FAMILIES)
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    given = parser.parse_args()
    rows = [
        compare(
            example,
            given.rounds or EXAMPLES[example],
            tuple(given.families),
            given.sample or SAMPLES.get(example),
        )
        for example in given.examples
    ]
    if given.json:
        print(json.dumps([asdict(row) for row in rows], indent=2))
    else:
        show(rows)
    return 0 if all(row.outcomes and not row.disagreements for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
