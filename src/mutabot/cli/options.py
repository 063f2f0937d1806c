"""The options that several commands share."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import wraps
from inspect import Parameter, signature
from pathlib import Path
from typing import Annotated, Any, TypedDict, get_args, get_type_hints

import typer
from typer import Option

from mutabot import __version__
from mutabot.config.options import JOBS, ROUNDS, SEED, VERIFIED
from mutabot.errors import UsageError
from mutabot.extensions import ExtensionPart, brought

#: the names of ``campaign.request``, which is not loaded for this, so that `--help` is fast
ENGINES = ("auto", "fork", "replay")


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"mutabot {__version__}")
        raise typer.Exit


def _number(value: float | None) -> float | None:
    if value is not None and math.isnan(value):
        raise typer.BadParameter("nan is no number")
    return value


Version = Annotated[
    bool, Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
]
Json = Annotated[bool, Option("--json", help="Print JSON.")]
All = Annotated[bool, Option("--all", help="Also list every skipped mutant.")]
EveryRound = Annotated[bool, Option("--all", help="Show every round.")]
_ONLY = (
    "Only these mutants: id, number, numbers (3,16-20), file, file:line, operator, family or role; globs "
    "too; @FILE for a list, one per line. Repeatable."
)
_SKIP = "Exclude these mutants. Same syntax as --only. Repeatable."
_SETTING = "Set a key of the configuration for this command. Repeatable."
_FAMILY = "Families of mutants, see `mutabot operators`. Repeatable, or with commas."
_SAMPLE = "Only a random sample: 10% of each family and role, or 50 of each family."
_SINCE = "Run only what changes since this git revision can have altered; reuse the other results."
_JOURNAL = "Also reuse valid outcomes from this journal, e.g. one downloaded from CI."
_BUDGET = "Stop after this much time (90s, 10m), baseline included; run the most informative mutants first."
_VERIFY = "Re-run N random outcomes in fresh processes; exit with 4 if one ends differently."
_MIN_SCORE = "Exit with 1 if a score is below this percentage."
_ENGINE = f"How mutants are run: {', '.join(ENGINES)}."
Only = Annotated[list[str] | None, Option("--only", metavar="WHICH", help=_ONLY)]
Skip = Annotated[list[str] | None, Option("--skip", metavar="WHICH", help=_SKIP)]
Settings = Annotated[list[str] | None, Option("-o", metavar="KEY=VALUE", help=_SETTING)]
Families = Annotated[list[str] | None, Option("--family", metavar="NAME", help=_FAMILY)]
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
Verify = Annotated[int | None, Option("--verify", metavar="N", min=0, max=VERIFIED, help=_VERIFY)]
Round = Annotated[int | None, Option("--round", metavar="N", min=1, max=ROUNDS, help="Only this round.")]
MinScore = Annotated[
    float | None,
    Option("--min-score", metavar="PERCENT", min=0, max=100, callback=_number, help=_MIN_SCORE),
]


class Setting(TypedDict, total=False):
    """Options of commands that take a baseline; commands take them as ``**given: Unpack[…]``."""

    family: Families
    rounds: Rounds
    jobs: Jobs
    settings: Settings


class Planning(Setting, total=False):
    """Options of commands that make a plan."""

    only: Only
    skip: Skip
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


_DEFAULTS: Mapping[str, Any] = {"engine": "auto", "fresh": False}
#: parameters that stand for the options of all parts of a kind; and what is said when two are chosen
_OF_PARTS = {
    "executor": ("executors", "a campaign has one executor"),
    "template": ("templates", "a project starts from one template"),
}


def with_options(function: Callable[..., object]) -> Callable[..., object]:
    """Make a command of which typer can read the options.

    Its ``**given: Unpack[…]`` becomes the options of a class above. A parameter ``executor`` becomes an
    option for each executor, and takes which was chosen: its name and the option's value. So does a parameter
    ``template``: it takes the name, and the files that the template makes of the value.
    """
    own = signature(function, eval_str=True)
    kind = next((name for name in _OF_PARTS if name in own.parameters), "")
    found = brought(_OF_PARTS[kind][0], Running.__annotations__) if kind else {}
    names = {f"{kind}_{name.replace('-', '_')}": part for name, part in found.items()}

    @wraps(function)
    def command(**values: Any) -> object:
        chosen = [(part, value) for key, part in names.items() if (value := values.pop(key)) is not None]
        if len(chosen) > 1:
            raise UsageError(f"{' and '.join(f'--{part.name}' for part, _ in chosen)}: {_OF_PARTS[kind][1]}")
        for part, value in chosen:
            values[kind] = part.name, part.load_function()(value) if kind == "template" else value
        return function(**values)

    parameters = list(_parameters(own.parameters.values(), names))
    changed: Any = command
    changed.__signature__ = own.replace(parameters=parameters)
    changed.__annotations__ = {one.name: one.annotation for one in parameters}
    return command


def _parameters(own: Iterable[Parameter], parts: Mapping[str, ExtensionPart]) -> Iterator[Parameter]:
    for one in own:
        if one.kind is one.VAR_KEYWORD:
            (options,) = get_args(one.annotation)
            for name, hint in get_type_hints(options, include_extras=True).items():
                yield Parameter(name, one.KEYWORD_ONLY, default=_DEFAULTS.get(name), annotation=hint)
        elif one.name not in _OF_PARTS:
            yield one.replace(kind=one.KEYWORD_ONLY)
    for key, part in parts.items():
        option = Option(f"--{part.name}", metavar=part.metavar, help=part.help)
        yield Parameter(key, Parameter.KEYWORD_ONLY, default=None, annotation=Annotated[str | None, option])
