"""Pytest's hooks around each test of a job, which start measurements and report how it ended.

A process that was forked in the middle of a test goes on to the end as its mutant, or leaves when a test
decides.
"""

from __future__ import annotations

import os
from collections.abc import Generator, Iterator
from dataclasses import replace
from functools import partial
from itertools import islice
from types import GetSetDescriptorType
from typing import TYPE_CHECKING, Any

import pytest

from mutabot.errors import has_text
from mutabot.model import By, Mutant
from mutabot.model.clocks import monotonic, process_time
from mutabot.model.event_file import UNWRITTEN
from mutabot.model.events import ForkSessionEnd, ForkTestEnd, TestEnd, TestStart
from mutabot.model.job import write_job
from mutabot.model.process_time import TimeUsed, ran_below
from mutabot.operators.command import Fatal
from mutabot.runtime import seeds
from mutabot.runtime.exceptions import everything
from mutabot.runtime.executed import ExecutedUnits
from mutabot.runtime.isolation.fork_parent import DECIDED, ForkParent
from mutabot.runtime.observation.checks import Looks
from mutabot.runtime.observation.probes import Reading
from mutabot.runtime.plugins import drop_idle_watchdog, keep_real_files, watched, watched_by_faulthandler
from mutabot.runtime.processes.commands import STARTS
from mutabot.runtime.processes.environment import FORKINGS, listen
from mutabot.runtime.processes.member import watch_forks
from mutabot.runtime.processes.members import Members
from mutabot.runtime.seeds import node_id
from mutabot.runtime.test_end import FAILED, PASSED, classify, of_activity, outcome_so_far

if TYPE_CHECKING:
    from mutabot.runtime.session import Session


class ForkedRun:
    """The run of this process after its fork.

    Args:
        tests: the hooks for each of its tests.
        parent: what has forked it.
        mutant: its mutant.
        home: the home of its parent, in which it finds its own processes.
    """

    def __init__(self, tests: TestHooks, parent: ForkParent, mutant: Mutant, home: str) -> None:
        session, tests.fork, tests.members = tests.session, self, None
        self.mutant, self.activation = mutant, parent.activation_of(mutant)
        self._tests, self._session, self._parent, self._home = tests, session, parent, home
        self._pid = os.getpid()
        self._shared = session.meter.simulated if session.meter is not None else None
        self._is_early = not session.test
        self._has_acted = False
        listen((*STARTS, *FORKINGS), self._on_audit_event)

    def start_test(self, test: str) -> None:
        """Begin a test, the fork's second at least."""
        self._parent.note_test(self.mutant.id, test)
        self._shared = None

    def end_test(self, end: TestEnd) -> None:
        """End a test: report how it ended, and leave if it decides about the mutant."""
        self._has_acted |= end.acted > 0
        try:
            self._report(end)
        finally:
            is_decided = end.is_decided and not self._parent.forking.every_test
            if is_decided or self._parent.is_test_control(self.mutant):
                os._exit(DECIDED)  # whatever happens, nothing must run on in this process

    def end_tests(self) -> None:
        """Note that all tests have run, so that the time of the last one is not that of the session's end."""
        self._parent.note_test(self.mutant.id)

    def finish(self, errors: list[str], gone: tuple[str, ...]) -> None:
        """Report the end of the session; the parent reports the exit code."""
        self._parent.note_finished(self.mutant.id)
        self._session.writer.send(
            ForkSessionEnd((self.mutant.id,), 0, tuple(errors), gone, self._session.activity.acted > 0)
        )

    def _report(self, end: TestEnd) -> None:
        if end.outcome == FAILED:  # only survivors are compared with the original
            end = replace(end, trace=(), returned=(), moments=())
        sites = [self._session.recorder.sites[index] for index in sorted({hit[0] for hit in end.trace})]
        is_test_control = self._parent.is_test_control(self.mutant)
        fork_end = ForkTestEnd(
            self.mutant.id, end, tuple(sites), self._shared, self._is_early, is_test_control
        )
        self._session.writer.send(fork_end)

    def _on_audit_event(self, event: str, arguments: tuple[Any, ...]) -> None:
        """Make the first process that the program starts the mutant as well."""
        if self._tests.members is None and os.getpid() == self._pid:
            try:
                self._tests.members = self._own_processes()
            except OSError:  # nothing could be known of them
                os._exit(UNWRITTEN)

    def _own_processes(self) -> Members:
        session, job = self._session, self._session.job
        below = job.below(self.mutant, self.activation)
        write_job(self._home, below)
        session.job = replace(
            job, mutant=self.mutant, active=below.active, instrumentation=below.instrumentation
        )
        members = Members(self._home, session, has_acted=self._has_acted)
        members.start_test(session.test)
        watch_forks(members.folder, session)
        return members


#: parts that are looked at in what a fixture gives
_MOST = 1000
#: seconds for which the accounts that the kernel keeps of this process need not be read again: short tests
#: come by the thousand
_RECENT = 0.05


class TestHooks:
    """Pytest's hooks around the running test.

    Args:
        session: the job at hand.

    Attributes:
        members: processes below this one; None as long as no job is known, and in a fork until it starts one.
        fork: what this process does if it was forked to be a mutant; None in all others.
        left_out: tests that are not run, since they do not reach the mutant and one before has.
        looks: the checks that the test makes, in a mutant from where it reached the fault.
        units: what is executed.
    """

    __test__ = False  # not a test class, whatever pytest may think of the name

    def __init__(self, session: Session) -> None:
        self.session = session
        self.members: Members | None = None
        self.fork: ForkedRun | None = None
        self.left_out: frozenset[str] = frozenset()
        self.looks = Looks(lambda: session.activity.hits > 0)
        self.units = ExecutedUnits(session.job.root)
        self._unended: str | None = None
        self._acted: int | None = None  # how often the fault had, when the last test's phases were over
        self._address: str | None = None
        self._failure: TestEnd | None = None
        self._failed_in = ""
        self._expected: TestEnd | None = None
        self._outcome = PASSED
        self._logged: bool | None = None
        self._reading = Reading()
        self._started = (0.0, 0.0)
        self._used = TimeUsed.from_now()
        listen(("socket.bind",), self._on_audit_event)

    def start_clocks(self, *, is_new: bool = False) -> None:
        """Start the clocks of a test; ``is_new``: in a process that was just forked."""
        self._started = (monotonic(), self._ran())
        if is_new or self._used.age > _RECENT:
            self._used = TimeUsed.from_now([os.getpid()])

    def _ran(self) -> float:
        """Return the processor time (s) of this process; in the baseline, also of those below it."""
        job = self.session.job
        is_baseline = job.mutant is None and job.forking is None
        return process_time() + (ran_below() if is_baseline else 0.0)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(
        self, item: pytest.Item, nextitem: pytest.Item | None
    ) -> Generator[None, Any, Any]:
        """Run one test with its fixtures; what follows the last test belongs to it."""
        test = node_id(item)
        self.end_test()  # a plug-in may take every test for the last one
        keep_real_files()
        self.units.start_test()
        if self.fork is not None:
            self.fork.start_test(test)
        if test in self.left_out:
            return (yield)
        self._start(item, test)
        result = yield
        self._unended = test  # not where something ends the session in the midst of it
        stops_at_kill = self.session.job.stop_at_kill
        if nextitem is not None or (self._outcome == FAILED and (stops_at_kill or self.fork is not None)):
            end = self.end_test()
            if end is not None and stops_at_kill and end.is_decided:
                # as after a failure with ``-x``: of an interruption pytest would lay out a traceback, which
                # takes longer than a short suite
                item.session.shouldfail = "the mutant's verdict is known"
        return result

    def note_end_of_phases(self) -> None:
        """Note that the phases of the last test are over: nothing reports what is raised from here on."""
        self._acted = self.session.activity.acted
        if self.fork is not None:
            self.fork.end_tests()

    def end_test(self) -> TestEnd | None:
        """End the test whose phases are over, if there is one; a fork leaves if that decides."""
        session, test = self.session, self._unended
        if test is None:
            return None
        self._unended = None
        session.fault.end_test()
        if self._acted is not None and session.activity.acted > self._acted and self._is_fatal():
            # what it raises in an exit handler ends nothing, but shows that it acts
            self._outcome, self._logged = FAILED, True
            self._failure = TestEnd(test, FAILED, By.EXCEPTION, message=Fatal.name)
        end = self._test_end(test)
        if self.members is not None:
            end = self.members.merged(end)
        if self.fork is not None:  # which may have begun in this test
            self.fork.end_test(end)
        session.end_test()
        if self.fork is None:
            if session.fork_parent is not None:
                session.fork_parent.end_test()
            session.writer.send(end)
        return end

    def _is_fatal(self) -> bool:
        """Return whether this process is the fatal control, by which tests must fail."""
        mutant = self.fork.mutant if self.fork is not None else self.session.job.mutant
        return mutant is not None and mutant.family == Fatal.family and mutant.operator == Fatal.name

    def _start(self, item: pytest.Item, test: str) -> None:
        self._failure, self._expected, self._outcome, self._reading = None, None, PASSED, Reading()
        self._address = self._logged = None
        self.looks.clear()
        session = self.session
        if self.fork is None:  # else the controller would take it for the parent's test
            session.writer.send(TestStart(test))
        limit = watched_by_faulthandler(item)
        if limit is not None:
            session.writer.send(limit)
        seeds.seed_all(seeds.derive(session.job.seed, session.job.round, test))
        if session.fork_parent is not None:
            session.fork_parent.begin_test(test)
        self.start_clocks()
        if self.members is not None:
            self.members.start_test(test)
        session.start_test(test, partial(objects_of_fixtures, item))

    def _on_audit_event(self, event: str, arguments: tuple[Any, ...]) -> None:
        """Note a fixed address at which the test listens, which two processes cannot share."""
        address = arguments[1]
        is_chosen = isinstance(address, tuple) and len(address) > 1 and address[1] == 0
        if not is_chosen and self._address is None:  # by the system, which gives a free one
            self._address = f"waits at the address {address!r}"

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """Note the start of a test's fixtures."""
        if self.session.fork_parent is not None:
            drop_idle_watchdog(item)
        if self.session.fault.fatal is not None:
            raise self.session.fault.fatal

    @pytest.hookimpl(optionalhook=True, tryfirst=True)
    def pytest_timeout_set_timer(self, item: pytest.Item, settings: Any) -> None:
        """Report that pytest-timeout watches a test, as its thread ends the process without a report."""
        if settings.method == "thread":
            self.session.writer.send(watched(node_id(item), settings.timeout, "pytest-timeout"))

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_call(self, item: pytest.Item) -> None:
        """Note that the test's fixtures are set up."""
        if self.session.returns is not None:
            self.session.returns.begin_call()
        self.units.begin_call()

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_teardown(self) -> Generator[None, Any, Any]:
        """Read the probes before fixtures are torn down."""
        self.units.end_call()
        self._reading = self.session.take_probes()
        return (yield)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_makereport(
        self, item: pytest.Item, call: pytest.CallInfo[None]
    ) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        """Note the first thing that ended the test."""
        error = call.excinfo.value if call.excinfo is not None else None
        if self.fork is not None and error is not None and not all(map(has_text, everything(error))):
            item.config.option.tbstyle = "no"  # what a fork reports else is these texts
        report = yield
        if report.failed:
            end = self._classified(item, call)
            if end is None:  # what was to fail and did not raises nothing
                end = TestEnd(node_id(item), FAILED, By.CHECK, message=str(report.longrepr))
            self._note_failure(end, call.when)
        elif self._outcome != FAILED:
            self._outcome = outcome_so_far(report, self._outcome)
            if report.skipped and hasattr(report, "wasxfail"):  # it failed as the test said it would
                self._expected = self._classified(item, call)
        return report

    @pytest.hookimpl(trylast=True)
    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Count a report of the suite; reports that a re-running plug-in undoes do not arrive here."""
        self._logged = bool(self._logged) or report.failed

    def _note_failure(self, end: TestEnd, phase: str) -> None:
        """Keep the first failure; of several subtests, the first that is more than a refusal."""
        first = self._failure
        is_more = end.exception is not None and end.refused is None
        if first is None or (first.refused is not None and self._failed_in == phase and is_more):
            self._outcome, self._failure, self._failed_in = FAILED, end, phase

    def _classified(self, item: pytest.Item, call: pytest.CallInfo[None]) -> TestEnd | None:
        """Return the test end for an exception in a phase; None if nothing was raised."""
        if call.excinfo is None:
            return None
        session = self.session
        known = (session.locator, session.job.vocabulary, session.activity)
        end = classify(call.excinfo.value, node_id(item), str(item.path), *known)
        return replace(end, failure=end.failure or session.failure_in(call.excinfo.value))

    def _test_end(self, test: str) -> TestEnd:
        if self._outcome == FAILED and self._logged is False:
            self._failure, self._outcome = None, PASSED
        session, returns = self.session, self.session.returns
        activity, meter = session.activity, session.meter
        wall, cpu = monotonic() - self._started[0], self._ran() - self._started[1]
        assert meter is not None
        # of a test that a mutant neither reached nor failed, what was executed in that test alone is reported
        is_mutant = session.job.mutant is not None or self.fork is not None
        is_alone = is_mutant and not activity.hits and self._outcome != FAILED
        is_compared = session.job.record
        end = self._failure or TestEnd(test, self._outcome)
        return replace(
            end,
            **of_activity(end, activity, self._failure or self._expected),
            timeout=meter.exceeded or end.timeout,
            guarded=meter.guarded,
            # what the machine had to do with a time-out of the suite's own
            hindered=self._used.hindrance([os.getpid()]) if end.timeout is not None else None,
            refused_calls=tuple(
                (note.site, note.refused) for note in session.noted if note.refused is not None
            ),
            live=tuple(sorted(note.site for note in session.noted if note.refused is None)),
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
            recording=session.recording.text(session.recorder.recorded_calls()),
            executed=self.units.of_test(alone=is_alone),
            trace=tuple(session.recorder.trace) if is_compared else (),
            returned=tuple(returns.entries) if is_compared and returns is not None else (),
            moments=tuple(session.along.entries) if is_compared else (),
            checks=self.looks.noted if is_compared else (),
        )


def objects_of_fixtures(item: pytest.Item) -> Iterator[Any]:
    """Return the values of the test's fixtures, its instance, and their direct attributes."""
    given = list(getattr(item, "funcargs", {}).values())
    owner = getattr(getattr(item, "obj", None), "__self__", None)
    for value in given if owner is None else [*given, type(owner), owner]:
        yield value
        yield from islice(_parts(value), _MOST)


def _parts(value: Any) -> Iterator[Any]:
    """Yield items or attributes without asking the object: a lazy proxy would be made by it."""
    kind = type(value)
    if issubclass(kind, dict):
        yield from list(dict.values(value))
    for base in (list, tuple, set, frozenset):
        if issubclass(kind, base):
            yield from list(base.__iter__(value))
    slot = next((vars(base)["__dict__"] for base in kind.__mro__ if "__dict__" in vars(base)), None)
    if type(slot) is GetSetDescriptorType:
        yield from list(slot.__get__(value).values())
