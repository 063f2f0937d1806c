"""The report of one test: a line of its worker's, and what the journal keeps of the baseline."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any

from mutabot.frozen import frozen
from mutabot.model.seen.check import Check
from mutabot.model.verdict import By

#: hits per test that are reported with their values; a test is compared and planned from these
TRACE_LIMIT = 5000


@frozen
class TestEnd:
    """A test has ended.

    Attributes:
        test: node id.
        outcome: as pytest counts it: ``passed``, ``failed``, ``skipped``, ``xfailed`` or ``xpassed``. Only
            ``failed`` makes the suite fail.
        by: what noticed, for a failure.
        phase: ``setup``, ``call`` or ``teardown``: where it failed; ``collect`` if it never began.
        exception: type of the exception as ``module:Name``.
        message: first lines of the exception's text.
        place: ``file:line`` where the failure was noticed.
        timeout: which limit was exceeded, or None.
        hindered: why the limit of wall clock that it exceeded says little, as the machine was busy, in words;
            else None.
        failure: the simulator's failure, or None.
        invalid: whether the mutated call rejected its arguments' types.
        refused: text of the refusal of a mutated call, or None.
        refused_calls: in the baseline, the calls that the robot refused: site index, and the call's number
            among those of its site, from 1.
        live: in the baseline, indexes of sites that returned the robot's own memory, not a copy of it.
        caught: whether the program handled that refusal, so that the test ended for another reason.
        hits: calls at the mutant's site (with its operation and pattern).
        acted: hits at which the mutant changed something.
        away: hits at which it stayed away, by the reason.
        example: value before and after at the first hit at which it acted.
        operations: intercepted calls at any site.
        commands: operations that made the robot do something, from any site.
        wall, cpu: seconds of the test, fixtures included.
        simulated: simulated seconds, or None if there is no clock.
        trace: per hit: site index, values written, values read, and in the baseline a note of what the call
            returned: a plain value, ``{"kept": data}`` or ``{"opaque": what}`` at a site's first hit,
            ``{"same"}`` or ``{"other"}`` than that later on, ``{"raised"}`` if it did not return.
        truncated: whether the trace was cut off.
        returned: what functions of the program returned to the test: name, and the value in a list or, for
            one that raised, ``{"raised": text}``.
        prepared: how many of these are from before the test itself began: from its fixtures.
        probes: values of each probe by ``target.part``; those of the second object of a class by
            ``target#2.part``.
        unread: why a probe could not be read, by target.
        processes: processes below the tests that were there during it, by number, with a name for people.
        exclusive: by what it gets in the way of other processes, in words, or None.
        moments: probes along the way: after which call (from 1), parts that differ from the moment before,
            and whether these are all parts.
        reading: processor seconds it takes to read all probes; None if they cannot be read along the way.
        not_along: why not, or None.
        checks: the checks of the tests that were made, and what they compared.
        more_checks: how many further ones were made.
        recording: what the world did, as ``evidence.recording.to_text`` writes it; None if that was not asked
            for.
    """

    __test__ = False  # not a test class, whatever pytest may think of the name

    test: str
    outcome: str
    by: By | None = None
    phase: str = "call"
    exception: str | None = None
    message: str | None = None
    place: str | None = None
    timeout: str | None = None
    failure: str | None = None
    invalid: bool = False
    refused: str | None = None
    refused_calls: tuple[tuple[int, int], ...] = ()
    live: tuple[int, ...] = ()
    caught: bool = False
    hits: int = 0
    acted: int = 0
    away: Mapping[str, int] = field(default_factory=dict)
    example: tuple[Any, ...] | None = None
    operations: int = 0
    commands: int = 0
    wall: float = 0.0
    cpu: float = 0.0
    simulated: float | None = None
    trace: tuple[Any, ...] = ()
    truncated: bool = False
    returned: tuple[Any, ...] = ()
    prepared: int = 0
    probes: Mapping[str, Any] = field(default_factory=dict)
    unread: Mapping[str, str] = field(default_factory=dict)
    processes: tuple[tuple[int, str], ...] = ()
    exclusive: str | None = None
    moments: tuple[Any, ...] = ()
    reading: float | None = None
    not_along: str | None = None
    checks: tuple[Check, ...] = ()
    more_checks: int = 0
    recording: str | None = None
    hindered: str | None = None

    @property
    def lasting(self) -> str:
        """The outcome, as far as equal runs must agree on it: what may fail may also pass."""
        return "xfailed" if self.outcome == "xpassed" else self.outcome

    @property
    def notices(self) -> bool:
        """Whether this test noticed its mutant, provided that the mutant had changed anything."""
        if self.failure is not None or self.invalid:
            return False
        is_refused = self.refused is not None and not self.caught
        return self.timeout is not None or (self.outcome == "failed" and not is_refused)

    @property
    def is_decided(self) -> bool:
        """Whether this test alone decides about its mutant, so that no other test needs to run."""
        if self.failure is not None or self.invalid or self.timeout is not None:
            return True
        return self.outcome == "failed" and (self.refused is None or self.caught)
