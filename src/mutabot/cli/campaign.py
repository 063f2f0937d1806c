"""``mutabot check``, ``list`` and ``run``: a campaign, or what comes before its mutants."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415, PLR0917

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from . import options
from .output import decided, echo, exit_as, print_json, progress_shown, show_results, tell
from .request import request_of

if TYPE_CHECKING:
    from mutabot.campaign.request import Progress, Request
    from mutabot_live.live import Live


def check(
    context: typer.Context,
    json: options.Json = False,
    jobs: options.Jobs = None,
    rounds: options.Rounds = None,
    family: options.Families = None,
    settings: options.Settings = None,
) -> None:
    """Try the whole set-up without running mutants."""
    from mutabot.campaign import check as campaign

    request = request_of(context.obj, jobs=jobs, rounds=rounds, family=family, settings=settings)
    with progress_shown() as progress:
        report = campaign.check(request, progress)
    print_json(report.data) if json else echo("\n".join(report.lines))


def list_(
    context: typer.Context,
    only: options.Only = None,
    skip: options.Skip = None,
    family: options.Families = None,
    sample: options.Sample = None,
    rounds: options.Rounds = None,
    seed: options.Seed = None,
    shard: options.Part = None,
    jobs: options.Jobs = None,
    settings: options.Settings = None,
    all: options.All = False,
    json: options.Json = False,
) -> None:
    """List the mutants that would run, and what is left out."""
    from mutabot.campaign.run import plan_only
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.listing import plan_data, print_plan

    request = request_of(
        context.obj, only=only, skip=skip, family=family, sample=sample, rounds=rounds, seed=seed, jobs=jobs,
        shard=shard, settings=settings,
    )  # fmt: skip
    with progress_shown() as progress:
        mutants, left_out = plan_only(request, progress)
    if json:
        print_json(plan_data(mutants, left_out))
    else:
        print_plan(make_console(), mutants, left_out, everything=all)


def run(
    context: typer.Context,
    only: options.Only = None,
    skip: options.Skip = None,
    family: options.Families = None,
    rounds: options.Rounds = None,
    jobs: options.Jobs = None,
    min_score: options.MinScore = None,
    json: options.Json = False,
    settings: options.Settings = None,
    sample: options.Sample = None,
    seed: options.Seed = None,
    engine: options.Engine = "auto",
    fresh: options.Fresh = False,
    verify: options.Verify = 0,
    since: options.Since = None,
    journal: options.OtherJournal = None,
    budget: options.Budget = None,
    shard: options.Part = None,
    cluster: options.Cluster = None,
) -> None:
    """Run the campaign, or go on with it: baseline, controls, mutants, scores."""
    request = request_of(
        context.obj, only=only, skip=skip, family=family, rounds=rounds, jobs=jobs, settings=settings,
        sample=sample, seed=seed, engine=engine, fresh=fresh, verify=verify, since=since,
        other_journal=journal, budget=budget, shard=shard, cluster=cluster, evidence=True,
    )  # fmt: skip
    _show_end(request, partial(_run, request), min_score, json=json)


def live(
    context: typer.Context,
    only: options.Only = None,
    skip: options.Skip = None,
    family: options.Families = None,
    rounds: options.Rounds = None,
    jobs: options.Jobs = None,
    settings: options.Settings = None,
    sample: options.Sample = None,
    seed: options.Seed = None,
    engine: options.Engine = "auto",
    fresh: options.Fresh = False,
    budget: options.Budget = None,
    cluster: options.Cluster = None,
    port: options.Port = None,
) -> None:
    """Run the campaign and show its report in a browser while it fills, with pause and stop."""
    request = request_of(
        context.obj, only=only, skip=skip, family=family, rounds=rounds, jobs=jobs, settings=settings,
        sample=sample, seed=seed, engine=engine, fresh=fresh, budget=budget, cluster=cluster, evidence=True,
    )  # fmt: skip
    with _served(request, port) as served:
        _show_end(request, served.run)


def _show_end(
    request: Request,
    campaign: Callable[[Progress], Path],
    min_score: float | None = None,
    *,
    json: bool = False,
) -> None:
    """Run a campaign, print how it ended, and exit as the limits decide. Raises typer.Exit."""
    with progress_shown() as progress:
        path = campaign(progress)
    results = show_results(path, json=json, summary=True)
    exit_as(decided(request.configuration, results, min_score))


def _run(request: Request, progress: Progress) -> Path:
    from mutabot.campaign.run import run_campaign

    return run_campaign(request, progress)


def _served(request: Request, port: int | None) -> Live:
    """What runs the campaign with a page. Raises UsageError if the port cannot be had."""
    from mutabot_live.live import Live

    live = Live(request, port or 0, lambda text: tell([f"mutabot: {text}"]))
    tell([f"mutabot: live at {live.address}"])
    return live
