"""The options that several commands share."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, TypedDict

import typer
from typer import Option

from mutabot import __version__
from mutabot.config.options import AUTO, ENGINES, FAIL_ON, JOBS, MOST_VERIFIED, ROUNDS, SEED


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"mutabot {__version__}")
        raise typer.Exit


def _number(value: float | None) -> float | None:
    if value is not None and math.isnan(value):
        raise typer.BadParameter("nan is not a number")
    return value


Version = Annotated[
    bool, Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
]
Json = Annotated[bool, Option("--json", help="Print JSON.")]
All = Annotated[bool, Option("--all", help="Also list every skipped mutant.")]
EveryRound = Annotated[bool, Option("--all", help="Show all rounds and checks, and whole messages.")]
_ONLY = (
    "Only these mutants: id, number, numbers (3,16-20), file, file:line, operator, family or role; * "
    "and ? are wildcards; @FILE for a list, one per line. Repeatable."
)
_SKIP = "Exclude these mutants. Same syntax as --only. Repeatable."
_SETTING = "Set a key of the configuration for this command. Repeatable."
_FAMILY = "Families of mutants, see `mutabot operators`. Repeatable, or with commas."
_OPERATORS = (
    "all, or common: only mutants of operators whose faults are frequent among real bugs, and of which few "
    "are useless."
)
_SAMPLE = "Only a random sample: 10% of each family and role, or 50 of each family."
_SINCE = "Run only mutants that may be affected by changes since this git revision; reuse the other results."
_JOURNAL = "Also reuse valid outcomes from this journal, e.g. one downloaded from CI."
_BUDGET = "Stop after this much time (90s, 10m), baseline included; run the most informative mutants first."
_VERIFY = "Re-run N random outcomes in fresh processes; exit with 4 if one ends differently."
_MIN_SCORE = "Exit with 1 if a score is below this percentage."
_ENGINE = f"How mutants are run: {', '.join((AUTO, *ENGINES))}."
Only = Annotated[list[str] | None, Option("--only", metavar="WHICH", help=_ONLY)]
Skip = Annotated[list[str] | None, Option("--skip", metavar="WHICH", help=_SKIP)]
Settings = Annotated[list[str] | None, Option("-o", metavar="KEY=VALUE", help=_SETTING)]
Families = Annotated[list[str] | None, Option("--family", metavar="NAME", help=_FAMILY)]
Operators = Annotated[str, Option("--operators", metavar="WHICH", help=_OPERATORS)]
Sample = Annotated[str | None, Option("--sample", metavar="SIZE", help=_SAMPLE)]
Rounds = Annotated[
    int | None, Option("--rounds", metavar="N", min=1, max=ROUNDS, help="Rounds, each with new seeds.")
]
Seed = Annotated[int | None, Option("--seed", metavar="N", min=0, max=SEED, help="The campaign's seed.")]
Jobs = Annotated[
    int | None, Option("-j", "--jobs", metavar="N", min=1, max=JOBS, help="Number of parallel runs.")
]
Engine = Annotated[str, Option("--engine", metavar="ENGINE", help=_ENGINE)]
OneMutant = Annotated[str, typer.Argument(metavar="MUTANT", help="Number, id, or a unique part of the id.")]
Shard = Annotated[
    str | None, Option("--shard", metavar="N/M", help="Run only part N of M; see `mutabot merge`.")
]
Fresh = Annotated[bool, Option("--fresh", help="Re-run everything, including results that are still valid.")]
Since = Annotated[str | None, Option("--since", metavar="REF", help=_SINCE)]
OtherJournal = Annotated[Path | None, Option("--journal", metavar="PATH", help=_JOURNAL)]
Budget = Annotated[str | None, Option("--budget", metavar="TIME", help=_BUDGET)]
Verify = Annotated[int | None, Option("--verify", metavar="N", min=0, max=MOST_VERIFIED, help=_VERIFY)]
Round = Annotated[int | None, Option("--round", metavar="N", min=1, max=ROUNDS, help="Only this round.")]
MinScore = Annotated[
    float | None,
    Option("--min-score", metavar="PERCENT", min=0, max=100, callback=_number, help=_MIN_SCORE),
]
_FAIL_ON = f"Exit with 1 if there is any: {', '.join(FAIL_ON)}. Repeatable."


def _known_names(values: list[str] | None) -> list[str] | None:
    for value in values or ():
        if value not in FAIL_ON:
            raise typer.BadParameter(f"{value!r} is not one of {', '.join(FAIL_ON)}")
    return values


FailOn = Annotated[
    list[str] | None, Option("--fail-on", metavar="WHAT", callback=_known_names, help=_FAIL_ON)
]
_STREAM = "Print a line per mutant as soon as it is judged, and no summary: lines or jsonl."
Stream = Annotated[str, Option("--format", metavar="FORMAT", help=_STREAM)]


class Setting(TypedDict, total=False):
    """Options of commands that take a baseline."""

    family: Families
    rounds: Rounds
    jobs: Jobs
    settings: Settings


class Planning(Setting, total=False):
    """Options of commands that make a plan."""

    only: Only
    skip: Skip
    operators: Operators
    sample: Sample
    seed: Seed
    shard: Shard


class Running(Planning, total=False):
    """Options of commands that run a campaign."""

    engine: Engine
    fresh: Fresh
    verify: Verify
    since: Since
    journal: OtherJournal
    budget: Budget


class Shared(TypedDict, total=False):
    """Options that several commands take by the name of a parameter."""

    only: Only
    skip: Skip
    jobs: Jobs
    json: Json
    round: Round
    mutant: OneMutant
    min_score: MinScore
    fail_on: FailOn
    stream: Stream
