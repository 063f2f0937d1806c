"""Run a campaign over a simulation of its middleware, if the original ends there as over the real one."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace

from mutabot.campaign.campaign import Campaign
from mutabot.campaign.plan import make_plan
from mutabot.campaign.request import AUTO, Request
from mutabot.errors import MutabotError, UsageError
from mutabot.execution.task import Result
from mutabot.extensions import brought
from mutabot.frozen import frozen


class SimulatedMiddleware(ABC):
    """A simulation of a middleware that packages bring. Its name is the one in the extension.

    Attributes:
        title: it in a sentence, such as "a simulation of ROS 2".
        real: what it stands for, such as "real ROS 2".
    """

    name: str
    title: str
    real: str

    @abstractmethod
    def adapt(self, request: Request) -> Request | None:
        """Make the tests of a request run over the simulation; None if the project has no use for it.

        Raises MutabotError, with the reason, if the project needs the real middleware.
        """

    @abstractmethod
    def difference(
        self, real: Campaign, results: Sequence[Result], simulated: Sequence[Result]
    ) -> str | None:
        """How the original differs over the simulation, in words; None if it ends there as over the real one.

        ``results`` are those of the baseline of ``real``, ``simulated`` those over the simulation.
        """

    def why(self, error: MutabotError) -> str:
        """The reason why the original did not run over the simulation, in one sentence."""
        return " ".join(line.strip() for line in str(error).splitlines()[:2])


def with_simulation(request: Request, name: str) -> Request:
    """Make the tests of a request run over the simulation of this name, as in an earlier campaign."""
    part = brought("simulations").get(name)
    changed = part.make(SimulatedMiddleware).adapt(request) if part is not None else None  # type: ignore[type-abstract]
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
            changed = simulation.adapt(request)
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
    why = tried.why if there is None else simulation.difference(real, results, tried.results)
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
