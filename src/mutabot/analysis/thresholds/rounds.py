"""What became of one ladder in one round: its bracket, how it ended above, and whether the round counts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from enum import StrEnum

from mutabot.frozen import frozen
from mutabot.model import By, Outcome, Verdict
from mutabot.model.graded import Bracket, Seen, bracket_of, seen

#: what ends a ladder without a word about the tests
_NOTHING_THERE = frozenset({Verdict.NO_EFFECT, Verdict.INVALID})


class Above(StrEnum):
    """What is above the largest magnitude that was missed."""

    NOTICED = "noticed"
    LARGEST = "missed up to the largest"
    REFUSED = "refused"
    NO_EFFECT = "no effect"
    #: it was not run, or nobody knows
    OPEN = "open"


@frozen
class LadderRound:
    """One ladder in one round.

    Attributes:
        number: 0-based round.
        outcomes: by magnitude, rising, those that were run.
        zero: the outcome of magnitude 0; None if it was not run.
        bracket: where the threshold lies.
        above: what is above the largest magnitude that was missed.
    """

    number: int
    outcomes: Mapping[float, Outcome]
    zero: Outcome | None
    bracket: Bracket
    above: Above

    @classmethod
    def of(
        cls, number: int, sizes: Sequence[float], outcomes: Mapping[float, Outcome], zero: Outcome | None
    ) -> LadderRound:
        """From the planned magnitudes above 0, rising, and the outcomes of those that were run."""
        bracket = bracket_of({size: seen(one) for size, one in outcomes.items()})
        if any(one.verdict is Verdict.NOT_COVERED for one in outcomes.values()):
            bracket = Bracket(low=sizes[-1])  # what no test reaches, none reaches at any magnitude
        return cls(number, outcomes, zero, bracket, _above(bracket, sizes, outcomes))

    @property
    def fails_without_fault(self) -> bool:
        """Whether the tests fail at magnitude 0, so that nothing they notice is due to the fault."""
        return self.zero is not None and seen(self.zero) is Seen.NOTICED

    @property
    def is_reached(self) -> bool:
        """Whether a test reaches the site."""
        return not any(one.verdict is Verdict.NOT_COVERED for one in self.outcomes.values())

    @property
    def why_out(self) -> str:
        """Why the round does not count; empty if it does."""
        if self.fails_without_fault:
            return "fails without a fault"
        if not self.outcomes:
            return "was not run"
        if not self.bracket.is_known:
            return _without_valid(self.outcomes)
        if self.above is Above.OPEN:
            return "is not judged to the end of the ladder"
        return ""

    @property
    def counts(self) -> bool:
        """Whether it says something about the tests."""
        return not self.why_out

    @property
    def noticed_by(self) -> str | None:
        """Who notices at the upper end of the bracket: ``check``, ``exception`` or ``timeout``."""
        return noticer(self.outcomes[self.bracket.high]) if self.bracket.high is not None else None


def noticer(outcome: Outcome) -> str | None:
    """Who noticed a fault: ``check``, ``exception`` or ``timeout``; None if nobody did."""
    if outcome.verdict is Verdict.TIMEOUT:
        return Verdict.TIMEOUT.value
    return (outcome.by or By.EXCEPTION).value if outcome.verdict is Verdict.KILLED else None


def _above(bracket: Bracket, sizes: Sequence[float], outcomes: Mapping[float, Outcome]) -> Above:
    if bracket.high is not None:
        return Above.NOTICED
    above = [size for size in sizes if bracket.low is None or size > bracket.low]
    if not above:
        return Above.LARGEST
    if bracket.refused is not None:
        return Above.REFUSED
    # the next one tells: what changes nothing there is beyond what the robot takes
    ends = list(_verdicts(above, outcomes))
    return Above.NO_EFFECT if ends and set(ends) <= _NOTHING_THERE and above[0] in outcomes else Above.OPEN


def _verdicts(sizes: Sequence[float], outcomes: Mapping[float, Outcome]) -> Iterator[Verdict]:
    return (outcomes[size].verdict for size in sizes if size in outcomes)


def _without_valid(outcomes: Mapping[float, Outcome]) -> str:
    verdicts = {one.verdict for one in outcomes.values()}
    for verdict, words in _WORDS.items():
        if verdict in verdicts:
            return words
    return "says nothing"


#: why nothing is known of a round, the worst first
_WORDS = {
    Verdict.ERROR: "ended in error",
    Verdict.UNSTABLE: "is unstable",
    Verdict.REFUSED: "the robot refuses every magnitude that was tried",
    Verdict.NO_EFFECT: "has no effect",
    Verdict.INVALID: "is invalid",
}
