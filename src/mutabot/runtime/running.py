"""Pytest's hooks for a job's tests, one after the other: what goes around each, and how each has ended.

Addresses at which the tests wait: two processes cannot have the same one at the same time.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Generator, Iterator, Mapping
from functools import partial
from itertools import islice
from time import perf_counter, process_time  # tests may replace those of the module
from typing import Any

import pytest

from mutabot.model.events import TestEnd, TestStart
from mutabot.model.process_time import TimeUsed
from mutabot.model.source_units import Executed
from mutabot.runtime import seeds
from mutabot.runtime.evidence import Evidence
from mutabot.runtime.executed import ExecutedUnits
from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.isolation.fork import BranchOfSession
from mutabot.runtime.observation.checks import Looks
from mutabot.runtime.observation.probes import Reading
from mutabot.runtime.plugins import drop_idle_watchdog, watched, watched_by_faulthandler
from mutabot.runtime.processes.members import Members
from mutabot.runtime.seeds import node_id
from mutabot.runtime.session import Session
from mutabot.runtime.test_end import (
    FAILED,
    PASSED,
    Ending,
    classify,
    is_expected_failure,
    outcome_so_far,
    unexpected_pass,
)


class FixedAddresses:
    """Those of one process, seen by an audit event before the system is asked for an address.

    Attributes:
        taken: what the running test waits at, in words; None if the system chooses what nobody else has.
    """

    def __init__(self) -> None:
        self.taken: str | None = None
        self._is_on = False

    def start_test(self) -> None:
        """A test begins."""
        self.taken = None
        if not self._is_on:
            self._is_on = True
            sys.addaudithook(self._hear)

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event != "socket.bind":
            return
        address = arguments[1]
        if not (isinstance(address, tuple) and len(address) > 1 and address[1] == 0):
            self.taken = self.taken or f"waits at the address {address!r}"


#: parts that are looked at in what a fixture gives
_MOST = 1000


class Running:
    """The running test.

    Args:
        session: the job at hand.
        locator: whose file is whose.

    Attributes:
        branch: what to do if this process turns out to be a branch.
        members: processes below the tests; None as long as no job is known.
        looks: the checks that the test makes.
        units: what is executed.
    """

    def __init__(self, session: Session, locator: Locator) -> None:
        self.session = session
        self.locator = locator
        self.branch = BranchOfSession(session, self.start_clocks)
        self.members: Members | None = None
        self.addresses = FixedAddresses()
        self.looks = Looks()
        self.units = ExecutedUnits(session.job.root)
        self._ending: Ending | None = None
        self._expected: Ending | None = None
        self._outcome = PASSED
        self._logged: bool | None = None
        self._reading = Reading()
        self._started = (0.0, 0.0)
        self._used = TimeUsed.from_now()

    def start_clocks(self) -> None:
        """What the test takes is counted from now on."""
        self._started = (perf_counter(), process_time())
        self._used = TimeUsed.from_now([os.getpid()])

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        """One test, its fixtures included."""
        self._ending, self._expected, self._outcome, self._reading = None, None, PASSED, Reading()
        self.looks.clear()
        self._logged = None
        self.units.start_test()
        self.branch.start_test()
        if self.branch.left_out.is_next(node_id(item)):
            return (yield)
        self.session.pipe.send(TestStart(node_id(item)))
        limit = watched_by_faulthandler(item)
        if limit is not None:
            self.session.pipe.send(limit)
        job = self.session.job
        seeds.seed_all(seeds.derive(job.seed, job.round, node_id(item)))
        if self.session.trunk is not None:
            self.session.trunk.begin_test(node_id(item))
        self.addresses.start_test()
        self.start_clocks()
        if (members := self._members) is not None:
            members.start_test(node_id(item))
        self.session.start_test(node_id(item), partial(objects_of_fixtures, item))
        result = yield
        end = self._test_end(node_id(item))
        if (members := self._members) is not None:
            end = members.merged(end)
        self.branch.end_test(end)
        self.session.end_test()
        if not self.branch.is_one:
            self.session.pipe.send(end)
        if job.stop_at_kill and end.is_decided:
            item.session.shouldstop = "the mutant's verdict is known"
        return result

    @property
    def _members(self) -> Members | None:
        """The processes below this one; those of a trunk are none of its branches'."""
        return self.branch.members if self.branch.is_one else self.members

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """The fixtures of a test are next."""
        if self.session.trunk is not None:
            drop_idle_watchdog(item)
        if self.session.placed.fatal is not None:
            raise self.session.placed.fatal

    @pytest.hookimpl(optionalhook=True, tryfirst=True)
    def pytest_timeout_set_timer(self, item: pytest.Item, settings: Any) -> None:
        """Pytest-timeout is about to watch a test: its thread leaves the process without a word."""
        if settings.method == "thread":
            self.session.pipe.send(watched(node_id(item), settings.timeout, "pytest-timeout"))

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_call(self, item: pytest.Item) -> None:
        """The test's fixtures are set up."""
        if self.session.returns is not None:
            self.session.returns.begin_call()
        self.units.begin_call(self._shared_fixtures(item))

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_teardown(self) -> Generator[None, Any, Any]:
        """Before fixtures take the world down: take the probes."""
        self.units.end_call()
        self._reading = self.session.take_probes()
        return (yield)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_makereport(
        self, item: pytest.Item, call: pytest.CallInfo[None]
    ) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        """Note the first thing that ended the test."""
        report = yield
        if report.failed:
            self._note_failure(self._classified(item, call) or unexpected_pass(str(report.longrepr)))
        elif self._outcome != FAILED:
            self._outcome = outcome_so_far(report, self._outcome)
            if is_expected_failure(report):
                self._expected = self._classified(item, call)
        return report

    @pytest.hookimpl(trylast=True)
    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """A report counts for the suite: a plug-in that runs a test again does not report what it undoes."""
        self._logged = bool(self._logged) or report.failed

    def _shared_fixtures(self, item: pytest.Item) -> list[str]:
        """The fixtures of the project's that the test has and that outlive it."""
        known = getattr(getattr(item, "_fixtureinfo", None), "name2fixturedefs", {})
        return [
            f"{one.baseid}::{one.argname}"
            for some in known.values()
            for one in some
            if one.scope != "function" and self.units.is_of_project(getattr(one.func, "__code__", None))
        ]

    def _executed(self, evidence: Evidence) -> Executed:
        """What was executed: in a test that a mutant neither reached nor failed, in that test alone."""
        is_mutant = self.session.job.mutant is not None or self.branch.is_one
        return self.units.of_test(alone=is_mutant and not evidence.hits and self._outcome != FAILED)

    def _note_failure(self, ending: Ending) -> None:
        """The first failure counts; of several subtests, the first that is more than a refusal."""
        first = self._ending
        if first is None or (first.refused is not None and first.phase == ending.phase and ending.is_raised):
            self._outcome, self._ending = FAILED, ending

    def _classified(self, item: pytest.Item, call: pytest.CallInfo[None]) -> Ending | None:
        """What ended a phase of the test; None if nothing was raised."""
        if call.excinfo is None:
            return None
        return classify(
            call.excinfo.value,
            call.when,
            str(item.path),
            self.locator,
            self.session.job.vocabulary,
            self.session.evidence,
        )

    def _hindered(self, ending: Ending | None) -> str | None:
        """What the machine had to do with a time-out of the suite's own."""
        is_overdue = ending is not None and ending.timeout is not None
        return self._used.hindrance([os.getpid()]) if is_overdue else None

    def _test_end(self, test: str) -> TestEnd:
        if self._outcome == FAILED and self._logged is False:
            self._ending, self._outcome = None, PASSED
        session, evidence, ending = self.session, self.session.evidence, self._ending
        wall, cpu = perf_counter() - self._started[0], process_time() - self._started[1]
        meter, returns = session.meter, session.returns
        assert meter is not None
        cause = ending or self._expected  # what a test said that it would do ends it as well
        ended_by_refusal = cause is not None and cause.refused is not None
        refusal = evidence.refusal
        if evidence.is_of_text and not ended_by_refusal:
            refusal = None
        # what follows a refusal that is data follows from what the program makes of it
        is_caught = refusal is not None and evidence.said is None
        return TestEnd(
            test=test,
            outcome=self._outcome,
            by=ending.by if ending else None,
            phase=ending.phase if ending else "call",
            exception=ending.exception if ending else None,
            message=ending.message if ending else None,
            place=ending.place if ending else None,
            timeout=meter.exceeded or (ending.timeout if ending else None),
            failure=evidence.failure or (cause.failure if cause else None),
            invalid=evidence.invalid or is_no_program(evidence, cause),
            refused=refusal,
            refused_calls=tuple(session.refused_calls),
            live=tuple(sorted(session.live)),
            caught=is_caught and self._outcome == FAILED and not ended_by_refusal,
            hits=evidence.hits,
            acted=evidence.acted,
            away=evidence.away,
            example=evidence.example,
            operations=meter.operations,
            commands=session.commands,
            wall=wall,
            cpu=cpu,
            simulated=meter.simulated,
            trace=tuple(session.recorder.trace) if self.session.job.record else (),
            truncated=session.recorder.truncated,
            returned=tuple(returns.entries) if returns is not None and self.session.job.record else (),
            prepared=returns.prepared if returns is not None else 0,
            probes=self._reading.values,
            unread=self._reading.unread,
            exclusive=self.addresses.taken,
            moments=tuple(session.along.entries) if self.session.job.record else (),
            reading=session.rehearsal.seconds,
            not_along=session.rehearsal.why_not,
            checks=self.looks.checks if self.session.job.record else (),
            more_checks=self.looks.more,
            recording=session.recording.text(session.recorder.told()),
            hindered=self._hindered(ending),
            executed=self._executed(evidence),
        )


def is_no_program(evidence: Evidence, ending: Ending | None) -> bool:
    """Whether a mutant of the program text made a text that is no program or no command."""
    if not evidence.is_of_text or ending is None:
        return False
    return ending.is_syntax or (evidence.is_unknown and ending.refused is not None)


def objects_of_fixtures(item: pytest.Item) -> Iterator[Any]:
    """What the test's fixtures gave and what lies right in that; the object of its class likewise."""
    given = list(getattr(item, "funcargs", {}).values())
    owner = getattr(getattr(item, "obj", None), "__self__", None)
    for one in given if owner is None else [*given, type(owner), owner]:
        yield one
        yield from islice(_parts(one), _MOST)


def _parts(value: Any) -> Iterator[Any]:
    if isinstance(value, Mapping):
        yield from value.values()
    elif isinstance(value, list | tuple | set | frozenset):
        yield from value
    else:
        yield from list(getattr(value, "__dict__", {}).values())
