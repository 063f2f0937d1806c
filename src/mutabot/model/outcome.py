"""Outcomes: the verdict on a mutant in a round, its place in the score, and how it came about."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import field
from enum import StrEnum
from typing import Any

from mutabot.frozen import frozen
from mutabot.model.world_difference import Diverged


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
    GUARDED = "guarded"  # outside: a guard kept a command from the robot
    INVALID = "invalid"  # outside: no program or no command
    NO_EFFECT = "no effect"  # outside: it changed no value at any hit
    NOT_COVERED = "not covered"  # valid, not killed
    UNSTABLE = "unstable"  # outside: repeats that must agree disagree
    ERROR = "error"  # outside, never a kill: the tool, a worker or the simulator failed

    @property
    def is_valid(self) -> bool:
        """Whether it counts in the denominator of the score."""
        return self in VALID

    @property
    def is_killed(self) -> bool:
        """Whether it counts in the numerator of the score."""
        return self in KILLED


VALID = frozenset({Verdict.KILLED, Verdict.SURVIVED, Verdict.TIMEOUT, Verdict.NOT_COVERED})
KILLED = frozenset({Verdict.KILLED, Verdict.TIMEOUT})


@frozen
class Check:
    """A check in a test.

    Attributes:
        place: ``file:line`` of it.
        text: what the test says there.
        seen: the values that it compared, or the arguments of a call; of a check that was made several times,
            those that were nearest to fail. Empty if they are no plain values.
        spare: by how much it held: the distance between the two sides of the comparison, in their unit. None
            if it is no matter of more or less.
        times: how often it was made.
    """

    place: str
    text: str
    seen: str = ""
    spare: float | None = None
    times: int = 1


@frozen
class Looked:
    """A test that ran a mutant and passed.

    Attributes:
        test: node id.
        acted: whether the mutant changed something in it.
        checks: the checks that it made after its process reached the fault, in the order in which they were
            first made; all of them if that process never reached it.
        more: how many further checks it made.
    """

    test: str
    acted: bool
    checks: tuple[Check, ...] = ()
    more: int = 0


@frozen
class Compared:
    """The amounts of data in a mutant's tests that were compared with the original's.

    Attributes:
        calls: calls of operations.
        moments: moments at which probes were read, those at the ends of tests included.
        returned: values that the program returned to the tests, as far as they are plain data.
    """

    calls: int = 0
    moments: int = 0
    returned: int = 0

    @classmethod
    def together(cls, parts: Iterable[Compared]) -> Compared:
        """Return the sum of what was compared in several tests."""
        parts = list(parts)
        return cls(
            sum(part.calls for part in parts),
            sum(part.moments for part in parts),
            sum(part.returned for part in parts),
        )

    @property
    def text(self) -> str:
        """``14 calls, probes at 9 moments, 1 returned value``; what was not compared at all is not listed."""
        parts = (
            (self.calls, f"{self.calls} {'call' if self.calls == 1 else 'calls'}"),
            (self.moments, f"probes at {self.moments} {'moment' if self.moments == 1 else 'moments'}"),
            (self.returned, f"{self.returned} returned {'value' if self.returned == 1 else 'values'}"),
        )
        return ", ".join(text for count, text in parts if count) or parts[0][1]


@frozen
class Kill:
    """A test that noticed a mutant.

    Attributes:
        test: node id.
        by: what noticed it.
        exception: type of the exception that ended the test, as ``module:Name``.
        message: first lines of that exception's text.
    """

    test: str
    by: By
    exception: str | None = None
    message: str | None = None


@frozen
class Outcome:
    """The verdict on one mutant in one round, and how it came about.

    Attributes:
        mutant: the mutant's id.
        round: 0-based round.
        verdict: the verdict.
        by: what noticed it, for a kill.
        test: node id of the test that killed, timed out, was refused or failed the tool; else None.
        exception: type of the exception that ended that test, as ``module:Name``.
        message: first lines of that exception's text, or why the verdict is what it is.
        place: ``file:line`` where it was noticed.
        hits: calls at the mutant's site, over all tests run.
        acted: hits at which the mutant changed something.
        away: hits at which it stayed away, by the reason, as far as its operator says.
        example: value before and after at the first hit at which it acted.
        tests: number of tests run.
        wall: seconds from the start of the process to its end.
        cpu: processor seconds of the tests.
        simulated: simulated seconds of the tests, or None without a clock.
        shared: how many of these were inherited from the original's run; None if none could be.
        indistinguishable: whether trace and probes equal the original's; None if that was not compared
            (only survivors are).
        distance: greatest difference of a probe from the original's, in multiples of its tolerance;
            None without probes, or if one cannot be read.
        divergence: what ended otherwise than in the original, one line each, worst first.
        gaps: what could not be compared with the original, one line each.
        way: greatest difference of a probe along the way of a test, in multiples of its tolerance; None if
            probes were not read along the way.
        compared: how much was compared; None if nothing was.
        engine: ``replay`` or ``fork``.
        complete: whether every test that reaches the mutant was run, also after one had noticed it.
        kills: the tests that noticed it, in the order in which they ran: all of them if ``complete``, else
            the first at most.
        commands: operations with which the deciding test had commanded the robot until it ended; None if
            that is not known.
        repeats: how often it was run once more in a fresh process and had the same verdict.
        beside: how it had ended before, beside other processes on a busy machine, if the wall clock had ended
            it and it was run once more alone; else None.
        looked: of a survivor, the tests that reach it and what they checked.
        diverged: how the recordings of its tests differ from the original's, what says most first; empty if
            they do not, or if there are none.
        confirmed: whether the whole suite says so too, of what was found without tests that do not reach the
            mutant; None if none was left out, or not before the test that decided.
        executed: units of the project's files that were executed until then, see ``model.units``; None if
            that is not known. The journal keeps it in the outcome's key.
    """

    mutant: str
    round: int
    verdict: Verdict
    by: By | None = None
    test: str | None = None
    exception: str | None = None
    message: str | None = None
    place: str | None = None
    hits: int = 0
    acted: int = 0
    away: Mapping[str, int] = field(default_factory=dict)
    example: tuple[Any, ...] | None = None
    tests: int = 0
    wall: float = 0.0
    cpu: float = 0.0
    simulated: float | None = None
    shared: float | None = None
    indistinguishable: bool | None = None
    distance: float | None = None
    divergence: tuple[str, ...] = ()
    gaps: tuple[str, ...] = ()
    way: float | None = None
    compared: Compared | None = None
    engine: str = "replay"
    complete: bool = False
    kills: tuple[Kill, ...] = ()
    commands: int | None = None
    repeats: int = 0
    beside: str | None = None
    looked: tuple[Looked, ...] = ()
    diverged: tuple[Diverged, ...] = ()
    confirmed: bool | None = None
    executed: Mapping[str, tuple[int, ...]] | None = None

    @property
    def noticing_tests(self) -> frozenset[str]:
        """The tests that noticed the mutant, as far as they are known; a time-out is noticed too."""
        if not self.verdict.is_killed:
            return frozenset()
        return frozenset(
            {*(kill.test for kill in self.kills), *([self.test] if self.test is not None else [])}
        )

    @property
    def shown_difference(self) -> Diverged | None:
        """The most telling difference in recordings, whose story reports show; None if there is none."""
        return max(self.diverged, key=lambda divergence: divergence.rank, default=None)

    @property
    def deviation(self) -> float | None:
        """The greatest distance from the original, in units of the original's spread; None if not known.

        What was recorded of the world says more than probes do, and tests whose end is stable more than
        others.
        """
        found = [divergence for divergence in self.diverged if divergence.apart or divergence.measurements]
        stable = [divergence for divergence in found if not divergence.scatters]
        if found:
            return max(divergence.deviation for divergence in stable or found)
        known = [size for size in (self.distance, self.way) if size is not None]
        return max(known, default=0.0 if self.indistinguishable else None)


def added(counts: Iterable[Mapping[str, int]]) -> dict[str, int]:
    """Return the sum of counts by name."""
    total: dict[str, int] = {}
    for counter in counts:
        for name, count in counter.items():
            total[name] = total.get(name, 0) + count
    return total
