"""What could be read at the ends of tests: by the original in many rounds, and by the survivors."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from mutabot.campaign.again import as_it_is_now
from mutabot.campaign.baseline.taking import take_baseline
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.controls import run_controls
from mutabot.campaign.engines.isolated_run import task
from mutabot.campaign.request import Progress, Request
from mutabot.campaign.run import open_executor
from mutabot.model import Mutant, Probe
from mutabot.model.events import TestEnd

from .edits import edited
from .place import Addition, PlaceInTest
from .project import ProjectFiles, copy_of
from .readings import ORACLE, ReadExpression, of_objects, readings_at

#: what notes readings in the tests' process, and the probe that carries them out of it
_NOTED = "mutabot.runtime.observation.noted"
_PROBE = f"{_NOTED}:values"

#: what was read at the end of one test: expression to number, text or truth value
Read = Mapping[str, Any]


@dataclass(slots=True)
class Measured:
    """What was read.

    Attributes:
        originals: per place, by (round, node id), what the original's tests read.
        mutants: the same per place and mutant id.
        readings: per place, what is known of its readings.
        objects: readings of objects, each with its tolerance.
    """

    originals: dict[PlaceInTest, dict[tuple[int, str], Read]] = field(default_factory=dict)
    mutants: dict[PlaceInTest, dict[str, dict[tuple[int, str], Read]]] = field(default_factory=dict)
    readings: dict[PlaceInTest, list[ReadExpression]] = field(default_factory=dict)
    objects: list[tuple[str, float]] = field(default_factory=list)


def measure(
    request: Request,
    project: ProjectFiles,
    places: Mapping[str, PlaceInTest],
    survivors: Sequence[tuple[Mutant, Sequence[int]]],
    progress: Progress,
) -> Measured:
    """Run a copy of the project whose tests note what they can read.

    Args:
        request: for all rounds, fresh ones included.
        places: by node id with parameters.
        survivors: each with the rounds in which it survived.

    Raises what a baseline raises.
    """
    measured = Measured(objects=of_objects(project))
    additions = []
    for place in dict.fromkeys(places.values()):
        measured.readings[place] = readings_at(project, place)
        additions.append(_noting(place, measured.readings[place], measured.objects))
    with copy_of(request, edited(project, additions)) as copied:
        probes = (*copied.vocabulary.probes, Probe(_PROBE, 1e9))
        noting = replace(copied, vocabulary=replace(copied.vocabulary, probes=probes))
        with open_executor(noting, progress) as opened:
            baseline, results = take_baseline(noting, opened, progress, repetitions=1)
            for result in results:
                _take(measured.originals, places, result.task.key[0], result.ends)
            _run_survivors(Campaign(noting, baseline, opened, progress), measured, places, survivors)
    return measured


def _run_survivors(
    campaign: Campaign,
    measured: Measured,
    places: Mapping[str, PlaceInTest],
    survivors: Sequence[tuple[Mutant, Sequence[int]]],
) -> None:
    baseline, progress = campaign.baseline, campaign.progress
    now = [(as_it_is_now(campaign.request, baseline, mutant), rounds) for mutant, rounds in survivors]
    for _ in run_controls(campaign, [mutant for mutant, _ in now]):
        pass
    trials = [(mutant, round) for mutant, rounds in now for round in rounds]
    progress.stage("survivors", len(trials))
    tasks = (
        task(campaign, mutant, round, baseline.suite(round))
        for mutant, round in trials
        if baseline.tests_reaching(round, mutant)
    )
    for result in campaign.executor.run(tasks):
        mutant, round = result.task.key
        progress.advance(f"#{mutant.number} round {round + 1}")
        found: dict[PlaceInTest, dict[tuple[int, str], Read]] = {}
        reaching = baseline.tests_reaching(round, mutant)  # a check stands where the mutant is reached
        _take(found, places, round, [end for end in result.ends if end.test in reaching])
        for place, read in found.items():
            measured.mutants.setdefault(place, {}).setdefault(mutant.id, {}).update(read)


def _take(
    found: dict[PlaceInTest, dict[tuple[int, str], Read]],
    places: Mapping[str, PlaceInTest],
    round: int,
    ends: Iterable[TestEnd],
) -> None:
    for end in ends:
        place = places.get(end.test)
        prefix = f"{_PROBE}."
        read = {
            name.removeprefix(prefix): value for name, value in end.probes.items() if name.startswith(prefix)
        }
        if place is not None and read and end.outcome == "passed":
            found.setdefault(place, {})[round, end.test] = read


def _noting(
    place: PlaceInTest, readings: Sequence[ReadExpression], objects: Sequence[tuple[str, float]]
) -> Addition:
    """The lines that note; they are plain statements, and never fail."""
    # what the oracle does when it reads must not be seen by what only looks
    ordered = sorted(readings, key=lambda one: one.way == ORACLE)
    pairs = ", ".join(f"({one.text!r}, lambda: {one.text})" for one in ordered)
    classes = [target for target, _ in objects]
    return Addition(
        place,
        (
            f"from {_NOTED} import note as _mutabot_note",
            f"_mutabot_note(locals(), [{pairs}], {classes!r})",
        ),
        tuple(place.names),
        tuple(dict.fromkeys(line for one in readings for line in one.needs)),
    )
