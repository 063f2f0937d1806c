"""Which kills may be mere chance: those by tests that cannot be known to end alike in equal runs.

A test in simulated time whose runs of the original are equal to the last bit is taken to be deterministic. Of
any other test a kill is in doubt if the test is known to be unreliable, or if it kills so few of the mutants
that it judges that it might do so by failing at random. A survivor is in doubt where its operator leaves to
chance what happens.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.taking import FAILS
from mutabot.campaign.faults.providers import provider
from mutabot.model import Mutant, Outcome, Verdict

#: a mutant in a round
Key = tuple[str, int]
#: so many kills of a test, or this share of what it judges, could be failures at random
_FEW, _SHARE = 2, 0.1


@dataclass(slots=True)
class Doubts:
    """What is in doubt in a campaign.

    Attributes:
        baseline: what is known about the tests.
        mutants: by id.
        outcomes: by mutant and round.
        unreliable: tests that have been seen to end otherwise in equal runs, in any round.
    """

    baseline: Baseline
    mutants: Mapping[str, Mutant]
    outcomes: Mapping[Key, Outcome]
    unreliable: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.unreliable.update(self.baseline.doubted, (test for _, test in self.baseline.unequal))
        self.unreliable.update(
            test for (_, test), why in self.baseline.unstable.items() if not why.startswith(FAILS)
        )

    def kills(self) -> list[Key]:
        """All kills by a test that ended."""
        return [key for key, one in self.outcomes.items() if one.verdict is Verdict.KILLED and one.test]

    def in_doubt(self) -> list[Key]:
        """The kills that may be chance and have not been repeated yet."""
        kills = [key for key in self.kills() if not self.outcomes[key].repeats]
        few = self._few_lone_kills()
        return [key for key in kills if self._test(key) in self.unreliable or key in few]

    def raced(self) -> list[Key]:
        """Kills and survivors whose operator leaves to chance what happens, not repeated yet."""
        return [
            key
            for key, one in self.outcomes.items()
            if one.verdict in (Verdict.KILLED, Verdict.SURVIVED) and not one.repeats
            if self._is_raced(self.mutants[key[0]])
        ]

    def _is_raced(self, mutant: Mutant) -> bool:
        return provider(mutant.provider).is_raced(mutant.operator)

    def is_certain(self, key: Key) -> bool:
        """Whether a kill was repeated before, or is one by a test that is taken to be deterministic."""
        test = self._test(key)
        if self.outcomes[key].repeats:
            return True
        return test not in self.unreliable and self._has_clock(test, key[1])

    def _few_lone_kills(self) -> set[Key]:
        """Kills of a mutant in one round alone, by a test without a clock that has few such kills."""
        times = Counter((mutant, self._test((mutant, round))) for mutant, round in self.kills())
        lone: dict[str, list[Key]] = {}
        for key in self.kills():
            test = self._test(key)
            if times[key[0], test] == 1 and not self._has_clock(test, key[1]):
                lone.setdefault(test, []).append(key)
        judged = self._judged(lone)
        return {
            key
            for test, keys in lone.items()
            if len(keys) < judged[test] and len(keys) <= max(_FEW, _SHARE * judged[test])
            for key in keys
        }

    def _judged(self, tests: Iterable[str]) -> Counter[str]:
        """How many outcomes each of these tests has had a say in."""
        counts: Counter[str] = Counter()
        wanted = set(tests)
        for key, outcome in self.outcomes.items() if wanted else ():
            counts.update(wanted.intersection(self._judging(key, outcome)))
        return counts

    def _judging(self, key: Key, outcome: Outcome) -> list[str]:
        """The tests that have had a say in an outcome: of those that ran, all that reach the mutant."""
        judges = self.baseline.tests_reaching(key[1], self.mutants[key[0]])
        return [test for test in self._ran(key, outcome) if test in judges or test == outcome.test]

    def _ran(self, key: Key, outcome: Outcome) -> tuple[str, ...]:
        suite = self.baseline.suite(key[1])
        if outcome.test in suite and not outcome.complete:
            return suite[: suite.index(outcome.test) + 1]
        return suite if outcome.tests else ()

    def cost(self, key: Key) -> float:
        """Seconds that the tests of a repeat take on the original."""
        ends, round = self.baseline.ends, key[1]
        return sum(ends[round, test].wall for test in self._ran(key, self.outcomes[key]))

    def _test(self, key: Key) -> str:
        return self.outcomes[key].test or ""

    def _has_clock(self, test: str, round: int) -> bool:
        end = self.baseline.ends.get((round, test))
        return end is not None and end.simulated is not None
