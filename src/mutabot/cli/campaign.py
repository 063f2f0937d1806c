"""Commands that run campaigns: ``operators``, ``check``, ``list``, ``run``, ``merge`` and ``replay``."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from mutabot.campaign import checking
from mutabot.campaign.partial_runs import replay_one
from mutabot.campaign.plan import listed_rules
from mutabot.campaign.request import Request
from mutabot.campaign.run import run_campaign
from mutabot.campaign.sharding import shards
from mutabot.cli import options
from mutabot.cli.context import CommandContext, decided
from mutabot.cli.request import families_of
from mutabot.config.configuration import load_configuration
from mutabot.errors import ExitCode, UsageError
from mutabot.journal.files import HOME, JOURNAL
from mutabot.journal.reader import JournalReader
from mutabot.report.document import replayed as replayed_data
from mutabot.report.terminal.campaign import plan_data, print_plan, print_rules
from mutabot.report.terminal.console import make_console
from mutabot.report.terminal.mutant import print_replayed
from mutabot.results.gate import Decision
from mutabot.results.results import read_results


def operators(context: CommandContext, family: options.Families = None, json: bool = False) -> None:
    """List the operators and the bugs they stand for."""
    rules = listed_rules(families_of(family))
    context.print_json({"operators": rules}) if json else print_rules(make_console(), rules)


def check(context: CommandContext, request: Annotated[Request, options.Setting], json: bool = False) -> None:
    """Try the set-up: tests, sites, and the two control mutants."""
    with context.progress() as progress:
        report = checking.check(request, progress)
    context.print_json(report.data) if json else context.print("\n".join(report.lines))


def list_(
    context: CommandContext,
    request: Annotated[Request, options.Planning],
    all: options.All = False,
    json: bool = False,
) -> None:
    """List the mutants that would run."""
    with context.progress() as progress:
        planned = checking.plan_only(request, progress)
    if json:
        data = plan_data(planned.mutants, planned.left_out, planned.untested)
        context.print_json({**data, "runs": planned.duration.runs, "seconds": planned.duration.seconds})
    else:
        print_plan(make_console(), planned.mutants, planned.left_out, planned.untested, everything=all)
        context.print(f"\n`mutabot run` takes {planned.duration.text}; less where results are reused.")


def run(
    context: CommandContext,
    request: Request,
    min_score: float | None = None,
    fail_on: list[str] | None = None,
    stream: str = "",
    json: bool = False,
) -> None:
    """Run the campaign, or continue it."""
    if stream and json:
        raise UsageError(f"--format {stream} and --json: only one of them can be printed")
    context.run_to_end(
        request, partial(run_campaign, request), min_score, json=json, stream=stream, fail_on=fail_on or ()
    )


_Journals = Annotated[
    list[Path], typer.Argument(metavar="JOURNAL", help="Journals of the shards, or folders that hold one.")
]
_Output = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="FILE", help="Merged journal; the project's journal by default."),
]


def merge(
    context: CommandContext,
    journals: _Journals,
    output: _Output = None,
    min_score: float | None = None,
    fail_on: list[str] | None = None,
    json: bool = False,
) -> None:
    """Merge the journals of shards.

    Judges the campaign as `run` does. Exits with 4 if a part is missing; the others are written all the same.
    """
    configuration = load_configuration(context.project)
    target = output or configuration.root / HOME / JOURNAL
    missing = shards.merge(journals, target, root=configuration.root, room=configuration.evidence)
    results = context.show_results(target, json=json, summary=True)
    lacking = Decision(ExitCode.UNRELIABLE, tuple(missing)) if missing else None
    context.exit_as(lacking or decided(configuration, results, min_score, fail_on or ()))


def replay(
    context: CommandContext,
    mutant: str,
    round: int | None = None,
    jobs: int | None = None,
    json: bool = False,
) -> None:
    """Re-run one mutant in fresh processes.

    Exits with 4 if an outcome differs from the one in the journal.
    """
    with JournalReader.open(context.journal) as journal:
        found = read_results(journal, earlier=True)
        chosen = found.mutant(mutant).mutant
        rounds = range(found.rounds) if round is None else [found.round_index(round)]
        request = context.request_again(found, jobs)
        with context.progress() as progress:
            replayed = replay_one(request, journal, chosen, rounds, progress)
    data = replayed_data(chosen, replayed)
    context.print_json(data) if json else print_replayed(make_console(), chosen, replayed)
    differs = any(end.agrees is False for end in replayed)
    raise typer.Exit(ExitCode.UNRELIABLE if differs else ExitCode.FINE)
