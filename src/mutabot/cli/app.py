"""The command line. Exceptions become exit codes in ``main`` and nowhere else.

What a command needs is imported inside it, so that ``--help`` is fast.
"""

# The imports inside commands are meant, see above; typer makes options of parameters.
# ruff: noqa: PLC0415, PLR0917

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mutabot.errors import MutabotError, UsageError, unknown_name_text

from .options import (
    ENGINES,
    FAMILIES,
    All,
    BaselineRuns,
    Confirm,
    Engine,
    Families,
    Fresh,
    Jobs,
    Json,
    MinScore,
    NoOracle,
    OneMutant,
    OnePerSite,
    Only,
    Order,
    Pairs,
    Picture,
    Repeats,
    Round,
    Rounds,
    Sample,
    Seed,
    Selection,
    Skip,
    Stored,
    Table,
    Verify,
    Version,
)

if TYPE_CHECKING:
    from mutabot.analysis.families import Comparison
    from mutabot.campaign.request import Request
    from mutabot.report.terminal.progress import Bar, Lines

UNSTABLE, INTERNAL_ERROR, INTERRUPTED = 4, 70, 130
_SETUP, _LOOK, _RUN = "Set up", "Look at results", "Run"

app = typer.Typer(
    name="mutabot",
    help="Mutation testing for robot programs: would your tests notice?",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


@app.callback()
def options(
    context: typer.Context,
    project: Annotated[Path, typer.Option("-C", "--project", metavar="FOLDER", help="The project.")] = Path(),
    version: Version = False,
) -> None:
    """Mutation testing for robot programs: would your tests notice?"""
    context.obj = project


@app.command(rich_help_panel=_SETUP)
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
        _echo(line)


@app.command(rich_help_panel=_SETUP)
def check(
    context: typer.Context,
    json: Json = False,
    jobs: Jobs = None,
    rounds: Rounds = None,
    family: Families = None,
) -> None:
    """Try the whole set-up without running mutants."""
    from mutabot.campaign import run as campaign

    request = _request(context.obj, jobs=jobs, rounds=rounds, family=family)
    with _progress() as progress:
        report = campaign.check(request, progress)
    _print_json(report.data) if json else _echo("\n".join(report.lines))


@app.command("list", rich_help_panel=_SETUP)
def list_(
    context: typer.Context,
    only: Only = None,
    skip: Skip = None,
    family: Families = None,
    order: Order = None,
    pairs: Pairs = None,
    selection: Selection = None,
    sample: Sample = None,
    one_per_site: OnePerSite = False,
    rounds: Rounds = None,
    seed: Seed = None,
    jobs: Jobs = None,
    all: All = False,
    json: Json = False,
) -> None:
    """List the mutants that would run, and what is left out."""
    from mutabot.campaign.run import plan_only
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.listing import plan_data, print_plan

    request = _request(
        context.obj, only=only, skip=skip, family=family, order=order, pairs=pairs, selection=selection,
        sample=sample, one_per_site=one_per_site, rounds=rounds, seed=seed, jobs=jobs,
    )  # fmt: skip
    with _progress() as progress:
        mutants, left_out = plan_only(request, progress)
    if json:
        _print_json(plan_data(mutants, left_out))
    else:
        print_plan(make_console(), mutants, left_out, everything=all)


@app.command(rich_help_panel=_RUN)
def run(
    context: typer.Context,
    only: Only = None,
    skip: Skip = None,
    family: Families = None,
    order: Order = None,
    pairs: Pairs = None,
    selection: Selection = None,
    sample: Sample = None,
    one_per_site: OnePerSite = False,
    rounds: Rounds = None,
    seed: Seed = None,
    jobs: Jobs = None,
    engine: Engine = "auto",
    fresh: Fresh = False,
    verify: Verify = 0,
    confirm: Confirm = False,
    repeats: Repeats = True,
    baseline: BaselineRuns = None,
    min_score: MinScore = None,
    table: Table = False,
    json: Json = False,
) -> None:
    """Run the campaign, or go on with it: baseline, controls, mutants, scores."""
    from mutabot.analysis.gate import decide
    from mutabot.campaign.run import run_campaign

    request = _request(
        context.obj, only=only, skip=skip, family=family, order=order, pairs=pairs, selection=selection,
        sample=sample, one_per_site=one_per_site, rounds=rounds, seed=seed, jobs=jobs, engine=engine,
        fresh=fresh, verify=verify, confirm=confirm, repeats=repeats, baseline=baseline,
    )  # fmt: skip
    with _progress() as progress:
        journal_path = run_campaign(request, progress)
    results = _show_results(journal_path, json=json, summary=not table)
    limit = min_score if min_score is not None else request.configuration.min_score
    decision = decide(
        results,
        min_score=None if limit is None else limit / 100,
        max_timeouts=request.configuration.timeout_limit,
        max_unstable=request.configuration.unstable_limit,
        max_errors=request.configuration.error_limit,
    )
    for line in decision.lines:
        typer.echo(line, err=True)
    raise typer.Exit(decision.exit_code)


@app.command(rich_help_panel=_RUN)
def compare(
    context: typer.Context,
    family: Families = None,
    only: Only = None,
    skip: Skip = None,
    selection: Selection = None,
    sample: Sample = None,
    one_per_site: OnePerSite = False,
    rounds: Rounds = None,
    seed: Seed = None,
    jobs: Jobs = None,
    engine: Engine = "auto",
    fresh: Fresh = False,
    no_oracle: NoOracle = False,
    picture: Picture = None,
    stored: Stored = False,
    json: Json = False,
) -> None:
    """Compare families of operators: cost, ends, scores, and what their mutants can tell.

    Mutants run against every test that reaches them, into a journal of their own.
    """
    from mutabot.analysis.gate import decide
    from mutabot.campaign.request import COMPARISON
    from mutabot.cli import compare as cli_compare
    from mutabot.report.picture_file import check_picture

    if picture is not None:
        check_picture(picture)
    if stored:
        found = cli_compare.read(_journal_path(context.obj, COMPARISON).parent)
    else:
        request = _request(
            context.obj, only=only, skip=skip, family=family or FAMILIES, order=1, selection=selection,
            sample=sample, one_per_site=one_per_site, rounds=rounds, seed=seed, jobs=jobs, engine=engine,
            fresh=fresh, configured_selection=False,
        )  # fmt: skip
        with _progress() as progress:
            found = cli_compare.run(request, progress, no_oracle=no_oracle)
    _show_comparison(found, picture, json=json)
    decision = decide(found.results)
    for line in decision.lines:
        typer.echo(line, err=True)
    raise typer.Exit(decision.exit_code)


@app.command(rich_help_panel=_RUN)
def replay(
    context: typer.Context,
    mutant: OneMutant,
    round: Round = None,
    jobs: Jobs = None,
    json: Json = False,
) -> None:
    """Run one mutant of the last campaign again in fresh processes; exit with 4 if it ends otherwise."""
    from mutabot.analysis.results import find_mutant, read_results
    from mutabot.campaign.engines.second_look import replay_one
    from mutabot.journal.reader import JournalReader
    from mutabot.report.as_json import replayed_data
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.detail import print_replayed

    path = _journal_path(context.obj)
    with JournalReader.open(path) as journal:
        found = read_results(journal, earlier=True)
        chosen = find_mutant(found, mutant).mutant
        if round is not None and round > found.rounds:
            raise UsageError(f"there is no round {round}; the campaign has {found.rounds}")
        rounds = range(found.rounds) if round is None else [round - 1]
        request = _request(
            path.parent.parent, rounds=found.rounds, seed=found.meta.get("seed"), jobs=jobs,
            family=found.meta.get("families"), order=found.meta.get("order"),
            every_test=found.meta.get("every_test"), no_oracle=found.meta.get("no_oracle"),
        )  # fmt: skip
        with _progress() as progress:
            replayed = replay_one(request, journal, chosen, rounds, progress)
    if json:
        _print_json(replayed_data(chosen, replayed))
    else:
        print_replayed(make_console(), chosen, replayed)
    raise typer.Exit(UNSTABLE if any(one.agrees is False for one in replayed) else 0)


@app.command(rich_help_panel=_LOOK)
def results(context: typer.Context, all: All = False, json: Json = False) -> None:
    """Show the results of the last campaign, also of one that was interrupted or still runs."""
    _show_results(_journal_path(context.obj), json=json, everything=all, earlier=True)


@app.command(rich_help_panel=_LOOK)
def show(
    context: typer.Context,
    mutant: OneMutant,
    json: Json = False,
) -> None:
    """Show everything about one mutant."""
    from mutabot.analysis.results import find_mutant, read_results
    from mutabot.journal.reader import JournalReader
    from mutabot.report.as_json import result_data
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.detail import print_mutant

    with JournalReader.open(_journal_path(context.obj)) as journal:
        found = read_results(journal, earlier=True)
        result = find_mutant(found, mutant)
        is_there = not result.outdated or result.mutant.family in found.meta.get("families", ())
        source = journal.source(result.mutant.site.span.file) if is_there else None
    if json:
        _print_json(result_data(result))
    else:
        print_mutant(make_console(), result, source)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code of the process."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a terminal that cannot show a sign gets "?", not an error
            stream.reconfigure(errors="replace")
    arguments = sys.argv[1:] if arguments is None else arguments
    try:
        code = app(list(arguments), prog_name="mutabot", standalone_mode=False)
    except (KeyboardInterrupt, typer.Abort):
        code = INTERRUPTED
    except MutabotError as error:
        typer.echo(f"mutabot: {error}", err=True)
        return error.exit_code
    except Exception as error:
        return _usage_or_crash(error)
    if code == INTERRUPTED:  # also typer itself turns Ctrl-C into this code
        command = "compare --results" if "compare" in arguments else "results"
        typer.echo(f"interrupted; `mutabot {command}` shows what is there", err=True)
    return code if isinstance(code, int) else 0


def _usage_or_crash(error: Exception) -> int:
    show = getattr(error, "show", None)
    if callable(show) and hasattr(error, "exit_code"):  # the parser's own errors, for a wrong command line
        show()
        return UsageError.exit_code
    text = "".join(traceback.format_exception(error))
    file = Path(".mutabot", "crash.txt")
    try:
        file.parent.mkdir(exist_ok=True)
        file.write_text(text, encoding="utf-8")
    except OSError:
        typer.echo(text, err=True)
        file = Path("the lines above")
    typer.echo(f"mutabot: internal error ({type(error).__name__}: {error}); details are in {file}", err=True)
    return INTERNAL_ERROR


def _request(
    project: Path,
    *,
    selection: Path | None = None,
    sample: str | None = None,
    engine: str = "auto",
    configured_selection: bool = True,
    **given: Any,
) -> Request:
    from mutabot.campaign.request import Request
    from mutabot.settings.configuration import load_configuration
    from mutabot.settings.sample import Sample
    from mutabot.vocabulary import load

    if engine not in ENGINES:
        raise UsageError(unknown_name_text("engine", engine, ENGINES))
    size = Sample.parse(sample) if sample is not None else None
    configuration = load_configuration(project)
    if selection is None and configuration.selection is not None and configured_selection:
        selection = configuration.root / configuration.selection
    elif selection is not None:
        selection = _found(selection, configuration.root)
    return Request(
        configuration=configuration,
        vocabulary=load(configuration.vocabulary, configuration.root),
        rounds=given.get("rounds") or configuration.rounds,
        seed=configuration.seed if given.get("seed") is None else given["seed"],
        jobs=given.get("jobs") or configuration.jobs or len(os.sched_getaffinity(0)),
        only=tuple(given.get("only") or ()),
        skip=tuple(given.get("skip") or ()),
        selection=selection,
        engine=engine,
        fresh=bool(given.get("fresh")),
        verify=given.get("verify") or 0,
        confirm=bool(given.get("confirm")),
        repeats=given.get("repeats", True),
        baseline=given.get("baseline") or configuration.baseline_repetitions,
        families=_families(given.get("family")) or configuration.families,
        sample=size,
        one_per_site=bool(given.get("one_per_site")),
        order=given.get("order") or configuration.order,
        pairs=given.get("pairs") or configuration.pairs,
        every_test=bool(given.get("every_test")),
        no_oracle=bool(given.get("no_oracle")),
    )


def _families(given: Sequence[str] | None) -> tuple[str, ...]:
    """The families of the command line, in the order of their numbers."""
    named = [name.strip() for text in given or () for name in text.split(",") if name.strip()]
    for name in named:
        if name not in FAMILIES:
            raise UsageError(unknown_name_text("family", name, FAMILIES))
    return tuple(family for family in FAMILIES if family in named)


def _found(selection: Path, root: Path) -> Path:
    """The selection file, looked for here and in the project; said now rather than after the baseline."""
    for place in (selection, root / selection):
        if place.is_file():
            return place
    raise UsageError(f"there is no selection file {selection}, neither here nor in {root}")


def _journal_path(project: Path, name: str | None = None) -> Path:
    """A journal of the project, that of ``run`` if None, also from a folder inside it."""
    from mutabot.campaign.request import HOME, JOURNAL

    folders = (project.resolve(), *project.resolve().parents)
    paths = [folder / HOME / (name or JOURNAL) for folder in folders]
    return next((path for path in paths if path.is_file()), paths[0])


def _show_results(
    path: Path, *, json: bool, everything: bool = False, earlier: bool = False, summary: bool = False
) -> Any:
    from mutabot.analysis.results import read_results
    from mutabot.journal.reader import JournalReader
    from mutabot.report.as_json import results_data
    from mutabot.report.terminal.campaign import print_results
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.summary import print_summary

    with JournalReader.open(path) as journal:
        found = read_results(journal, earlier=earlier)
    if json:
        _print_json(results_data(found))
    elif summary:
        print_summary(make_console(), found)
    else:
        print_results(make_console(), found, everything=everything)
    return found


def _show_comparison(comparison: Comparison, picture: Path | None, *, json: bool) -> None:
    from mutabot.report.comparison_json import comparison_data
    from mutabot.report.picture_file import write_picture
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.side_by_side import print_comparison

    if json:
        _print_json(comparison_data(comparison))
    else:
        print_comparison(make_console(), comparison)
    if picture is not None:
        write_picture(comparison, picture)


def _print_json(data: Any) -> None:
    from mutabot.report.as_json import dumps

    _echo(dumps(data))


def _echo(text: str) -> None:
    """Print, also where the reader leaves early: then the exit code still tells how it ended."""
    from mutabot.report.terminal.console import leave_pipe

    try:
        typer.echo(text)
    except BrokenPipeError:
        leave_pipe()


def _progress() -> Bar | Lines:
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.progress import make_progress

    return make_progress(make_console(stderr=True))


if __name__ == "__main__":
    sys.exit(main())
