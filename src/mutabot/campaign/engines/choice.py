"""The engines put to work, one after the other: each mutant by the first that can judge it."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace
from functools import cache
from itertools import takewhile

from mutabot.campaign.campaign import Campaign, Sink
from mutabot.campaign.request import Request
from mutabot.errors import UsageError, unknown_name_text
from mutabot.journal.records import ControlEnd
from mutabot.model import Mutant, Outcome, Verdict

from . import kinds
from .engine import Engine, Remainder, Trial

#: the engine that stands for all of them
AUTO = "auto"


@cache
def all_engines() -> tuple[Engine, ...]:
    """Every engine there is, in the order in which they are asked."""
    names = [module.name for module in pkgutil.iter_modules(kinds.__path__)]
    found: list[Engine] = [importlib.import_module(f"{kinds.__name__}.{name}").ENGINE for name in names]
    return tuple(sorted(found, key=lambda engine: engine.order))


def engines_of(request: Request) -> tuple[Engine, ...]:
    """The engines that a campaign may use, in the order of asking. Raises UsageError if none."""
    found = tuple(engine for engine in all_engines() if request.engine in (AUTO, engine.name))
    if not found:
        names = (AUTO, *(engine.name for engine in all_engines()))
        raise UsageError(unknown_name_text("engine", request.engine, names))
    return found


def first_engine(request: Request) -> Engine:
    """The engine that is asked first."""
    return engines_of(request)[0]


def repetitions_for(request: Request) -> int:
    """How often the baseline runs each round.

    More than an engine needs, if it was asked for: a test that fails at random shows itself the sooner.
    """
    return max(first_engine(request).runs, request.baseline or 0)


def run_mutants(
    campaign: Campaign, mutants: Sequence[Mutant], sink: Sink, done: Collection[tuple[str, int]] = ()
) -> None:
    """Run controls and mutants in all rounds; every outcome is in the journal within a second.

    ``done`` are the ids and rounds that need not be run.

    Raises ControlError for a control that ends wrongly.
    """
    rounds = range(campaign.request.rounds)
    trials = [(mutant, round) for round in rounds for mutant in mutants if (mutant.id, round) not in done]
    run_trials(campaign, trials, sink)


def run_trials(
    campaign: Campaign,
    trials: Sequence[Trial],
    sink: Sink,
    found: Callable[[Outcome], object] | None = None,
    let_through: Collection[tuple[str, int]] = (),
) -> None:
    """Run these mutants in these rounds, with their controls; outcomes are in the journal within a second.

    What ends in a way that counts with the whole suite only goes to ``campaign.again`` instead.

    Args:
        found: told each outcome. Nothing else keeps them: a campaign may have a million.
        let_through: those that were let through without the tests that do not reach them.

    Raises ControlError for a control that ends wrongly.
    """
    left, trials = Remainder(), list(trials)
    report = _Report(campaign, sink, {mutant.id: mutant for mutant, _ in trials}, found, let_through)
    for engine in engines_of(campaign.request):
        if not trials:
            break
        left = Remainder()
        for one in engine.run(campaign, trials, left):
            report.take(one)
        trials = left.all
    for outcome in _refused(trials, left, campaign.request.engine):
        report.take(outcome)


def try_controls(campaign: Campaign, mutants: Sequence[Mutant]) -> tuple[int, Remainder]:
    """Run the controls alone: how many ended as they must, and what the first engine leaves to others.

    Raises ControlError for a control that ends wrongly.
    """
    first, *others = engines_of(campaign.request)
    left = Remainder()
    ended = sum(1 for _ in first.try_controls(campaign, mutants, left))
    rest = mutants if left.trials else [mutant for mutant in mutants if mutant.id in left.why_apart]
    for engine in others:
        if rest:
            ended += sum(1 for _ in engine.try_controls(campaign, rest, Remainder()))
    return ended, left


class _Report:
    """Outcomes and controls on their way to the journal and the screen."""

    def __init__(
        self,
        campaign: Campaign,
        sink: Sink,
        mutants: dict[str, Mutant],
        found: Callable[[Outcome], object] | None,
        let_through: Collection[tuple[str, int]],
    ) -> None:
        self._campaign, self._sink, self._mutants, self._found = campaign, sink, mutants, found
        self._let_through = let_through

    def take(self, found: Outcome | ControlEnd) -> None:
        if isinstance(found, ControlEnd):
            self._sink.journal.add_control(found.test_file, found.control, found.ok, found.detail)
            return
        number = self._mutants[found.mutant].number
        if not self._counts(found):
            self._campaign.again.append(found)
            told = f"{found.verdict}, which the whole suite has yet to say"
            self._campaign.progress.advance(f"#{number} round {found.round + 1}: {told}")
            return
        if (found.mutant, found.round) in self._let_through:
            found = replace(found, confirmed=True)
        self._sink.add_outcome(found)
        if self._found is not None:
            self._found(found)
        by = f" by {found.by}" if found.by is not None else ""
        self._campaign.progress.advance(f"#{number} round {found.round + 1}: {found.verdict}{by}")

    def _counts(self, outcome: Outcome) -> bool:
        """Whether no test was left out whose absence may have made it end like this."""
        if outcome.confirmed is None or outcome.verdict is Verdict.SURVIVED:
            return True
        baseline, trial = self._campaign.baseline, (outcome.round, self._mutants[outcome.mutant])
        first = takewhile(set(baseline.tests_reaching(*trial)).__contains__, baseline.tests_judging(*trial))
        return outcome.verdict is Verdict.REFUSED and outcome.test in list(first)


def _refused(trials: Sequence[Trial], left: Remainder, engine: str) -> Iterator[Outcome]:
    """What no engine that may be used could judge is an error."""
    for mutant, round in trials:
        text = f"it could not be branched: {left.why(mutant) or 'its branch gave no answer'}"
        yield Outcome(mutant.id, round, Verdict.ERROR, message=text, engine=engine)
