"""Pytest's hooks around each test of a job: they start its measurements and tell how it ended."""

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
from mutabot.runtime.isolation.forked_run import ForkedRun
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

#: parts that are looked at in what a fixture gives
_MOST = 1000


class TestHooks:
    """The running test.

    Args:
        session: the job at hand.
        locator: whose file is whose.

    Attributes:
        members: processes below the test process; None as long as no job is known. A fork has its own.
        fork: what this process does if it was forked to be a mutant; None in all others.
        left_out: tests that are not run, since they do not reach the mutant and one before has.
        looks: the checks that the test makes.
        units: what is executed.
    """

    __test__ = False  # not a test class, whatever pytest may think of the name

    def __init__(self, session: Session, locator: Locator) -> None:
        self.session = session
        self.locator = locator
        self.members: Members | None = None
        self.fork: ForkedRun | None = None
        self.left_out: frozenset[str] = frozenset()
        self.looks = Looks()
        self.units = ExecutedUnits(session.job.root)
        self._address: str | None = None
        self._hears = False
        self._ending: Ending | None = None
        self._expected: Ending | None = None
        self._outcome = PASSED
        self._logged: bool | None = None
        self._reading = Reading()
        self._started = (0.0, 0.0)
        self._used = TimeUsed.from_now()

    def start_clocks(self) -> None:
        """Count from now on what the test takes."""
        self._started = (perf_counter(), process_time())
        self._used = TimeUsed.from_now([os.getpid()])

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        """One test, its fixtures included."""
        session, test = self.session, node_id(item)
        self.units.start_test()
        if self.fork is not None:
            self.fork.start_test()
        if test in self.left_out:
            return (yield)
        self._start(item, test)
        result = yield
        end = self._test_end(test)
        members = self.members if self.fork is None else self.fork.members
        if members is not None:
            end = members.merged(end)
        if self.fork is not None:  # which may have begun in this test
            self.fork.end_test(end)
        session.end_test()
        if self.fork is None:
            session.pipe.send(end)
        if session.job.stop_at_kill and end.is_decided:
            item.session.shouldstop = "the mutant's verdict is known"
        return result

    def _start(self, item: pytest.Item, test: str) -> None:
        self._ending, self._expected, self._outcome, self._reading = None, None, PASSED, Reading()
        self._address = self._logged = None
        self.looks.clear()
        if not self._hears:
            self._hears = True
            sys.addaudithook(self._hear)
        session = self.session
        session.pipe.send(TestStart(test))
        limit = watched_by_faulthandler(item)
        if limit is not None:
            session.pipe.send(limit)
        seeds.seed_all(seeds.derive(session.job.seed, session.job.round, test))
        if session.fork_parent is not None:
            session.fork_parent.begin_test(test)
        self.start_clocks()
        members = self.members if self.fork is None else self.fork.members
        if members is not None:
            members.start_test(test)
        session.start_test(test, partial(objects_of_fixtures, item))

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        """Note a fixed address that the test waits at: two processes cannot have it at the same time."""
        if event == "socket.bind" and self._address is None:
            address = arguments[1]
            is_chosen = isinstance(address, tuple) and len(address) > 1 and address[1] == 0
            if not is_chosen:  # by the system, which gives one that nobody else has
                self._address = f"waits at the address {address!r}"

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """The fixtures of a test are next."""
        if self.session.fork_parent is not None:
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
        self.units.begin_call()

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

    def _executed(self, evidence: Evidence) -> Executed:
        """What was executed: in a test that a mutant neither reached nor failed, in that test alone."""
        is_mutant = self.session.job.mutant is not None or self.fork is not None
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
            exclusive=self._address,
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
