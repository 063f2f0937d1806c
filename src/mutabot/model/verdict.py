"""Verdicts: the one named end of a mutant in a round, and its place in the score."""

from __future__ import annotations

from enum import StrEnum


class By(StrEnum):
    """What noticed a killed mutant."""

    CHECK = "check"  # an assertion of the test, or a monitor
    EXCEPTION = "exception"  # anything else that ended the test


class Verdict(StrEnum):
    """How a mutant ended in a round. Beside each: its place in the score."""

    KILLED = "killed"  # valid, killed
    SURVIVED = "survived"  # valid, not killed
    TIMEOUT = "timeout"  # valid, killed, but shown apart
    REFUSED = "refused"  # outside: the robot refused the mutated command itself
    INVALID = "invalid"  # outside: no program or no command
    NO_EFFECT = "no effect"  # outside: it changed no value at any hit
    NOT_COVERED = "not covered"  # valid, not killed
    UNSTABLE = "unstable"  # outside: repeats that must agree disagree
    ERROR = "error"  # outside, never a kill: the tool, a worker or the simulator failed

    @property
    def is_valid(self) -> bool:
        """Whether it stands in the denominator of the score."""
        return self in VALID

    @property
    def is_killed(self) -> bool:
        """Whether it stands in the numerator of the score."""
        return self in KILLED


VALID = frozenset({Verdict.KILLED, Verdict.SURVIVED, Verdict.TIMEOUT, Verdict.NOT_COVERED})
KILLED = frozenset({Verdict.KILLED, Verdict.TIMEOUT})
