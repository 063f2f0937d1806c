"""Who notices faults that have sizes: disturbances of the world, and graded faults at all magnitudes.

Of a program on the cell ``DISTURBANCES`` are drawn of all parameters, directions and magnitudes of
``mutabot_cell:world.toml``. Of a program on plain objects all ladders of family ``graded`` are run. Every
test runs with every magnitude, in one round.
"""

from __future__ import annotations

import tempfile
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from importlib.resources import files
from itertools import groupby
from pathlib import Path
from random import Random

from mutabot.campaign.request import Request
from mutabot.campaign.run import run_campaign
from mutabot.cli.request import request_of
from mutabot.journal.reader import JournalReader
from mutabot.model import Role, Verdict
from mutabot.operators.magnitudes import LADDERS
from mutabot.results.results import MutantResult, Results, read_results
from mutabot.thresholds.demands import Demand
from mutabot_world.ladders import WorldEnd, judge
from mutabot_world.tables import ParameterFile, ParameterTable
from real_bugs.gathering import (
    DIFFERS,
    KILLED,
    PROGRAMS,
    REFUSED,
    SAME,
    Noticed,
    SilentProgress,
    copied,
    noticing,
)
from real_bugs.matrix import PROBE

WORLD, GRADED = "world", "graded"
#: of each program on the cell, drawn by its name
DISTURBANCES = 12
#: what stands between a ladder's id and a magnitude
AT = " at "
#: graded operators whose ladders are those of the quantities of plain objects
_OPERATORS = ("offset", "scale", "sensor-noise", "quantise", "deadband", "lag", "early")
_CELL = '\n[world]\nparameters = ["mutabot_cell:world.toml"]\n'


def with_sizes(name: str) -> list[Noticed]:
    """Run what has sizes of a program; nothing of one on ROS 2."""
    if (PROGRAMS / name / f"{PROBE}.py").exists():
        return of_ladders(name)
    return [] if (PROGRAMS / name / "robot.toml").exists() else of_world(name)


def disturbances(name: str) -> list[tuple[str, str]]:
    """Draw the disturbances of a program on the cell: the name of the parameter, and how it is changed."""
    text = files("mutabot_cell").joinpath("world.toml").read_text(encoding="utf-8")
    tables = ParameterFile.model_validate(tomllib.loads(text)).parameter
    all_of_them = [(table.name, variant) for table in tables for variant in _variants(table)]
    return Random(name).sample(all_of_them, DISTURBANCES)


def _variants(table: ParameterTable) -> Iterator[str]:
    unit = "%" if table.measure == "percent" else table.measure or ""
    return (f"{way}{size:g}{unit}" for way in table.ways for size in table.ladder)


def of_world(name: str) -> list[Noticed]:
    """Run every test of a program on the cell with each disturbance that is drawn."""
    with tempfile.TemporaryDirectory() as folder:
        copy = copied(PROGRAMS / name, Path(folder))
        settings = copy / "mutabot.toml"
        settings.write_text(settings.read_text(encoding="utf-8") + _CELL, encoding="utf-8")
        only = [f"*:{parameter}:disturb={variant}" for parameter, variant in disturbances(name)]
        results = _run(replace(request_of(copy, family=[WORLD], only=only), repeats=False))
        return world_noticed(results)


def _run(request: Request) -> Results:
    with JournalReader.open(run_campaign(request, SilentProgress())) as journal:
        return read_results(journal)


def world_noticed(results: Results) -> list[Noticed]:
    """Who notices each disturbance: one mutant for each test; those that disturb no test are left out."""

    def key(result: MutantResult) -> tuple[str, str]:
        return result.mutant.site.text, result.mutant.variant

    found = []
    for (parameter, variant), those in groupby(sorted(results.graded, key=key), key):
        outcomes = [outcome for result in those for outcome in result.outcomes]
        by = frozenset[str]().union(*map(noticing, outcomes))
        ends = {judge(outcome, {}).end for outcome in outcomes}
        if not by and ends <= {WorldEnd.UNKNOWN}:
            continue
        end = KILLED if by else DIFFERS if WorldEnd.UNSEEN in ends else SAME
        found.append(Noticed(WORLD, parameter, variant, end, by))
    return found


def of_ladders(name: str) -> list[Noticed]:
    """Run every test of a program on plain objects with its graded faults at all magnitudes.

    A campaign looks for one threshold by as few runs as it can. All magnitudes are demanded here, so that the
    threshold of each part of the tests is known.
    """
    demands = tuple(
        Demand(size, steps.unit, operator=operator)
        for steps in LADDERS.values()
        for size in steps.steps
        for operator in _OPERATORS
    )
    with tempfile.TemporaryDirectory() as folder:
        request = request_of(copied(PROGRAMS / name, Path(folder)), family=[GRADED])
        configuration = request.configuration.model_copy(update={"demands": demands})
        request = replace(request, configuration=configuration, every_test=True, repeats=False)
        return graded_noticed(_run(request))


def graded_noticed(results: Results) -> list[Noticed]:
    """Who notices each magnitude of each ladder in the program; ``what`` begins with the ladder's id."""
    found = []
    for result in results.graded:
        mutant = result.mutant
        for outcome in result.outcomes:
            by = noticing(outcome)
            is_judged = outcome.verdict not in (Verdict.ERROR, Verdict.TIMEOUT) or by
            if not is_judged or mutant.site.role is not Role.PROGRAM:
                continue
            is_refused = outcome.verdict in (Verdict.INVALID, Verdict.REFUSED)
            end = REFUSED if is_refused else KILLED if by else SAME
            what = f"{mutant.ladder}{AT}{mutant.magnitude:g} {mutant.unit or ''}".rstrip()
            found.append(Noticed(GRADED, mutant.operator, what, end, by))
    return found
