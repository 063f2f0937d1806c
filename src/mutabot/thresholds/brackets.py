"""The tests' judgement of each magnitude, and the bracket of a round's threshold.

The detection threshold of a round is the smallest magnitude from which on every magnitude that was run is
noticed. It is known only as a bracket, between the largest magnitude that was missed and the smallest one
that was noticed.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum

from mutabot.frozen import frozen
from mutabot.model import Outcome, Verdict


class MagnitudeResult(StrEnum):
    """The tests' judgement of one magnitude."""

    #: a check, an exception or a time-out ended it
    NOTICED = "noticed"
    #: every test passed, or no test reaches the site
    MISSED = "missed"
    #: the robot would not do it, or a guard let it not, which no test had a hand in
    REFUSED = "refused"
    #: it changed nothing, or the result is unknown
    UNKNOWN = "unknown"

    @property
    def is_valid(self) -> bool:
        """Whether the judgement is valid, that is, says anything about the tests."""
        return self in (MagnitudeResult.NOTICED, MagnitudeResult.MISSED)


def seen(outcome: Outcome) -> MagnitudeResult:
    """Return the judgement of a graded mutant by its outcome in a round."""
    if outcome.verdict in (Verdict.REFUSED, Verdict.GUARDED):
        return MagnitudeResult.REFUSED
    if not outcome.verdict.is_valid:
        return MagnitudeResult.UNKNOWN
    return MagnitudeResult.NOTICED if outcome.verdict.is_killed else MagnitudeResult.MISSED


@frozen
class Bracket:
    """The bracket of one round's threshold: above ``low``, and at most ``high``.

    Attributes:
        low: the largest magnitude that was missed; None if none was.
        high: the smallest magnitude above it that was noticed; None if none was.
        refused: the smallest magnitude above ``low``, and below ``high``, that the robot refused; None if
            none was.
        out_of_order: pairs of a magnitude that was noticed and a larger one that was missed.
    """

    low: float | None = None
    high: float | None = None
    refused: float | None = None
    out_of_order: tuple[tuple[float, float], ...] = ()

    @property
    def is_known(self) -> bool:
        """Whether any judgement is valid."""
        return self.low is not None or self.high is not None

    @property
    def is_violated(self) -> bool:
        """Whether a larger fault was missed where a smaller one was noticed."""
        return bool(self.out_of_order)


def bracket_of(ladder: Mapping[float, MagnitudeResult]) -> Bracket:
    """Return the bracket of a round, from the magnitudes that were run."""
    missed = [size for size, result in ladder.items() if result is MagnitudeResult.MISSED]
    low = max(missed, default=None)
    above = {size: result for size, result in ladder.items() if low is None or size > low}
    high = min((size for size, result in above.items() if result is MagnitudeResult.NOTICED), default=None)
    refused = (
        size
        for size, result in above.items()
        if result is MagnitudeResult.REFUSED and (high is None or size < high)
    )
    noticed = sorted(size for size, result in ladder.items() if result is MagnitudeResult.NOTICED)
    pairs = ((size, larger) for size in noticed for larger in sorted(missed) if larger > size)
    return Bracket(low, high, min(refused, default=None), tuple(pairs))
