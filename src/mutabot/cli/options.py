"""The options that several commands share."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import wraps
from inspect import Parameter, signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypedDict, get_args, get_type_hints

import typer

from mutabot import __version__, limits
from mutabot.errors import UsageError

if TYPE_CHECKING:
    from mutabot.extensions import Part

#: the names of ``campaign.request``, which is not loaded for this, so that `--help` is fast
ENGINES = ("auto", "branch", "replay")


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"mutabot {__version__}")
        raise typer.Exit


def _families() -> list[str]:
    from mutabot.settings.families import known_families  # noqa: PLC0415  # so that `--help` is fast

    return list(known_families())


def _number(value: float | None) -> float | None:
    if value is not None and math.isnan(value):
        raise typer.BadParameter("nan is no number")
    return value


Version = Annotated[
    bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON, for a machine to read.")]
All = Annotated[bool, typer.Option("--all", help="Also list every mutant that the plan leaves out.")]
Only = Annotated[
    list[str] | None,
    typer.Option(
        "--only",
        metavar="WHICH",
        help="Only these: id, number, numbers (3,16-20), file, file:line, operator, family or role; "
        "globs too; @FILE for a list, one per line. Repeatable.",
    ),
]
Skip = Annotated[
    list[str] | None,
    typer.Option("--skip", metavar="WHICH", help="Exclude these mutants. Same syntax as --only. Repeatable."),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "-o", metavar="KEY=VALUE", help="Set a key of the configuration for this command. Repeatable."
    ),
]
Families = Annotated[
    list[str] | None,
    typer.Option(
        "--family",
        metavar="NAME",
        help="Families of mutants, as `mutabot operators` lists them. Repeatable, or with commas.",
        autocompletion=_families,
    ),
]
Sample = Annotated[
    str | None,
    typer.Option(
        "--sample",
        metavar="SIZE",
        help="Only a random sample: 10% of each family and role, or 50 of each family.",
    ),
]
Rounds = Annotated[
    int | None,
    typer.Option(
        "--rounds", metavar="N", min=1, max=limits.ROUNDS, help="Repetitions, each with its own seeds."
    ),
]
Seed = Annotated[
    int | None, typer.Option("--seed", metavar="N", min=0, max=limits.SEED, help="The campaign's seed.")
]
Jobs = Annotated[
    int | None,
    typer.Option("-j", "--jobs", metavar="N", min=1, max=limits.JOBS, help="Number of parallel runs."),
]
Engine = Annotated[
    str,
    typer.Option(
        "--engine",
        metavar="ENGINE",
        help=f"What runs the mutants: {', '.join(ENGINES)}.",
        autocompletion=lambda: list(ENGINES),
    ),
]
OneMutant = Annotated[
    str, typer.Argument(metavar="MUTANT", help="The mutant's number or id, or as much of it as is unique.")
]
Shard = Annotated[
    str | None,
    typer.Option("--shard", metavar="N/M", help="Run only part N of M; `mutabot merge` puts them together."),
]
Fresh = Annotated[
    bool, typer.Option("--fresh", help="Re-run everything, including results that are still valid.")
]
Since = Annotated[
    str | None,
    typer.Option(
        "--since",
        metavar="REF",
        help="Run only what changes since this git revision can have altered; reuse the other results.",
    ),
]
OtherJournal = Annotated[
    Path | None,
    typer.Option(
        "--journal",
        metavar="PATH",
        help="Also reuse valid outcomes from this journal, e.g. one downloaded from CI.",
    ),
]
Compared = Annotated[
    Path | None,
    typer.Option(
        "--compare",
        metavar="OLD",
        help="Tell what differs from this journal, or a project's folder with one.",
    ),
]
Budget = Annotated[
    str | None,
    typer.Option(
        "--budget",
        metavar="TIME",
        help="Stop after this much time (90s, 10m, 1h30m), baseline included; the most informative first.",
    ),
]
Verify = Annotated[
    int,
    typer.Option(
        "--verify",
        metavar="N",
        min=0,
        max=limits.VERIFIED,
        help="Re-run N random outcomes in fresh processes; exit with 4 if one ends differently.",
    ),
]
Round = Annotated[
    int | None, typer.Option("--round", metavar="N", min=1, max=limits.ROUNDS, help="Only this round.")
]
MinScore = Annotated[
    float | None,
    typer.Option(
        "--min-score",
        metavar="PERCENT",
        min=0,
        max=100,
        callback=_number,
        help="Exit with 1 if a score is under this many percent.",
    ),
]


class Setting(TypedDict, total=False):
    """The options of commands that take a baseline; commands take them as ``**given: Unpack[…]``."""

    family: Families
    rounds: Rounds
    jobs: Jobs
    settings: Settings


class Planning(Setting, total=False):
    """The same for commands that make a plan."""

    only: Only
    skip: Skip
    sample: Sample
    seed: Seed
    shard: Shard


class Running(Planning, total=False):
    """The same for commands that run a campaign."""

    engine: Engine
    fresh: Fresh
    verify: Verify
    since: Since
    journal: OtherJournal
    budget: Budget


_DEFAULTS: Mapping[str, Any] = {"engine": "auto", "fresh": False, "verify": 0}
_FIRST = ("context", "only", "skip", "family", "rounds", "jobs", "min_score", "json", "settings")
#: a parameter of this name stands for the options of all executors
_EXECUTOR = "executor"


def with_options(
    function: Callable[..., object], executors: Mapping[str, Part] | None = None
) -> Callable[..., object]:
    """A command as typer makes options of it.

    Its ``**given: Unpack[…]`` becomes the options of a class above. A parameter ``executor`` becomes an
    option for each of these executors, and takes which was chosen: its name and the option's value.
    """
    own = signature(function, eval_str=True)
    options = {f"{_EXECUTOR}_{name.replace('-', '_')}": part for name, part in (executors or {}).items()}
    if _EXECUTOR not in own.parameters:
        options = {}

    @wraps(function)
    def command(**values: Any) -> object:
        if options:
            given = {part.name: values.pop(key) for key, part in options.items()}
            values[_EXECUTOR] = _chosen({name: value for name, value in given.items() if value is not None})
        return function(**values)

    found = _parameters(own.parameters.values(), options)
    parameters = sorted((one.replace(kind=one.KEYWORD_ONLY) for one in found), key=_place)
    changed: Any = command
    changed.__signature__ = own.replace(parameters=parameters)
    changed.__annotations__ = {one.name: one.annotation for one in parameters}
    return command


def _place(one: Parameter) -> int:
    """Where it stands in ``--help``: what the first week needs comes first."""
    return _FIRST.index(one.name) if one.name in _FIRST else len(_FIRST)


def _parameters(own: Iterable[Parameter], executors: Mapping[str, Part]) -> Iterator[Parameter]:
    for one in own:
        if one.kind is one.VAR_KEYWORD:
            (options,) = get_args(one.annotation)
            for name, hint in get_type_hints(options, include_extras=True).items():
                yield Parameter(name, one.KEYWORD_ONLY, default=_DEFAULTS.get(name), annotation=hint)
        elif one.name != _EXECUTOR:
            yield one.replace(kind=one.KEYWORD_ONLY)
    for key, part in executors.items():
        option = typer.Option(f"--{part.name}", metavar=part.metavar, help=part.help)
        yield Parameter(key, Parameter.KEYWORD_ONLY, default=None, annotation=Annotated[str | None, option])


def _chosen(given: Mapping[str, str]) -> tuple[str, str] | None:
    """Raises UsageError for more than one executor."""
    if len(given) > 1:
        raise UsageError(f"{' and '.join(f'--{name}' for name in given)}: a campaign has one executor")
    return next(iter(given.items()), None)
