"""Whether the original ends over a simulation as over the real middleware.

Compared are outcomes, values and the calls of sites.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from mutabot.campaign.baseline.baseline import observation
from mutabot.campaign.comparison import Observation, compare

if TYPE_CHECKING:
    from mutabot.campaign.campaign import Campaign
    from mutabot.execution.task import Result
    from mutabot.model import Vocabulary


def difference(
    real: Campaign, results: Sequence[Result], simulated: Sequence[Result], *, draws: bool
) -> str | None:
    """How the original differs over a simulation, in one line; None if it ends there as over the real one.

    What differs between two runs over the real middleware as well is no difference. With ``draws`` each round
    has another order of callbacks: a test that fails in some of them alone has found something, and is set
    aside there with what repeats it.

    Args:
        real: the campaign over the real middleware, with its baseline.
        results: the raw results of that baseline, which has at least two runs of each round.
        simulated: those of the baseline over the simulation.
        draws: see ``SimulatedMiddleware.draws``.
    """
    sources, runs = real.sources, {result.task.key: result for result in results}
    lines: dict[str, list[str | None]] = {}
    for result in simulated:
        round, repetition = result.task.key
        if repetition:
            continue
        of_round = (runs[round, 0], runs[round, 1], result)
        ends = [{end.test: end.lasting for end in one.ends} for one in of_round]
        seen = [
            {end.test: observation(end, places) for end in one.ends}
            for one, places in ((one, sources.places(one.sites)) for one in of_round)
        ]
        for test in dict.fromkeys([*ends[0], *ends[2]]):
            was, again, now = (one.get(test, "not run") for one in ends)
            line = None
            if now not in {was, again}:
                line = f"{test} is {was} in round {round + 1}, and {now} in the simulation"
            elif test in real.baseline.tests[round] and now == was == again:
                value = _value(seen[0][test], seen[1][test], seen[2][test], real.request.vocabulary)
                line = value and f"{test} differs in round {round + 1} in the simulation: {value}"
            lines.setdefault(test, []).append(line)
    for of_test in lines.values():
        if any(of_test) and not (draws and None in of_test):
            return next(line for line in of_test if line)
    return None


def _value(first: Observation, second: Observation, other: Observation, words: Vocabulary) -> str | None:
    """The first difference in what two real runs have alike: probes, what was returned, calls of a site.

    In which order nodes come to their sites is a matter of chance.
    """
    runs = (first, second, other)
    parts = [
        [Observation(probes=one.probes, unread=one.unread) for one in runs],
        [Observation(returned=one.returned, prepared=one.prepared) for one in runs],
        *(
            _at(site, runs)
            for site in dict.fromkeys(call.key for one in (first, other) for call in one.events)
        ),
    ]
    for one, two, three in parts:
        found = compare(one, three, words.probes, words.operations).divergence
        if found and not compare(one, two, words.probes, words.operations).divergence:
            site = next((f"{call.key}: " for call in (*one.events, *three.events)), "")
            return f"{site}{found[0]}"
    return None


def _at(site: str, runs: Sequence[Observation]) -> list[Observation]:
    """The first call of a site in some runs.

    How often it is reached, and whether an answer comes before the test has ended, is a matter of moments.
    """
    first = [[call for call in one.events if call.key == site][:1] for one in runs]
    calls = [call for found in first for call in found]
    if len(calls) < len(runs) or not all(isinstance(call.read, Mapping) for call in calls):
        return [Observation(found) for found in first]
    read = set.intersection(*({*call.read} for call in calls))
    return [Observation([replace(call, read={name: call.read[name] for name in read})]) for call in calls]
