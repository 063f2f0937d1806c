"""``mutabot check``, ``list`` and ``run``: a campaign, or what comes before its mutants."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415, PLR0917

from __future__ import annotations

from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from mutabot.errors import UsageError

from . import options
from .output import decided, echo, exit_as, print_json, progress_shown, show_results, tell
from .request import request_of

if TYPE_CHECKING:
    from mutabot.campaign.request import Progress, Request
    from mutabot.serving.live import Live


def check(
    context: typer.Context,
    json: options.Json = False,
    jobs: options.Jobs = None,
    rounds: options.Rounds = None,
    family: options.Families = None,
) -> None:
    """Try the whole set-up without running mutants."""
    from mutabot.campaign import check as campaign

    request = request_of(context.obj, jobs=jobs, rounds=rounds, family=family)
    with progress_shown() as progress:
        report = campaign.check(request, progress)
    print_json(report.data) if json else echo("\n".join(report.lines))


def list_(
    context: typer.Context,
    only: options.Only = None,
    skip: options.Skip = None,
    family: options.Families = None,
    when: options.When = None,
    order: options.Order = None,
    pairs: options.Pairs = None,
    selection: options.Selection = None,
    sample: options.Sample = None,
    one_per_site: options.OnePerSite = False,
    rounds: options.Rounds = None,
    seed: options.Seed = None,
    shard: options.Part = None,
    jobs: options.Jobs = None,
    all: options.All = False,
    json: options.Json = False,
) -> None:
    """List the mutants that would run, and what is left out."""
    from mutabot.campaign.run import plan_only
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.listing import plan_data, print_plan

    request = request_of(
        context.obj, only=only, skip=skip, family=family, when=when, order=order, pairs=pairs,
        selection=selection, sample=sample, one_per_site=one_per_site, rounds=rounds, seed=seed, jobs=jobs,
        shard=shard,
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
    when: options.When = None,
    whole_ladders: options.WholeLadders = False,
    order: options.Order = None,
    pairs: options.Pairs = None,
    selection: options.Selection = None,
    sample: options.Sample = None,
    one_per_site: options.OnePerSite = False,
    rounds: options.Rounds = None,
    seed: options.Seed = None,
    shard: options.Part = None,
    jobs: options.Jobs = None,
    engine: options.Engine = "auto",
    fresh: options.Fresh = False,
    since: options.Since = None,
    sites_only: options.SitesOnly = False,
    journal: options.OtherJournal = None,
    budget: options.Budget = None,
    verify: options.Verify = 0,
    confirm: options.Confirm = False,
    repeats: options.Repeats = True,
    baseline: options.BaselineRuns = None,
    min_score: options.MinScore = None,
    table: options.Table = False,
    json: options.Json = False,
    serve: options.Serve = False,
    port: options.Port = None,
    cluster: options.Cluster = None,
    mixed: options.Mixed = False,
    tls_ca: options.TlsCa = None,
    tls_cert: options.TlsCert = None,
    tls_key: options.TlsKey = None,
) -> None:
    """Run the campaign, or go on with it: baseline, controls, mutants, scores."""
    if port is not None and not serve:
        raise UsageError("--port goes with --serve")
    if sites_only and since is None:
        raise UsageError("--sites-only goes with --since")
    request = request_of(
        context.obj, only=only, skip=skip, family=family, when=when, whole_ladders=whole_ladders,
        order=order, pairs=pairs,
        selection=selection, sample=sample, one_per_site=one_per_site, rounds=rounds, seed=seed, jobs=jobs,
        engine=engine, fresh=fresh, verify=verify, confirm=confirm, repeats=repeats, baseline=baseline,
        evidence=True, since=since, sites_only=sites_only, other_journal=journal, budget=budget,
        shard=shard,
        cluster=_cluster(cluster, mixed=mixed, ca=tls_ca, cert=tls_cert, key=tls_key),
    )  # fmt: skip
    with ExitStack() as stack:
        campaign = stack.enter_context(_served(request, port)).run if serve else partial(_run, request)
        with progress_shown() as progress:
            journal_path = campaign(progress)
        results = show_results(journal_path, json=json, summary=not table)
        exit_as(decided(request.configuration, results, min_score))


def _cluster(address: str | None, **given: bool | str | None) -> dict[str, bool | str | None] | None:
    """What the options say about a cluster. Raises UsageError for those that need one."""
    if address is not None:
        return {"address": address, **{name: value for name, value in given.items() if value}}
    if any(given.values()):
        raise UsageError("--mixed, --tls-ca, --tls-cert and --tls-key go with --cluster")
    return None


def _run(request: Request, progress: Progress) -> Path:
    from mutabot.campaign.run import run_campaign

    return run_campaign(request, progress)


def _served(request: Request, port: int | None) -> Live:
    """What runs the campaign with a page. Raises UsageError if the port cannot be had."""
    from mutabot.serving.live import Live

    live = Live(request, port or 0, lambda text: tell([f"mutabot: {text}"]))
    tell([f"mutabot: live at {live.address}"])
    return live
