"""Make the request for a campaign from the command line's options and the configuration."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Unpack

from mutabot.campaign.request import ExecutorChoice, Request
from mutabot.campaign.simulation import with_simulation
from mutabot.config.configuration import Configuration, load_configuration
from mutabot.config.options import ALL, AUTO, ENGINES, OPERATORS, Sample, Shard, parse_duration
from mutabot.config.vocabulary import load_vocabulary
from mutabot.errors import UsageError, unknown_name_text
from mutabot.extensions import brought
from mutabot.faults import asked_for
from mutabot.journal.records import RAN_OVER
from mutabot.model import Moment
from mutabot.results.results import Results

from .options import Running


def request_of(
    project: Path,
    *,
    executor: tuple[str, str] | None = None,
    evidence: bool = False,
    every_test: bool = False,
    **given: Unpack[Running],
) -> Request:
    """Return the request of a command, by its options and, where they are missing, the configuration.

    Args:
        executor: the name of an executor, and the value of its option; None for this machine.
        evidence: whether to record, unless the configuration has no room for it.
        every_test: as in ``Request``.
        given: the options.

    Raises UsageError and ConfigurationError.
    """
    if unknown := given.keys() - Running.__annotations__.keys():
        raise TypeError(f"there is no option {', '.join(sorted(unknown))}")
    engine, seed = given.get("engine", AUTO), given.get("seed")
    sample, shard, budget = given.get("sample"), given.get("shard"), given.get("budget")
    if engine not in (AUTO, *ENGINES):
        raise UsageError(unknown_name_text("engine", engine, (AUTO, *ENGINES)))
    operators = given.get("operators", ALL)
    if operators not in OPERATORS:
        raise UsageError(unknown_name_text("selection of operators", operators, OPERATORS))
    size = Sample.parse(sample) if sample is not None else None
    families = families_of(given.get("family"))
    configuration = load_configuration(project, families, given.get("settings") or ())
    root, families = configuration.root, families or configuration.families
    moments = map(Moment.parse_any, configuration.when)
    chosen = _chosen(executor, configuration)
    request = Request(
        configuration=configuration,
        vocabulary=load_vocabulary(configuration.vocabulary, configuration.root, families),
        rounds=given.get("rounds") or configuration.rounds,
        seed=configuration.seed if seed is None else seed,
        jobs=given.get("jobs") or configuration.jobs or len(os.sched_getaffinity(0)),
        only=_listed(given.get("only"), root),
        skip=_listed(given.get("skip"), root),
        operators=operators,
        engine=engine,
        executor=chosen,
        fresh=given.get("fresh", False),
        verify=given.get("verify"),
        repeats=configuration.repeats,
        baseline=configuration.baseline_repetitions,
        families=families,
        sample=size,
        every_test=every_test,
        moments=tuple({moment and moment.text: moment for moment in moments}.values()),
        shard=Shard.parse(shard) if shard is not None else None,
        evidence=evidence and configuration.evidence > 0,
        since=given.get("since"),
        other_journal=given.get("journal"),
        budget=None if budget is None else parse_duration(budget),
    )
    return request if chosen is None else chosen.fitted(request)


def _chosen(executor: tuple[str, str] | None, configuration: Configuration) -> ExecutorChoice | None:
    """Return the executor that the command line names, or otherwise the configuration implies.

    None for this machine.
    """
    tables = configuration.tables
    for name, part in brought("executors").items() if executor is not None or tables else ():
        if name != executor[0] if executor is not None else name not in tables:
            continue
        kind = part.load_class(ExecutorChoice)  # type: ignore[type-abstract]
        if executor is None:
            found = kind.implied(tables[name])
        else:
            found = kind.parse(executor[1], configuration.root, tables.get(name))
        if found is not None:
            return found
    return None


def request_again(root: Path, results: Results, jobs: int | None) -> Request:
    """Return the request of the campaign that had these results, for some of its mutants."""
    meta = results.meta
    request = request_of(
        root, rounds=results.rounds, seed=meta.get("seed"), jobs=jobs, family=meta.get("families"),
        every_test=bool(meta.get("every_test")),
    )  # fmt: skip
    request = replace(request, ran_over=str(meta.get(RAN_OVER) or ""))
    name = meta.get("simulation")
    return with_simulation(request, name) if name else request


def families_of(given: Sequence[str] | None) -> tuple[str, ...]:
    """Return the families of the command line, in the order of their numbers. Raises UsageError."""
    named = (name.strip() for text in given or () for name in text.split(","))
    return asked_for(name for name in named if name)


def _listed(words: Sequence[str] | None, root: Path) -> tuple[str, ...]:
    """Return the words of ``--only`` and ``--skip``; a list, ``@FILE``, is searched here and in the project.

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
