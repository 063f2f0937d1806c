"""From the options of the command line and the configuration to what a campaign is asked to do."""

# What a campaign needs is imported when it is asked for, so that `--help` is fast.
# ruff: noqa: PLC0415

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mutabot.errors import UsageError, unknown_name_text

from .options import ENGINES

if TYPE_CHECKING:
    from mutabot.campaign.request import Request
    from mutabot.model import Moment
    from mutabot.settings.configuration import Configuration


def request_of(
    project: Path,
    *,
    selection: Path | None = None,
    sample: str | None = None,
    engine: str = "auto",
    configured_selection: bool = True,
    **given: Any,
) -> Request:
    """The request of a command: its options (``given``, by their names), else what the configuration says.

    Raises UsageError and ConfigurationError.
    """
    from mutabot.campaign.request import Request
    from mutabot.settings.cluster import cluster_settings
    from mutabot.settings.configuration import load_configuration
    from mutabot.settings.duration import seconds_of
    from mutabot.settings.sample import Sample
    from mutabot.settings.shard import Shard
    from mutabot.vocabulary import load

    if engine not in ENGINES:
        raise UsageError(unknown_name_text("engine", engine, ENGINES))
    size = Sample.parse(sample) if sample is not None else None
    families = families_of(given.get("family"))
    configuration = load_configuration(project, families)
    families = families or configuration.families
    if selection is None and configuration.selection is not None and configured_selection:
        selection = configuration.root / configuration.selection
    elif selection is not None:
        selection = _found(selection, configuration.root)
    cluster = None
    if given.get("cluster"):
        cluster = cluster_settings(**_certified(configuration, **given["cluster"]))
    return Request(
        configuration=configuration,
        vocabulary=load(configuration.vocabulary, configuration.root, families),
        rounds=given.get("rounds") or configuration.rounds,
        seed=configuration.seed if given.get("seed") is None else given["seed"],
        jobs=given.get("jobs") or configuration.jobs or len(os.sched_getaffinity(0)),
        only=tuple(given.get("only") or ()),
        skip=tuple(given.get("skip") or ()),
        selection=selection,
        engine=engine,
        executor="local" if cluster is None else "cluster",
        cluster=cluster,
        fresh=bool(given.get("fresh")),
        verify=given.get("verify") or 0,
        confirm=bool(given.get("confirm")),
        repeats=given.get("repeats", True),
        baseline=given.get("baseline") or configuration.baseline_repetitions,
        families=families,
        sample=size,
        one_per_site=bool(given.get("one_per_site")),
        order=given.get("order") or configuration.order,
        pairs=given.get("pairs") or configuration.pairs,
        every_test=bool(given.get("every_test")),
        moments=_moments(given.get("when") or configuration.when),
        whole_ladders=bool(given.get("whole_ladders")),
        shard=Shard.parse(given["shard"]) if given.get("shard") is not None else None,
        evidence=bool(given.get("evidence")) and configuration.evidence > 0,
        since=given.get("since"),
        sites_only=bool(given.get("sites_only")),
        other_journal=given.get("other_journal"),
        budget=None if given.get("budget") is None else seconds_of(given["budget"]),
    )


def _certified(configuration: Configuration, address: str, **given: Any) -> dict[str, Any]:
    """What is known of a cluster, with the certificate files of the configuration where it may need them."""
    files: dict[str, str] = {}
    if not address.startswith(("tcp://", "local:")):
        files = {name: str(configuration.root / file) for name, file in configuration.cluster.items()}
    return {"address": address, **files, **given}


def families_of(given: Sequence[str] | None) -> tuple[str, ...]:
    """The families of the command line, in the order of their numbers. Raises UsageError."""
    from mutabot.settings.families import asked_for

    named = (name.strip() for text in given or () for name in text.split(","))
    return asked_for(name for name in named if name)


def _moments(texts: Sequence[str]) -> tuple[Moment | None, ...]:
    """At which calls mutants act. Raises UsageError."""
    from mutabot.model import Moment

    found: dict[str, Moment | None] = {}
    try:
        for text in texts:
            moment = Moment.parse_any(text)
            found.setdefault(moment.text if moment is not None else "", moment)
    except ValueError as error:
        raise UsageError(f"--when: {error}") from error
    return tuple(found.values())


def _found(selection: Path, root: Path) -> Path:
    """The selection file, looked for here and in the project; said now rather than after the baseline."""
    for place in (selection, root / selection):
        if place.is_file():
            return place
    raise UsageError(f"there is no selection file {selection}, neither here nor in {root}")
