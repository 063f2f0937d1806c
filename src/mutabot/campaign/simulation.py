"""Run a campaign over a simulation of its middleware, if the original ends there as over the real one."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from mutabot.campaign.baseline.baseline import Sources, observations_of
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.comparison import Observation, compare
from mutabot.campaign.plan import make_plan
from mutabot.campaign.request import AUTO, Request
from mutabot.errors import MutabotError, UsageError
from mutabot.execution.task import Result
from mutabot.extensions import brought
from mutabot.frozen import frozen
from mutabot.model import Vocabulary


class SimulatedMiddleware(ABC):
    """A simulation of a middleware that packages bring. Its name is the one in the extension.

    Attributes:
        title: it in a sentence, such as "a simulation of ROS 2".
        real: what it stands for, such as "real ROS 2".
        draws: whether each round draws another order of events. A test that fails in some of them alone has
            found something, and is set aside there with what repeats it.
    """

    name: str
    title: str
    real: str
    draws: bool = False

    @abstractmethod
    def over(self, request: Request) -> Request | None:
        """The request with its tests run over the simulation; None if the project has no use for it.

        Raises MutabotError, with the reason, if the project needs the real middleware.
        """

    def why(self, error: MutabotError) -> str:
        """The reason why the original did not run over the simulation, in one sentence."""
        return " ".join(line.strip() for line in str(error).splitlines()[:2])


def over(request: Request, name: str) -> Request:
    """A request whose tests run over the simulation of this name, as those of an earlier campaign did."""
    part = brought("simulations").get(name)
    changed = part.make(SimulatedMiddleware).over(request) if part is not None else None  # type: ignore[type-abstract]
    if changed is None:
        raise UsageError(
            f"the campaign ran over the simulation {name!r}, which this project does not use now"
        )
    return replace(changed, simulation=name)


@frozen
class Tried:
    """The original as it ran over a simulation.

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
    for name, part in brought("simulations").items():
        simulation = part.make(SimulatedMiddleware)  # type: ignore[type-abstract]
        try:
            changed = simulation.over(request)
            if changed is not None:
                return Tried(simulation, *take(replace(changed, simulation=name)))
        except MutabotError as error:
            return Tried(simulation, why=simulation.why(error))
    return None


def chosen(real: Campaign, results: list[Result], tried: Tried) -> tuple[Campaign, list[Result]]:
    """The campaign over the simulation if the original ends there as over the real middleware, else this one.

    What is chosen is told, and stands in the journal.
    """
    there, simulation = tried.campaign, tried.simulation
    why = tried.why if there is None else difference(results, real, tried)
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


def difference(results: Sequence[Result], real: Campaign, tried: Tried) -> str | None:
    """How the original differs over the simulation, in words; None if it ends there as over the real one.

    What differs between two runs over the real middleware as well is no difference.
    """
    sources, runs = Sources(real.request.root), {result.task.key: result for result in results}
    lines: dict[str, list[str | None]] = {}
    for result in tried.results:
        round, repetition = result.task.key
        if repetition:
            continue
        of_round = (runs[round, 0], runs[round, 1], result)
        ends = [{end.test: end.lasting for end in one.ends} for one in of_round]
        seen = [observations_of(one, sources) for one in of_round]
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
        if any(of_test) and not (tried.simulation.draws and None in of_test):
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
