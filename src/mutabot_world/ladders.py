"""How disturbances ended: whether the tests noticed them, and whether the task was done nevertheless.

Two questions, which one number never answers together. A disturbance that no test notices is *lived with* if
the world ended as it does without, and *suffered unseen* if it did not.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import takewhile
from typing import Any

from mutabot.api.reports import Results, Verdict

from .extension import PROVIDER
from .units import with_unit


class WorldEnd(StrEnum):
    """How a disturbance ended. For several tests or rounds the first of these values that occurs counts."""

    NOTICED = "noticed"
    UNSEEN = "suffered unseen"
    #: all tests pass, and it is unknown how the world ended
    PASSED = "passed"
    LIVED = "lived with"
    #: it disturbed nothing, or the result is unknown
    UNKNOWN = "not known"


#: differences at the end that count as none, by unit; beside those that the vocabulary and the original give
Tolerances = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class JudgedOutcome:
    """How a disturbance ended in a round, what happened, and whether a stop, not a check, noticed it."""

    end: WorldEnd
    story: str = ""
    is_stop: bool = False


def judge(outcome: Any, tolerances: Tolerances) -> JudgedOutcome:
    """Return how a disturbance ended in a round, derived from its outcome."""
    story = outcome.shown_difference.story if outcome.shown_difference is not None else ""
    if outcome.verdict.is_killed:
        error = f"{outcome.exception.rpartition(':')[2]}: {outcome.message}" if outcome.exception else ""
        first = (error or outcome.message or "").split("\n")[0]
        return JudgedOutcome(
            WorldEnd.NOTICED, "; ".join(filter(None, (story, first))), str(outcome.by or "") != "check"
        )
    if outcome.verdict is not Verdict.SURVIVED:
        why = next(iter(outcome.away), None) or outcome.message or str(outcome.verdict)
        return JudgedOutcome(WorldEnd.UNKNOWN, why.split("\n")[0])
    apart = [part for each in outcome.diverged for part in each.apart if not part.is_value]
    if apart:
        is_off = any(
            part.final > tolerances.get(part.unit, max(part.tolerance, part.spread)) for part in apart
        )
        return JudgedOutcome(WorldEnd.UNSEEN if is_off else WorldEnd.LIVED, story)
    if outcome.indistinguishable or (outcome.distance is not None and outcome.distance <= 1.0):
        return JudgedOutcome(WorldEnd.LIVED, story)
    if outcome.distance is None:
        return JudgedOutcome(WorldEnd.PASSED, next(iter(outcome.gaps), "no probe shows how the world ended"))
    return JudgedOutcome(WorldEnd.UNSEEN, story or next(iter(outcome.divergence), ""))


@dataclass(slots=True)
class WorldLadder:
    """The results of one parameter disturbed in one direction, in one test or in all tests.

    Attributes:
        parameter: its name.
        direction: ``+``, ``-``, or empty.
        unit: of the magnitudes.
        tests: node ids of the tests.
        found: by magnitude, rising, and round, what became of it in each test.
        texts: descriptions of the disturbance, by magnitude.
        numbers: the mutants' numbers, by magnitude and test.
    """

    parameter: str
    direction: str
    unit: str | None
    tests: tuple[str, ...]
    found: dict[float, dict[int, dict[str, JudgedOutcome]]] = field(default_factory=dict)
    texts: dict[float, str] = field(default_factory=dict)
    numbers: dict[tuple[float, str], int] = field(default_factory=dict)

    def end(self, size: float) -> WorldEnd:
        """Return how a magnitude ended: noticed only if so in every round, suffered unseen if so in any."""
        rounds = [combined_end(each.values()) for each in self.found[size].values()]
        known = [end for end in rounds if end is not WorldEnd.UNKNOWN]
        if not known:
            return WorldEnd.UNKNOWN
        others = [other_end for other_end in known if other_end is not WorldEnd.NOTICED]
        return min(others, key=[*WorldEnd].index) if others else WorldEnd.NOTICED

    def is_sometimes_noticed(self, size: float) -> bool:
        """Return whether some rounds notice a magnitude and others do not."""
        ends = {combined_end(each.values()) for each in self.found[size].values()} - {WorldEnd.UNKNOWN}
        return WorldEnd.NOTICED in ends and len(ends) > 1

    @property
    def ends(self) -> dict[float, WorldEnd]:
        """How each magnitude ended, in ascending order; magnitudes without a result are left out."""
        ends = {size: self.end(size) for size in sorted(self.found)}
        return {size: end for size, end in ends.items() if end is not WorldEnd.UNKNOWN}

    @property
    def noticed_from(self) -> float | None:
        """The magnitude from which all are noticed in every round; None if there is none."""
        noticed = takewhile(lambda pair: pair[1] is WorldEnd.NOTICED, reversed(self.ends.items()))
        return min((size for size, _ in noticed), default=None)

    @property
    def missed(self) -> list[float]:
        """The magnitudes that at least one round does not notice."""
        return [size for size, end in self.ends.items() if end is not WorldEnd.NOTICED]

    @property
    def unseen(self) -> list[float]:
        """The magnitudes that are suffered unseen in at least one round."""
        return [size for size, end in self.ends.items() if end is WorldEnd.UNSEEN]

    @property
    def robust_to(self) -> float | None:
        """The largest magnitude that is lived with, as are all smaller ones; None if the smallest is not."""
        lived = takewhile(lambda pair: pair[1] is WorldEnd.LIVED, self.ends.items())
        return max((size for size, _ in lived), default=None)

    @property
    def robust(self) -> str:
        """The magnitude ``robust_to`` as text, or why there is none."""
        if self.robust_to is not None:
            return self._amount(self.robust_to)
        is_known = next(iter(self.ends.values()), WorldEnd.PASSED) is not WorldEnd.PASSED
        return "not even the least" if is_known else "not known"

    @property
    def bar(self) -> str:
        """The ladder as a string with one character per magnitude."""
        signs = dict(zip(WorldEnd, "█!?· ", strict=True))
        ends = ((size, self.end(size)) for size in sorted(self.found))
        return "".join("▒" if self.is_sometimes_noticed(size) else signs[end] for size, end in ends)

    def story(self, size: float, end: WorldEnd) -> tuple[str, str]:
        """Return what happened at a magnitude that ended so, and in which test; empty if not recorded."""
        for round in sorted(self.found[size]):
            for test, outcome in self.found[size][round].items():
                if outcome.end is end and outcome.story:
                    return outcome.story, test
        return "", ""

    @property
    def why_unknown(self) -> str:
        """Why no result is known for any magnitude; empty if one is."""
        if self.ends:
            return ""
        rounds = (tests for each in self.found.values() for tests in each.values())
        return next(
            filter(None, (outcome.story for tests in rounds for outcome in tests.values())), "not run"
        )

    @property
    def sentence(self) -> str:
        """A sentence on what the tests notice."""
        if not self.ends:
            return f"nothing is known of {self.parameter}: {self.why_unknown}"
        first, largest, missed = self.noticed_from, max(self.ends), self.missed
        if first is None:
            noticed = [size for size, end in self.ends.items() if end is WorldEnd.NOTICED]
            beside = f", though they notice {self._amount(noticed[0])}" if noticed else ""
            return f"your tests do not notice {self.texts[largest]}, the most that was tried{beside}"
        if not missed:
            return f"your tests notice {self.texts[first]}, the least that was tried"
        return f"your tests notice {self.texts[first]}, not one of {self._amount(missed[-1])}"

    @property
    def finding(self) -> str:
        """A sentence on what is suffered unseen; empty if nothing is."""
        if not self.unseen:
            return ""
        story, test = self.story(self.unseen[-1], WorldEnd.UNSEEN)
        where = f" ({test.rpartition('::')[2]}, mutant {self.numbers[self.unseen[-1], test]})" if test else ""
        return f"suffered unseen at {self.span(self.unseen)}{f': {story}' if story else ''}{where}"

    def span(self, sizes: Sequence[float]) -> str:
        """Return the first and the last magnitude as text: ``0.1 kg``, ``0.1 kg to 2 kg``."""
        return " to ".join(map(self._amount, dict.fromkeys((sizes[0], sizes[-1]))))

    def _amount(self, size: float) -> str:
        return with_unit(size, self.unit)


def combined_end(found: Iterable[JudgedOutcome]) -> WorldEnd:
    """Return how a disturbance ended in a round, combined over the tests."""
    ends = {outcome.end for outcome in found}
    return next((end for end in WorldEnd if end in ends), WorldEnd.UNKNOWN)


def ladders(results: Results, tolerances: Tolerances) -> list[WorldLadder]:
    """Return a ladder for each parameter, direction and test, in the order of the plan."""
    found: dict[tuple[str, str, str], WorldLadder] = {}
    for result in results.graded:
        mutant = result.mutant
        if mutant.provider != PROVIDER:
            continue
        test, name = mutant.site.span.file, mutant.site.text
        ladder = found.setdefault(
            (name, mutant.direction, test), WorldLadder(name, mutant.direction, mutant.unit, (test,))
        )
        size = mutant.magnitude or 0.0
        ladder.texts[size], ladder.numbers[size, test] = mutant.description, mutant.number
        rounds = ladder.found.setdefault(size, {})
        for outcome in result.outcomes:
            rounds.setdefault(outcome.round, {})[test] = judge(outcome, tolerances)
    return list(found.values())


def combined_ladders(found: Sequence[WorldLadder]) -> list[WorldLadder]:
    """Return a ladder for each parameter and direction that combines all tests.

    Those come first that are suffered unseen, the loosest of them before others.
    """
    whole: dict[tuple[str, str], WorldLadder] = {}
    for ladder in found:
        key = ladder.parameter, ladder.direction
        before = whole.get(key) or WorldLadder(ladder.parameter, ladder.direction, ladder.unit, ())
        whole[key] = before
        before.tests += ladder.tests
        before.texts |= ladder.texts
        before.numbers |= ladder.numbers
        for size, rounds in ladder.found.items():
            whole_size = before.found.setdefault(size, {})
            for round, tests in rounds.items():
                whole_size.setdefault(round, {}).update(tests)
    return sorted(
        whole.values(), key=lambda combined: (not combined.unseen, combined.noticed_from is not None)
    )
