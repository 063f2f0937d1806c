"""Pytest's hooks around each test of a job: they start its measurements and tell how it ended."""

from __future__ import annotations

import os
from collections.abc import Generator, Iterator, Mapping
from dataclasses import replace
from functools import partial
from itertools import islice
from time import perf_counter, process_time  # tests may replace those of the module
from typing import Any

import pytest

from mutabot.model import By
from mutabot.model.events import TestEnd, TestStart
from mutabot.model.process_time import TimeUsed
from mutabot.model.source_units import Executed
from mutabot.runtime import seeds
from mutabot.runtime.audit import listen
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
    classify,
    is_expected_failure,
    outcome_so_far,
    with_evidence,
)

#: parts that are looked at in what a fixture gives
_MOST = 1000
#: seconds for which the accounts that the kernel keeps of this process need not be read again: short tests
#: come by the thousand
_RECENT = 0.05


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
        self._failure: TestEnd | None = None
        self._failed_in = ""
        self._expected: TestEnd | None = None
        self._outcome = PASSED
        self._logged: bool | None = None
        self._reading = Reading()
        self._started = (0.0, 0.0)
        self._used = TimeUsed.from_now()

    def start_clocks(self, *, is_new: bool = False) -> None:
        """Count from now on what the test takes; ``is_new``: in a process that was just forked."""
        self._started = (perf_counter(), process_time())
        if is_new or self._used.age > _RECENT:
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
        self._failure, self._expected, self._outcome, self._reading = None, None, PASSED, Reading()
        self._address = self._logged = None
        self.looks.clear()
        if not self._hears:
            self._hears = True
            listen(("socket.bind",), self._hear)
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
        address = arguments[1]
        is_chosen = isinstance(address, tuple) and len(address) > 1 and address[1] == 0
        if not is_chosen and self._address is None:  # by the system, which gives one that nobody else has
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
            # what was to fail and did not raises nothing
            passed = TestEnd(node_id(item), FAILED, By.CHECK, message=str(report.longrepr))
            self._note_failure(self._classified(item, call) or passed, call.when)
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

    def _note_failure(self, end: TestEnd, phase: str) -> None:
        """The first failure counts; of several subtests, the first that is more than a refusal."""
        first = self._failure
        is_more = end.exception is not None and end.refused is None
        if first is None or (first.refused is not None and self._failed_in == phase and is_more):
            self._outcome, self._failure, self._failed_in = FAILED, end, phase

    def _classified(self, item: pytest.Item, call: pytest.CallInfo[None]) -> TestEnd | None:
        """What ended a phase of the test; None if nothing was raised."""
        if call.excinfo is None:
            return None
        session = self.session
        known = (self.locator, session.job.vocabulary, session.evidence)
        return classify(call.excinfo.value, node_id(item), str(item.path), *known)

    def _test_end(self, test: str) -> TestEnd:
        if self._outcome == FAILED and self._logged is False:
            self._failure, self._outcome = None, PASSED
        session, evidence, meter, returns = (
            self.session,
            self.session.evidence,
            self.session.meter,
            self.session.returns,
        )
        wall, cpu = perf_counter() - self._started[0], process_time() - self._started[1]
        assert meter is not None
        end = self._failure or TestEnd(test, self._outcome)
        end = with_evidence(end, evidence, self._failure or self._expected)
        end = replace(
            end,
            timeout=meter.exceeded or end.timeout,
            # what the machine had to do with a time-out of the suite's own
            hindered=self._used.hindrance([os.getpid()]) if end.timeout is not None else None,
            refused_calls=tuple((one.site, one.refused) for one in session.noted if one.refused is not None),
            live=tuple(sorted(one.site for one in session.noted if one.refused is None)),
            operations=meter.operations,
            commands=session.commands,
            wall=wall,
            cpu=cpu,
            simulated=meter.simulated,
            truncated=session.recorder.truncated,
            prepared=returns.prepared if returns is not None else 0,
            probes=self._reading.values,
            unread=self._reading.unread,
            exclusive=self._address,
            reading=self._reading.seconds,
            not_along=self._reading.not_along,
            more_checks=self.looks.more,
            recording=session.recording.text(session.recorder.told()),
            executed=self._executed(evidence),
        )
        if not session.job.record:
            return end
        return replace(
            end,
            trace=tuple(session.recorder.trace),
            returned=tuple(returns.entries) if returns is not None else (),
            moments=tuple(session.along.entries),
            checks=self.looks.checks,
        )


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
