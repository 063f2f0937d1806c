"""Ends: what became of a mutant, told apart further than by its verdict.

An end belongs to a mutant *in a round*, and so shares of ends are shares of (mutant, round) pairs: rounds may
differ, and no rule that made one end of five would be fair. Properties of a *mutant* (valid, trivial,
indistinguishable, informative) are said of all its rounds:

- A round says nothing about a property if the mutant stood outside the score there (refused, no effect …) or
  if no test reached it. What counts are the other rounds, in which tests could judge it: the *judged* ones.
- *valid*: it stood in the score in at least one round, be it as not covered.
- *trivial*: every test that reached it noticed it, in every judged round, and there is one.
- *indistinguishable*: it survived every judged round, and nothing that was compared ever differed.
- *informative*: valid, not trivial, not indistinguishable.

Whether a killed mutant is trivial is known only if every test that reaches it was run (``Outcome.complete``).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

from mutabot.model import By, Outcome, Verdict


class End(StrEnum):
    """How a mutant ended in a round, from what says most about the tests to what says nothing of them."""

    CHECK = "killed by check"
    EXCEPTION = "killed by exception"  # after commands had reached the robot, or nobody knows whether
    TIMEOUT = "timeout"
    SURVIVED = "survived"  # something ended otherwise than in the original, or nobody knows
    NOT_COVERED = "not covered"  # no test reaches it
    INDISTINGUISHABLE = "indistinguishable"  # survived, and nothing that was compared differs
    NO_EFFECT = "no effect"  # it changed no value at any hit
    REFUSED = "refused"  # the robot refused the mutated command
    GUARDED = "guarded"  # a guard kept the mutated command from the robot
    BEFORE = "exception before any command"  # killed by an exception before a command reached the robot
    INVALID = "invalid"  # no program or no command: it does not compile, a word is unknown
    UNSTABLE = "unstable"
    ERROR = "error"


_PLAIN = {
    Verdict.TIMEOUT: End.TIMEOUT,
    Verdict.REFUSED: End.REFUSED,
    Verdict.GUARDED: End.GUARDED,
    Verdict.INVALID: End.INVALID,
    Verdict.NO_EFFECT: End.NO_EFFECT,
    Verdict.NOT_COVERED: End.NOT_COVERED,
    Verdict.UNSTABLE: End.UNSTABLE,
    Verdict.ERROR: End.ERROR,
}
#: rounds in which at least one test judged the mutant
_JUDGED = frozenset({Verdict.KILLED, Verdict.TIMEOUT, Verdict.SURVIVED})


def end_of(outcome: Outcome) -> End:
    """The end that an outcome is."""
    match outcome.verdict:
        case Verdict.KILLED if outcome.by is By.CHECK:
            return End.CHECK
        case Verdict.KILLED:
            return End.BEFORE if outcome.commands == 0 else End.EXCEPTION
        case Verdict.SURVIVED:
            return End.INDISTINGUISHABLE if outcome.indistinguishable else End.SURVIVED
        case other:
            return _PLAIN[other]


@dataclass(frozen=True, slots=True)
class Properties:
    """What is said of a mutant over all its rounds; see the head of this module.

    Attributes:
        valid: whether it stood in the score in any round.
        reached: whether a test judged it in any round.
        trivial: None if that is not known.
        indistinguishable: whether no round tells it from the original.
    """

    valid: bool
    reached: bool
    trivial: bool | None
    indistinguishable: bool

    @property
    def informative(self) -> bool | None:
        """Whether it can tell suites apart; None if that is not known."""
        if not self.valid or self.indistinguishable:
            return False
        return None if self.trivial is None else not self.trivial


def properties_of(rounds: Sequence[Outcome | None]) -> Properties:
    """The properties of one mutant from its outcomes, one per round; None where it has not been run."""
    known = [outcome for outcome in rounds if outcome is not None]
    judged = [outcome for outcome in known if outcome.verdict in _JUDGED]
    return Properties(
        valid=any(outcome.verdict.is_valid for outcome in known),
        reached=bool(judged),
        trivial=_is_trivial(judged, everything_run=len(known) == len(rounds)),
        indistinguishable=bool(judged)
        and all(end_of(outcome) is End.INDISTINGUISHABLE for outcome in judged),
    )


def _is_trivial(judged: Iterable[Outcome], *, everything_run: bool) -> bool | None:
    found = [_noticed_by_all(outcome) for outcome in judged]
    if False in found:
        return False
    if not everything_run or None in found:
        return None
    return bool(found)


def _noticed_by_all(outcome: Outcome) -> bool | None:
    """Whether every test that reached the mutant noticed it; None if they were not all run."""
    if not outcome.verdict.is_killed:
        return False
    if not outcome.complete:
        return None
    noticing = outcome.noticing_tests
    return bool(noticing) and len(noticing) >= outcome.tests
