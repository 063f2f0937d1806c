"""Plain data that journals hold beside mutants and outcomes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import field
from hashlib import blake2b
from typing import Any

from mutabot.frozen import frozen
from mutabot.model import Outcome, Verdict
from mutabot.model.events import TestEnd
from mutabot.model.operation import Vocabulary
from mutabot.model.outcome_text import same_end
from mutabot.model.suppression import Accepted

#: keys of the journal's meta
DRAWING = "drawing"
#: of how many mutants ``--only`` and ``--skip`` selected those of the campaign; ladders are not counted
SELECTED_OF = "selected_of"
VERIFICATION, FLAKY = "verification", "flaky"
REPEATS = "repeats"
#: whether mutants were run at first without tests that do not reach them
CONFIRMATION = "confirmation"
SINCE, BUDGET = "since", "budget"
SHARD = "shard"
#: what is to be known of the machines that the campaign ran on, a line each
REMARKS = "remarks"
#: the simulation over which the tests ran, if any, and why, in a sentence
SIMULATION, RAN_OVER = "simulation", "ran_over"
#: how a campaign ended of which all has run, but not every outcome is in the journal
INCOMPLETE = "incomplete"
#: descriptions of rows of the journal that something else changed while the campaign ran, and that were
#: restored
ALTERED = "altered"
#: summaries of the operators of the plan by their names, and ``Reaching``
OPERATORS, REACHING, DRAWS = "operators", "reaching", "draws"
#: what no test reaches
UNTESTED = "untested"
#: survivors that are accepted
ACCEPTED = "accepted"


@frozen
class Reaching:
    """The sites that tests reach in any round of the baseline.

    Attributes:
        tests: node ids.
        sites: by the id of a site, the indexes in ``tests`` of those that reach it.
    """

    tests: tuple[str, ...] = ()
    sites: Mapping[str, tuple[int, ...]] = field(default_factory=dict)

    def at(self, site: str) -> tuple[str, ...]:
        """Return the tests that reach a site."""
        return tuple(self.tests[index] for index in sorted(set(self.sites.get(site, ()))))


@frozen
class UntestedCall:
    """A call of an operation in the program that no test reaches, found by its name.

    Attributes:
        place: ``file:line:column``.
        text: what is called, as written.
        operation: target of the operation.
        doubt: why it may be no such call; empty if nothing says so.
    """

    place: str
    text: str
    operation: str
    doubt: str = ""

    @property
    def description(self) -> str:
        """``cell/b.py:2:5 belt.drive``, with the doubt."""
        return f"{self.place} {self.text}" + (f" ({self.doubt})" if self.doubt else "")


@frozen
class Untested:
    """The parts of the program that no test reaches in any round.

    Attributes:
        calls: number of calls of operations, those that are in doubt left out.
        functions: number of functions; 0 if it is not known which are called.
        files: number of files that hold any code.
        unreached_calls: those that no test reaches.
        unreached_functions: the same, as ``file:line name``.
        unreached_files: files that no test imports.
        doubtful_calls: calls of an operation's name that no test reaches, and which may be something else.
    """

    calls: int = 0
    functions: int = 0
    files: int = 0
    unreached_calls: tuple[UntestedCall, ...] = ()
    unreached_functions: tuple[str, ...] = ()
    unreached_files: tuple[str, ...] = ()
    doubtful_calls: tuple[UntestedCall, ...] = ()

    @property
    def text(self) -> str:
        """``3 of 7 robot calls and 1 of 4 files are reached by no test``; empty if all are reached."""
        kinds = (
            (self.unreached_calls, self.calls, "robot call"),
            (self.unreached_functions, self.functions, "function"),
            (self.unreached_files, self.files, "file"),
        )
        parts = [
            f"{len(those)} of {total} {name}{'s' if total != 1 else ''}"
            for those, total, name in kinds
            if those
        ]
        if not parts:
            return ""
        *first, last = parts
        counted = f"{', '.join(first)} and {last}" if first else last
        is_one = len(parts) == 1 and sum(len(those) for those, _, _ in kinds) == 1
        return f"{counted} {'is' if is_one else 'are'} reached by no test"

    @property
    def named(self) -> dict[str, tuple[str, ...]]:
        """What no test reaches, by name, grouped by kind."""
        calls, doubtful = (
            tuple(call.description for call in those) for those in (self.unreached_calls, self.doubtful_calls)
        )
        found = {
            "files that no test imports": self.unreached_files,
            "functions": self.unreached_functions,
            "robot calls, found by name": calls,
            "may be robot calls, not counted": doubtful,
        }
        return {what: those for what, those in found.items() if those}


@frozen
class BaselineTest:
    """A test of the baseline.

    Attributes:
        round: 0-based round.
        repetition: 0-based repetition of that round.
        test: how it ended and what it took. Mutants were compared with what it did; it is not needed later.
    """

    round: int
    repetition: int
    test: TestEnd

    @classmethod
    def of(cls, round: int, repetition: int, end: TestEnd) -> BaselineTest:
        """Return what the journal keeps of the end of a test."""
        return cls(round, repetition, TestEnd(end.test, end.outcome, wall=end.wall, simulated=end.simulated))


@frozen
class OriginalRun:
    """A run of the suite on the original.

    Attributes:
        task: what was run, as a digest.
        exit_code, wall: as in ``Result``.
        events: what its process reported: the lines of a file of events, compressed.
    """

    task: str
    exit_code: int
    wall: float
    events: bytes = b""


@frozen
class KeptBaseline:
    """The runs of the original with which a campaign began.

    Attributes:
        depends: what they depend on, as a digest.
        taken: when they were made, in seconds since 1970; the first of them, if not all at once.
        opened: the files that were opened meanwhile; None if that is not known.
        runs: in the order in which they were made.
    """

    depends: str
    taken: float
    opened: tuple[str, ...] | None = None
    runs: tuple[OriginalRun, ...] = ()


@frozen
class Kept:
    """An outcome of an earlier campaign.

    Attributes:
        mutant, round, verdict: as in the outcome.
        key: what it depends on.
        is_sound: whether it says anything about the mutant, and not about the tool or the machine.
        data: the outcome as JSON; empty where it was not asked for.
    """

    mutant: str
    round: int
    verdict: Verdict
    key: str
    is_sound: bool = True
    data: str = ""


@frozen
class ControlEnd:
    """How a control mutant ended.

    Attributes:
        test_file: the test file it was run for.
        control: ``identity`` or ``fatal``.
        ok: whether it passed.
        detail: one line about how it ended.
    """

    test_file: str
    control: str
    ok: bool
    detail: str


@frozen
class Stratum:
    """The mutants of one family and role, of which some were drawn.

    Attributes:
        family, role: which.
        population: how many there were.
        drawn: how many were drawn.
    """

    family: str
    role: str
    population: int
    drawn: int


@frozen
class Drawing:
    """How the mutants of a campaign were drawn from the selected ones.

    Attributes:
        sample: the size that was asked for.
        selected: how many mutants there were before anything was drawn.
        strata: one per family and role; the population is what the sample was drawn from.
    """

    sample: str
    selected: int
    strata: tuple[Stratum, ...]

    def stratum(self, family: str, role: str) -> Stratum | None:
        """Return the stratum of a family in a role."""
        return next(
            (stratum for stratum in self.strata if (stratum.family, stratum.role) == (family, role)), None
        )


@frozen
class Since:
    """The mutants that a campaign ran of those changed since a revision; counts are of mutants in rounds.

    Attributes:
        ref, commit: the revision as it was named, and its commit.
        run: how many were run, by the reason.
        taken_over: how many were taken over.
        not_judged: how many were neither, by the reason.
    """

    ref: str
    commit: str
    run: Mapping[str, int] = field(default_factory=dict)
    taken_over: int = 0
    not_judged: Mapping[str, int] = field(default_factory=dict)


@frozen
class Budgeted:
    """How a campaign used its limited time.

    Attributes:
        seconds: the time it was given.
        planned: how many outcomes were to be found in it.
        run: how many of these were found in batches that ended in time.
        cut_off: how many were found in the batch that was cut off, in which kills end before survivors.
        is_whole: whether everything was run; None while that is not known.
    """

    seconds: float
    planned: int
    run: int = 0
    cut_off: int = 0
    is_whole: bool | None = None


@frozen
class ShardOf:
    """The part of its plan that a campaign has run.

    Attributes:
        number: 1-based number of the shard.
        of: how many shards there are.
        mutants: the numbers of its mutants; the plan holds all.
        depends: all that outcomes depend on, by name; None if files changed during the baseline.
    """

    number: int
    of: int
    mutants: tuple[int, ...]
    depends: Mapping[str, str] | None = None

    @property
    def text(self) -> str:
        """``shard 2 of 8``."""
        return f"shard {self.number} of {self.of}"


@frozen
class Disagreement:
    """An outcome that changed in a fresh process.

    Attributes:
        mutant, number: id and number of the mutant.
        round: 0-based round.
        first, second: descriptions of how it ended in the campaign and in the fresh process.
    """

    mutant: str
    number: int
    round: int
    first: str
    second: str


@frozen
class Verification:
    """The results of ``--verify``.

    Attributes:
        wanted: how many outcomes were to be looked at.
        checked: how many were; fewer if the campaign has no more that any test was run for.
        disagreements: those that came out otherwise.
    """

    wanted: int
    checked: int
    disagreements: tuple[Disagreement, ...] = ()

    @property
    def agreed(self) -> int:
        """The number of outcomes that did not change."""
        return self.checked - len(self.disagreements)


@frozen
class Flaky:
    """Flaky tests, which differ between equal runs of the original, or fail in some round.

    Attributes:
        tests: one line each: test, round and reason.
        known: number of (test, round) that could have been.
    """

    tests: tuple[str, ...] = ()
    known: int = 0

    @property
    def share(self) -> float:
        """The share of tests that are flaky."""
        return len(self.tests) / self.known if self.known else 0.0

    def text(self, limit: float) -> str:
        """Return why there are too many flaky tests."""
        shown = "".join(f"\n  {line}" for line in self.tests[:10])
        more = f"\n  … and {len(self.tests) - 10} more" if len(self.tests) > 10 else ""
        counts = f"{len(self.tests)} of {self.known} tests cannot be relied on ({self.share:.0%})"
        return f"{counts}; the limit is {limit:.0%} (unstable_limit):{shown}{more}"


def run_short(outcomes: Iterable[Outcome], seed: int) -> list[Outcome]:
    """Return outcomes found without some tests, even if confirmed by the whole suite since, in random order.

    The order depends on the seed and each outcome's mutant and round only, so the first of them are a random
    sample, whatever becomes of the others.
    """
    found = (
        outcome for outcome in outcomes if outcome.confirmed is not None and outcome.verdict not in _NOTHING
    )
    return sorted(
        found, key=lambda outcome: blake2b(f"{seed}:{outcome.round}:{outcome.mutant}".encode()).digest()
    )


#: outcomes that say nothing about what the whole suite does
_NOTHING = frozenset({Verdict.ERROR, Verdict.UNSTABLE})
#: verdicts of what is let through without the tests that do not reach it
LET_THROUGH = frozenset({Verdict.SURVIVED, Verdict.REFUSED})


def is_wrong(outcome: Outcome) -> bool:
    """Return whether the whole suite noticed a mutant that survived without some tests."""
    return bool(outcome.confirmed) and outcome.verdict not in LET_THROUGH | _NOTHING


@frozen
class Replayed:
    """A repeated run of one mutant in one round.

    Attributes:
        round: 0-based round.
        first: its outcome in the journal; None if it has none.
        second: its outcome now.
    """

    round: int
    first: Outcome | None
    second: Outcome

    @property
    def agrees(self) -> bool | None:
        """Whether both ended alike; None if there is nothing to compare with."""
        return None if self.first is None else same_end(self.first, self.second)


@frozen
class Repeated:
    """Outcomes of one kind, and how their repeats ended.

    Attributes:
        outcomes: how many there were before any was repeated.
        repeated: how many of them were run once more.
        changed: how many of these ended otherwise.
    """

    outcomes: int = 0
    repeated: int = 0
    changed: int = 0

    @property
    def left(self) -> int:
        """The number of outcomes that were not repeated."""
        return self.outcomes - self.repeated


@frozen
class Repeats:
    """What repeats show about false kills and false survivors.

    Attributes:
        doubted: kills that may be chance.
        others: kills that are not in doubt, by tests that are not known to be deterministic.
        certain: number of kills by deterministic tests, and of those that earlier campaigns repeated.
        survivors: mutants that survived.
    """

    doubted: Repeated = Repeated()
    others: Repeated = Repeated()
    certain: int = 0
    survivors: Repeated = Repeated()


#: the types of facts that are shown as they are
PLAIN: Mapping[str, Any] = {
    "mutabot": str,
    "python": str,
    "versions": Mapping[str, str],
    "root": str,
    "seed": int,
    "rounds": int,
    "engine": str,
    "jobs": int,
    "families": tuple[str, ...],
    "every_test": bool,
    "fresh": bool,
    "started": float,
    "seconds": float,
    "shards": int,
    SELECTED_OF: int,
    SIMULATION: str,
    RAN_OVER: str,
    REMARKS: tuple[str, ...],
}


#: the types of all facts that are read as they are
FACTS: Mapping[str, Any] = {
    **PLAIN,
    ALTERED: tuple[str, ...],
    OPERATORS: Mapping[str, str],
    DRAWS: tuple[str, ...],
    DRAWING: Drawing,
    VERIFICATION: Verification,
    FLAKY: Flaky,
    REPEATS: Repeats,
    CONFIRMATION: bool,
    SINCE: Since,
    BUDGET: Budgeted,
    SHARD: ShardOf,
    REACHING: Reaching,
    UNTESTED: Untested,
    ACCEPTED: Accepted,
    "vocabulary": Vocabulary,
}
