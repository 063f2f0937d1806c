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
    from mutabot_dask.settings import ClusterSettings


def request_of(
    project: Path,
    *,
    sample: str | None = None,
    engine: str = "auto",
    configured_selection: bool = True,
    **given: Any,
) -> Request:
    """The request of a command: its options (``given``, by their names), else what the configuration says.

    Raises UsageError and ConfigurationError.
    """
    from mutabot.campaign.request import Request
    from mutabot.settings.configuration import load_configuration
    from mutabot.settings.duration import seconds_of
    from mutabot.settings.sample import Sample
    from mutabot.settings.shard import Shard
    from mutabot.vocabulary import load

    if engine not in ENGINES:
        raise UsageError(unknown_name_text("engine", engine, ENGINES))
    size = Sample.parse(sample) if sample is not None else None
    families = families_of(given.get("family"))
    configuration = load_configuration(project, families, given.get("settings") or ())
    root, families = configuration.root, families or configuration.families
    selection = None
    if configuration.selection is not None and configured_selection:
        selection = root / configuration.selection
    cluster = None
    if given.get("cluster"):
        cluster = _cluster(configuration, given["cluster"])
    return Request(
        configuration=configuration,
        vocabulary=load(configuration.vocabulary, configuration.root, families),
        rounds=given.get("rounds") or configuration.rounds,
        seed=configuration.seed if given.get("seed") is None else given["seed"],
        jobs=given.get("jobs") or configuration.jobs or len(os.sched_getaffinity(0)),
        only=_listed(given.get("only"), root),
        skip=_listed(given.get("skip"), root),
        selection=selection,
        engine=engine,
        executor="local" if cluster is None else "cluster",
        cluster=cluster,
        fresh=bool(given.get("fresh")),
        verify=given.get("verify") or 0,
        repeats=configuration.repeats,
        baseline=configuration.baseline_repetitions,
        families=families,
        sample=size,
        order=given.get("order") or configuration.order,
        pairs=configuration.pairs,
        every_test=bool(given.get("every_test")),
        moments=_moments(configuration.when),
        shard=Shard.parse(given["shard"]) if given.get("shard") is not None else None,
        evidence=bool(given.get("evidence")) and configuration.evidence > 0,
        since=given.get("since"),
        other_journal=given.get("other_journal"),
        budget=None if given.get("budget") is None else seconds_of(given["budget"]),
    )


def _cluster(configuration: Configuration, address: str) -> ClusterSettings:
    """The cluster, with the certificate files of the configuration if it may need them. Raises UsageError."""
    from mutabot_dask.settings import cluster_settings

    if address.startswith(("tcp://", "local:")):
        return cluster_settings(address)
    table, root = configuration.cluster, configuration.root
    files = {name: str(root / table[name]) for name in ("ca", "cert", "key") if name in table}
    return cluster_settings(address, ca=files.get("ca"), cert=files.get("cert"), key=files.get("key"))


def families_of(given: Sequence[str] | None) -> tuple[str, ...]:
    """The families of the command line, in the order of their numbers. Raises UsageError."""
    from mutabot.settings.families import asked_for

    named = (name.strip() for text in given or () for name in text.split(","))
    return asked_for(name for name in named if name)


def _moments(texts: Sequence[str]) -> tuple[Moment | None, ...]:
    """At which calls mutants act; the texts were checked with the configuration."""
    from mutabot.model import Moment

    found: dict[str, Moment | None] = {}
    for text in texts:
        moment = Moment.parse_any(text)
        found.setdefault(moment.text if moment is not None else "", moment)
    return tuple(found.values())


def _listed(words: Sequence[str] | None, root: Path) -> tuple[str, ...]:
    """Words of ``--only`` and ``--skip``; a list, ``@FILE``, is looked for here and in the project.

    Raises UsageError now rather than after the baseline.
    """
    found = []
    for word in words or ():
        if word.startswith("@"):
            places = [Path(word[1:]), root / word[1:]]
            file = next((place for place in places if place.is_file()), None)
            if file is None:
                raise UsageError(f"there is no list of mutants {word[1:]}, neither here nor in {root}")
            found.append(f"@{file}")
        else:
            found.append(word)
    return tuple(found)
