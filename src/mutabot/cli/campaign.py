"""``mutabot init``, ``operators``, ``check``, ``list``, ``run`` and ``merge``: campaigns and their set-up."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Unpack

import typer

from mutabot.cli import options
from mutabot.cli.output import decided, echo, exit_as, print_json, progress_shown, show_results
from mutabot.cli.request import families_of, request_of
from mutabot.errors import ExitCode
from mutabot.journal.files import HOME, JOURNAL

if TYPE_CHECKING:
    from mutabot.campaign.request import Progress, Request
    from mutabot.config.configuration import Configuration
    from mutabot.results.gate import Decision
    from mutabot.results.results import Results


def init(
    context: typer.Context,
    program: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[PROGRAM]...", help="Files or folders of the robot program."),
    ] = None,
) -> None:
    """Run the tests once, look at what the program calls, and propose a configuration and a vocabulary."""
    from mutabot.proposal import propose

    for line in propose(context.obj, program or [], tell=lambda text: typer.echo(text, err=True)):
        echo(line)


def operators(family: options.Families = None, json: options.Json = False) -> None:
    """List the operators: what each plants, where it applies, and which bugs it stands for."""
    from mutabot.campaign.plan import listed_rules
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.listing import print_rules

    rules = [asdict(rule) for rule in listed_rules(families_of(family))]
    print_json({"operators": rules}) if json else print_rules(make_console(), rules)


def check(context: typer.Context, json: options.Json = False, **given: Unpack[options.Setting]) -> None:
    """Try the whole set-up without running mutants."""
    from mutabot.campaign import check as campaign

    request = request_of(context.obj, **given)
    with progress_shown() as progress:
        report = campaign.check(request, progress)
    print_json(report.data) if json else echo("\n".join(report.lines))


def list_(
    context: typer.Context,
    all: options.All = False,
    json: options.Json = False,
    **given: Unpack[options.Planning],
) -> None:
    """List the mutants that would run, and what is left out."""
    from mutabot.campaign.run import plan_only
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.listing import plan_data, print_plan

    request = request_of(context.obj, **given)
    with progress_shown() as progress:
        mutants, left_out = plan_only(request, progress)
    if json:
        print_json(plan_data(mutants, left_out))
    else:
        print_plan(make_console(), mutants, left_out, everything=all)


def run(
    context: typer.Context,
    min_score: options.MinScore = None,
    json: options.Json = False,
    executor: tuple[str, str] | None = None,
    **given: Unpack[options.Running],
) -> None:
    """Run the campaign, or go on with it: baseline, controls, mutants, scores."""
    from mutabot.campaign.run import run_campaign

    request = request_of(context.obj, executor=executor, evidence=True, **given)
    show_end(request, partial(run_campaign, request), min_score, json=json)


def show_end(
    request: Request, campaign: Callable[[Progress], Path], min_score: float | None, *, json: bool
) -> None:
    """Run a campaign, print how it ended, and exit as the limits decide. Raises typer.Exit."""
    with progress_shown() as progress:
        path = campaign(progress)
    results = show_results(path, json=json, summary=True)
    exit_as(decided(request.configuration, results, min_score))


_Journals = Annotated[
    list[Path], typer.Argument(metavar="JOURNAL", help="The shards' journals, or folders that hold one.")
]
_Output = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="FILE", help="Where to write; else the project's journal."),
]


def merge(
    context: typer.Context,
    journals: _Journals,
    output: _Output = None,
    min_score: options.MinScore = None,
    json: options.Json = False,
) -> None:
    """Put the journals of shards together, and judge the campaign as `run` does.

    Exit code 4 if something is missing; what is there is written all the same.
    """
    from mutabot.campaign.sharding.merge import merge as put_together
    from mutabot.config.configuration import load_configuration

    configuration = load_configuration(context.obj)
    target = output or configuration.root / HOME / JOURNAL
    missing = put_together(journals, target, root=configuration.root, room=configuration.evidence)
    results = show_results(target, json=json, summary=True)
    exit_as(_decision(configuration, results, min_score, missing))


def _decision(
    configuration: Configuration, results: Results, min_score: float | None, missing: list[str]
) -> Decision:
    from mutabot.results.gate import Decision

    if missing:
        return Decision(ExitCode.UNRELIABLE, tuple(missing))
    return decided(configuration, results, min_score)
