"""Run a campaign over a simulation of its middleware, if the original ends there as over the real one.

Compared are outcomes, values and the calls of sites.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.campaign.baseline.baseline import observation
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.comparison import Observation, compare
from mutabot.campaign.plan import make_plan
from mutabot.config.options import AUTO
from mutabot.errors import MutabotError, UsageError
from mutabot.execution.task import Result
from mutabot.extensions import brought
from mutabot.frozen import frozen
from mutabot.model.operation import Clock

if TYPE_CHECKING:
    from mutabot.campaign.request import Request
    from mutabot.config.table import Table
    from mutabot.model import Vocabulary


class SimulatedMiddleware(ABC):
    """A simulation of a middleware that a package brings, with a pytest plug-in that runs tests over it.

    Attributes:
        name: the one in the extension.
        title: it in a sentence, such as "a simulation of ROS 2".
        real: what it stands for, such as "real ROS 2".
        clock: the callable ``module:qualified.name`` that advances simulated time and returns it, in s.
            Limits and reports count by it unless the vocabulary has a clock.
    """

    name: str
    title: str
    real: str
    clock: str

    @abstractmethod
    def arguments(
        self, root: Path, given: Sequence[str], tables: Mapping[str, Table]
    ) -> Sequence[str] | None:
        """Return pytest arguments, placed before the project's own, that run its tests over the simulation.

        None if the project has no use for it. Raises UsageError, with the reason, if the project could use it
        but needs the real middleware.

        Args:
            root: the project's folder.
            given: the project's own arguments of pytest.
            tables: what the configuration says, by the names of the tables that packages bring.
        """

    def draws(self, tables: Mapping[str, Table]) -> bool:
        """Return whether each round has an order of callbacks of its own; ``tables`` as in ``arguments``.

        A test that fails in some rounds alone has found something then: it is no difference between
        simulation and middleware.
        """
        return False

    def reason(self, message: str) -> str:
        """Return why the original did not run over the simulation, in one sentence, by its error message."""
        return " ".join(line.strip() for line in message.splitlines()[:2])


def with_simulation(request: Request, name: str) -> Request:
    """Make the tests of a request run over the simulation of this name, as in an earlier campaign.

    Raises UsageError if the project does not use it now.
    """
    part = brought("simulations").get(name)
    changed = _over(part.make(SimulatedMiddleware), request) if part is not None else None  # type: ignore[type-abstract]
    if changed is None:
        raise UsageError(
            f"the campaign ran over the simulation {name!r}, which this project does not use now"
        )
    return changed


def _over(simulation: SimulatedMiddleware, request: Request) -> Request | None:
    """Return the request over a simulation; None if the project does not use it."""
    configuration, vocabulary = request.configuration, request.vocabulary
    arguments = simulation.arguments(request.root, request.arguments, configuration.tables)
    if arguments is None:
        return None
    changed = configuration.model_copy(update={"pytest_args": (*arguments, *configuration.pytest_args)})
    clock = vocabulary.clock or Clock(simulation.clock, source=simulation.title)
    return replace(
        request,
        configuration=changed,
        vocabulary=replace(vocabulary, clock=clock),
        simulation=simulation.name,
    )


@frozen
class Tried:
    """The result of running the original over a simulation.

    Attributes:
        simulation: which one.
        campaign: over it, with its baseline; None if the original did not run there.
        results: the raw results of the baseline.
        why: why it did not run there.
    """

    simulation: SimulatedMiddleware
    campaign: Campaign | None = None
    results: Sequence[Result] = ()
    why: str = ""


def try_original(request: Request, take: Callable[[Request], tuple[Campaign, list[Result]]]) -> Tried | None:
    """Run the original over the simulation that fits the project; None if none does.

    ``take`` takes the baseline of a request, in processes of its own. Only ``auto`` chooses a simulation,
    and only on this machine.
    """
    if request.engine != AUTO or request.executor is not None or request.simulation or request.ran_over:
        return None
    for part in brought("simulations").values():
        simulation = part.make(SimulatedMiddleware)  # type: ignore[type-abstract]
        try:
            changed = _over(simulation, request)
            if changed is not None:
                return Tried(simulation, *take(changed))
        except MutabotError as error:
            return Tried(simulation, why=simulation.reason(str(error)))
    return None


def chosen(real: Campaign, results: list[Result], tried: Tried) -> tuple[Campaign, list[Result]]:
    """Return the campaign over the simulation if the original ends there as over the real middleware.

    What is chosen is reported, and stands in the journal.
    """
    there, simulation = tried.campaign, tried.simulation
    why = tried.why if there is None else _difference(real, results, tried)
    if there is None or why is not None:
        text = f"The tests ran over {simulation.real}, not over {simulation.title}: {why}."
        real.progress.note(text)
        return replace(real, request=replace(real.request, ran_over=text)), results
    tests = sum(len(real.baseline.ran(round)) for round in range(real.request.rounds))
    text = (
        f"The tests ran over {simulation.title}; the original ends there as over {simulation.real} "
        f"({tests} {'test' if tests == 1 else 'tests'} compared)."
    )
    real.progress.note(text)
    make_plan(real.baseline, real.request.project)  # outcomes are verified by it
    request = replace(there.request, ran_over=text)
    return replace(there, request=request, evidence=real.evidence, real=real), list(tried.results)


def _difference(real: Campaign, results: Sequence[Result], tried: Tried) -> str | None:
    """Describe how the original differs over a simulation; None if it ends as over the real middleware.

    What differs between two runs over the real middleware as well is no difference. If the simulation draws
    another order of callbacks in each round, a test that fails in some of them alone has found something, and
    is set aside there with what repeats it.

    Args:
        real: the campaign over the real middleware, with its baseline.
        results: the raw results of that baseline, which has at least two runs of each round.
        tried: the original over the simulation.
    """
    sources, runs = real.sources, {result.task.key: result for result in results}
    lines: dict[str, list[str | None]] = {}
    for result in tried.results:
        round, repetition = result.task.key
        if repetition:
            continue
        of_round = (runs[round, 0], runs[round, 1], result)
        ends = [{end.test: end.lasting for end in result.ends} for result in of_round]
        seen = [
            {end.test: observation(end, places) for end in result.ends}
            for result, places in ((result, sources.places(result.sites)) for result in of_round)
        ]
        for test in dict.fromkeys([*ends[0], *ends[2]]):
            was, again, now = (end_by_test.get(test, "not run") for end_by_test in ends)
            line = None
            if now not in {was, again}:
                line = f"{test} is {was} in round {round + 1}, and {now} in the simulation"
            elif test in real.baseline.tests[round] and now == was == again:
                value = _value(seen[0][test], seen[1][test], seen[2][test], real.request.vocabulary)
                line = value and f"{test} differs in round {round + 1} in the simulation: {value}"
            lines.setdefault(test, []).append(line)
    draws = tried.simulation.draws(real.request.configuration.tables)
    for of_test in lines.values():
        if any(of_test) and not (draws and None in of_test):
            return next(line for line in of_test if line)
    return None


def _value(first: Observation, second: Observation, other: Observation, vocabulary: Vocabulary) -> str | None:
    """Describe the first difference in probes, returned values or calls of a site that real runs share.

    In which order nodes come to their sites is a matter of chance.
    """
    runs = (first, second, other)
    parts = [
        [Observation(probes=observed.probes, unread=observed.unread) for observed in runs],
        [Observation(returned=observed.returned, prepared=observed.prepared) for observed in runs],
        *(_at(site, runs) for site in dict.fromkeys(call.key for call in (*first.events, *other.events))),
    ]
    known = vocabulary.probes, vocabulary.operations
    for before, again, now in parts:
        found = compare(before, now, *known).divergence
        if found and not compare(before, again, *known).divergence:
            site = next((f"{call.key}: " for call in (*before.events, *now.events)), "")
            return f"{site}{found[0]}"
    return None


def _at(site: str, runs: Sequence[Observation]) -> list[Observation]:
    """Return the first call of a site in some runs.

    How often it is reached, and whether an answer comes before the test has ended, is a matter of moments.
    """
    first = [[call for call in run.events if call.key == site][:1] for run in runs]
    calls = [call for found in first for call in found]
    if len(calls) < len(runs) or not all(isinstance(call.read, Mapping) for call in calls):
        return [Observation(found) for found in first]
    read = set.intersection(*({*call.read} for call in calls))
    return [Observation([replace(call, read={name: call.read[name] for name in read})]) for call in calls]
