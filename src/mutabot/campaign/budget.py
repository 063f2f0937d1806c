"""The budget of a campaign: what tells most first, in batches, and an end in time.

Among those that are expected to tell alike much the order is random: it depends on the seed and the mutants'
ids alone. A batch is as much as is expected to end in half of the time that is left. It shares its trunks, so
few large ones are better than many; that the time is up in the midst of one is unlikely to cost much, since
batches get smaller towards the end.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from mutabot.campaign.campaign import Campaign, Sink
from mutabot.campaign.engines.choice import run_trials
from mutabot.campaign.engines.confirmation import confirm
from mutabot.campaign.engines.engine import Trial
from mutabot.campaign.faults.demanded import apart
from mutabot.campaign.plan import shuffled
from mutabot.campaign.reuse.reuse import Reused
from mutabot.campaign.search import run_ladders
from mutabot.config.options import in_words
from mutabot.execution.interruption import OutOfTimeError, limited
from mutabot.journal.records import BUDGET, Budgeted
from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.codec import to_data

Pair = tuple[str, int]


def in_order(
    mutants: Sequence[Mutant],
    rounds: int,
    done: Iterable[Pair],
    seed: int,
    before: Mapping[Pair, Verdict],
    sites: Collection[str],
) -> list[Trial]:
    """All that is not done, what is expected to tell most first; one round after the other.

    Args:
        before: what outcomes were that do not hold any more.
        sites: mutants, by id, at which something else stands than when they were run.
    """
    done = set(done)
    firsts = _one_per_site(mutants, seed)

    def rank(trial: Trial) -> int:
        mutant, round = trial
        return _rank(before.get((mutant.id, round)), mutant.id in sites, mutant.id in firsts)

    found: list[Trial] = []
    for round in range(rounds):
        at_random = shuffled(mutants, f"{seed}:budget:{round}")
        left = [(mutant, round) for mutant in at_random if (mutant.id, round) not in done]
        found += sorted(left, key=rank)
    return found


def _rank(before: Verdict | None, is_changed: bool, is_first: bool) -> int:
    """Never run before, survivors, at changed sites, the rest; of the first and last one per site first."""
    if before is None:
        return 0 if is_first else 1
    if before.is_valid and not before.is_killed:
        return 2
    if is_changed:
        return 3
    return 4 if is_first else 5


def _one_per_site(mutants: Sequence[Mutant], seed: int) -> set[str]:
    chosen: dict[tuple[str, object], str] = {}
    for mutant in shuffled(mutants, f"{seed}:site"):
        chosen.setdefault((mutant.family, mutant.site), mutant.id)
    return set(chosen.values())


#: the share of the time left that a batch may take, and that of the first, whose cost is a guess
_SHARE, _FIRST = 0.5, 0.2
#: a batch is to cost so many times what its trunks do, if that takes no more than this share of the time left
_WORTH, _MOST = 4.0, 0.8
#: a mutant ends in the midst of its tests, mostly: the share of their time that is expected of the first
_GUESS = 0.6


@dataclass(slots=True)
class Batches:
    """Batches of trials, sized by what those before have cost.

    Attributes:
        campaign: the campaign.
        until: when all must have ended, by ``Request.clock``.
    """

    campaign: Campaign
    until: float
    _factor: float = field(init=False)
    _is_measured: bool = field(init=False, default=False)

    def __post_init__(self) -> None:
        self._factor = _GUESS / self.campaign.request.jobs

    @property
    def left(self) -> float:
        """Seconds that are left."""
        return self.until - self.campaign.request.clock()

    def size(self, trials: Sequence[Trial]) -> int:
        """How many of these, from the first on, to run at once; 0 if not even one would end in time."""
        left = self.left
        wanted = left * (_SHARE if self._is_measured else _FIRST)
        rounds: set[int] = set()
        count, cost = 0, 0.0
        for mutant, round in trials:
            rounds.add(round)
            cost += self._most(mutant, round) * self._factor
            trunks = self._trunks(rounds)
            if cost + trunks > max(wanted, min(_WORTH * trunks, _MOST * left)) and count:
                return count
            if cost + trunks > left:
                return 0
            count += 1
        return count

    def took(self, trials: Sequence[Trial], seconds: float) -> None:
        """Learn from a batch what they really cost."""
        whole = sum(self._most(mutant, round) for mutant, round in trials)
        if whole > 0:
            trunks = self._trunks({round for _, round in trials})
            self._factor = max(seconds - trunks, 0.1 * seconds) / whole
            self._is_measured = True

    def _most(self, mutant: Mutant, round: int) -> float:
        """What the tests of a mutant take that survives."""
        return self._wall(round, self.campaign.baseline.tests_judging(round, mutant))

    def _wall(self, round: int, tests: Iterable[str]) -> float:
        return sum(max(self.campaign.baseline.ends[round, test].wall, 1e-3) for test in tests)

    def _trunks(self, rounds: set[int]) -> float:
        """What it takes to run the suite once more as the original in these rounds, and to begin."""
        baseline = self.campaign.baseline
        wall = sum(self._wall(round, baseline.suite(round)) for round in rounds)
        return wall / self.campaign.request.jobs + baseline.startup


def run_in_batches(
    batches: Batches,
    trials: Sequence[Trial],
    run: Callable[[Sequence[Trial]], None],
    ended: Callable[[int], None],
) -> bool:
    """Run trials in this order; returns whether all were run.

    Args:
        run: runs some of them, all at once.
        ended: told after each batch how many have been run until then.
    """
    done = 0
    while done < len(trials):
        size = batches.size(trials[done:])
        if size == 0:
            return False
        batch = trials[done : done + size]
        began = batches.left
        run(batch)
        batches.took(batch, began - batches.left)
        done += size
        ended(done)
    return True


#: how a campaign ended whose budget was not enough
OUT_OF_TIME = "out of time"


def run_within(
    campaign: Campaign, mutants: Sequence[Mutant], sink: Sink, found: Reused, until: float
) -> bool:
    """Run what can be run until then; returns whether that is all.

    What is under way when the time is up is cut off, and nothing is said of it. Ladders come last.

    Args:
        found: what is known before.
        until: when all must have ended, by ``Request.clock``.
    """
    request, progress = campaign.request, campaign.progress
    alone, ladders = apart(mutants)
    trials = in_order(alone, request.rounds, found.done, request.seed, found.before, found.sites)
    seconds = request.budget or 0.0
    budgeted = Budgeted(seconds, planned=len(trials))
    progress.note(f"budget: {in_words(seconds)}, of which {max(until - request.clock(), 0.0):.0f} s are left")
    batches = Batches(campaign, until)
    told = 0

    def take(_: Outcome) -> None:
        nonlocal told
        told += 1

    def note(run: int, is_whole: bool | None = None) -> None:
        nonlocal budgeted
        budgeted = replace(budgeted, run=run, cut_off=told - run, is_whole=is_whole)
        sink.journal.set_meta(BUDGET, to_data(budgeted))

    def ended(run: int) -> None:
        note(run - len(campaign.again))

    note(0)
    try:
        with limited(until, request.clock):
            is_whole = run_in_batches(
                batches, trials, lambda batch: run_trials(campaign, batch, sink, take), ended
            )
            if is_whole:
                confirm(campaign, alone, sink, found.done)
                run_ladders(campaign.whole, ladders, sink, found.done)
    except OutOfTimeError:
        is_whole = False
    told = len(trials) if is_whole else told
    note(told if is_whole else budgeted.run, is_whole)
    if not is_whole:
        run = f"{budgeted.run + budgeted.cut_off} of {budgeted.planned} outcomes were found"
        progress.note(f"the budget is spent: {run}; `mutabot run` goes on with what is left")
    return is_whole
