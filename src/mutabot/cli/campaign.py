"""Commands that run campaigns: ``operators``, ``check``, ``list``, ``run``, ``merge`` and ``replay``."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Unpack

import typer

from mutabot.campaign import beginning
from mutabot.campaign import run as running
from mutabot.campaign.plan import listed_rules
from mutabot.campaign.request import Progress, Request
from mutabot.campaign.sharding import shards
from mutabot.cli import options
from mutabot.cli.output import echo, print_json, progress_shown, show_results, tell
from mutabot.cli.request import families_of, request_again, request_of
from mutabot.config.configuration import Configuration, load_configuration
from mutabot.errors import ExitCode, UsageError
from mutabot.journal.files import HOME, JOURNAL, find_journal
from mutabot.journal.journal import JournalReader
from mutabot.report.document import replayed as replayed_data
from mutabot.report.terminal.campaign import plan_data, print_plan, print_rules
from mutabot.report.terminal.console import make_console
from mutabot.report.terminal.mutant import print_replayed
from mutabot.results.gate import Decision, decide
from mutabot.results.results import Results, find_mutant, read_results


def operators(family: options.Families = None, json: options.Json = False) -> None:
    """List the operators and the bugs they stand for."""
    rules = listed_rules(families_of(family))
    print_json({"operators": rules}) if json else print_rules(make_console(), rules)


def check(context: typer.Context, json: options.Json = False, **given: Unpack[options.Setting]) -> None:
    """Try the set-up without running mutants."""
    request = request_of(context.obj, evidence=True, **given)  # as `run`, which reuses the baseline
    with progress_shown() as progress:
        report = beginning.check(request, progress)
    print_json(report.data) if json else echo("\n".join(report.lines))


def list_(
    context: typer.Context,
    all: options.All = False,
    json: options.Json = False,
    **given: Unpack[options.Planning],
) -> None:
    """List the mutants that would run."""
    request = request_of(context.obj, evidence=True, **given)  # as `run`, which reuses the baseline
    with progress_shown() as progress:
        planned = beginning.plan_only(request, progress)
    if json:
        print_json(plan_data(*planned))
    else:
        print_plan(make_console(), *planned, everything=all)


def run(
    context: typer.Context,
    min_score: options.MinScore = None,
    json: options.Json = False,
    executor: tuple[str, str] | None = None,
    **given: Unpack[options.Running],
) -> None:
    """Run the campaign, or continue it."""
    request = request_of(context.obj, executor=executor, evidence=True, **given)
    show_end(request, partial(running.run_campaign, request), min_score, json=json)


def show_end(
    request: Request, campaign: Callable[[Progress], Path], min_score: float | None, *, json: bool
) -> None:
    """Run a campaign, print its summary, and exit as the limits decide. Raises typer.Exit."""
    with progress_shown() as progress:
        path = campaign(progress)
    results = show_results(path, json=json, summary=True)
    _exit_as(_decided(request.configuration, results, min_score))


def _decided(configuration: Configuration, results: Results, min_score: float | None) -> Decision:
    """Compare results with the limits; ``min_score``, in percent, replaces the configured one."""
    limit = min_score if min_score is not None else configuration.min_score
    return decide(
        results,
        min_score=None if limit is None else limit / 100,
        max_timeouts=configuration.timeout_limit,
        max_unstable=configuration.unstable_limit,
        max_errors=configuration.error_limit,
        demands=configuration.demands,
    )


def _exit_as(decision: Decision) -> None:
    tell(decision.lines)
    raise typer.Exit(decision.exit_code)


_Journals = Annotated[
    list[Path], typer.Argument(metavar="JOURNAL", help="Journals of the shards, or folders that hold one.")
]
_Output = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="FILE", help="Merged journal; the project's journal by default."),
]


def merge(
    context: typer.Context,
    journals: _Journals,
    output: _Output = None,
    min_score: options.MinScore = None,
    json: options.Json = False,
) -> None:
    """Merge the journals of shards.

    Judges the campaign as `run` does. Exits with 4 if a part is missing; the others are written all the same.
    """
    configuration = load_configuration(context.obj)
    target = output or configuration.root / HOME / JOURNAL
    missing = shards.merge(journals, target, root=configuration.root, room=configuration.evidence)
    results = show_results(target, json=json, summary=True)
    lacking = Decision(ExitCode.UNRELIABLE, tuple(missing)) if missing else None
    _exit_as(lacking or _decided(configuration, results, min_score))


def replay(
    context: typer.Context,
    mutant: options.OneMutant,
    round: options.Round = None,
    jobs: options.Jobs = None,
    json: options.Json = False,
) -> None:
    """Re-run one mutant in fresh processes.

    Exits with 4 if an outcome differs from the one in the journal.
    """
    path = find_journal(context.obj)
    with JournalReader.open(path) as journal:
        found = read_results(journal, earlier=True)
        chosen = find_mutant(found, mutant).mutant
        rounds = range(found.rounds) if round is None else [number_of(round, found.rounds)]
        request = request_again(path.parent.parent, found, jobs)
        with progress_shown() as progress:
            replayed = running.replay_one(request, journal, chosen, rounds, progress)
    data = replayed_data(chosen, replayed)
    print_json(data) if json else print_replayed(make_console(), chosen, replayed)
    differs = any(one.agrees is False for one in replayed)
    raise typer.Exit(ExitCode.UNRELIABLE if differs else ExitCode.FINE)


def number_of(round: int, rounds: int) -> int:
    """Return the 0-based number of a round. Raises UsageError if the campaign has fewer rounds."""
    if round > rounds:
        raise UsageError(f"there is no round {round}; the campaign has {rounds}")
    return round - 1
