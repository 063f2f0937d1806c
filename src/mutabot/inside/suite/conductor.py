"""The conductor: makes pytest run a job, and reports what becomes of each test."""

from __future__ import annotations

import gc
import json
import os
import sys
import time
import traceback
from collections.abc import Generator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from mutabot.border import stack
from mutabot.border.codec import from_data
from mutabot.border.footprint import Footprint
from mutabot.border.job import Branching, Job
from mutabot.border.lines import BranchEnd, SessionEnd, TestEnd, TestStart, Unbranched
from mutabot.inside import seeds
from mutabot.inside.calls.locate import Locator
from mutabot.inside.evidence import Evidence
from mutabot.inside.footprint.file_watch import Deed
from mutabot.inside.footprint.footprints import Footprints
from mutabot.inside.fork.lifeline import die_with_parent, nobody_listens
from mutabot.inside.fork.trunk import ALIVE, DECIDED, STOPPED, Trunk
from mutabot.inside.fork.trunk import FAILED as BRANCH_FAILED
from mutabot.inside.limits import limit_memory
from mutabot.inside.pipe import Held, Pipe
from mutabot.inside.readings.probes import Reading
from mutabot.inside.session import Session
from mutabot.inside.stacks import say_where_on_signal
from mutabot.inside.text.returns import Returns
from mutabot.inside.watchdogs import drop_idle_watchdog, watched, watched_by_faulthandler
from mutabot.operators.registry import preload

from .classify import Ending, classify, unexpected_pass
from .no_oracle import NoOracle
from .outcomes import FAILED, PASSED, is_expected_failure, outcome_so_far

if TYPE_CHECKING:
    from mutabot.inside.fork.copies import Commission, ForkServer

#: where a process keeps what it prints, in its home
LOG = "log.txt"


class Conductor:
    """Pytest's hooks for one job."""

    def __init__(self, job: Job, pipe: Pipe, server: ForkServer | None = None) -> None:
        self.job = job
        self.locator = Locator(job.root, job.program, job.oracle)
        self._held = Held()
        self.session = Session(job, pipe if server is None else self._held, self.locator.locate)
        self._pipe = pipe
        self._server = server
        self._ending: Ending | None = None
        self._expected: Ending | None = None
        self._outcome = PASSED
        self._reading = Reading()
        self._collected: tuple[str, ...] = ()
        self._errors: list[str] = []
        self._started = (0.0, 0.0)
        self._pid = os.getpid()
        self._shared: float | None = None
        self._item: pytest.Item | None = None
        self._no_oracle: NoOracle | None = None
        self.footprints = Footprints(job, self.locator)
        self._not_private: str | None = None

    @classmethod
    def from_files(cls, job_file: str, descriptor: int) -> Conductor:
        """Read the job, set the limits of the process and put the interception in place."""
        die_with_parent()
        if nobody_listens(descriptor):  # the controller died before the kernel was asked
            os._exit(BRANCH_FAILED)
        home = os.path.dirname(job_file)
        job = read_job(job_file)
        say_where_on_signal(home)  # before anybody notes which files are open
        if job.memory is not None:
            limit_memory(job.memory)
        # what the program draws while it is imported is the same in all rounds: a fork server imports it once
        seeds.seed_all(seeds.derive(job.seed, "import"))
        if job.serving is not None:
            from mutabot.inside.fork.copies import ForkServer  # noqa: PLC0415  # of no use to other jobs

            preload()
            pipe = Pipe(descriptor)
            conductor = cls(job, pipe, ForkServer(job.serving, pipe, os.path.join(home, LOG)))
        else:
            conductor = cls(job, pipe_of(job, home, descriptor))
            conductor._make_private(home)
        conductor.session.returns = Returns(conductor.locator)
        conductor.session.install()
        if job.no_oracle:
            conductor.switch_off_checks()
        conductor._begin(home)
        return conductor

    def _make_private(self, home: str) -> None:
        if self.job.private_files:
            self._not_private = self.footprints.make_private(home)
            die_with_parent()  # a process that changes its rights loses that wish

    def _begin(self, home: str) -> None:
        if self.job.branching is not None:
            preload({mutant.operator for mutant in self.job.branching.mutants})  # and not in every branch
            self.grow(self.job.branching, os.path.join(home, LOG))

    def grow(self, branching: Branching, log_file: str) -> None:
        """Be a trunk: fork a branch for every live mutant."""
        log = os.stat(log_file)
        identity = (log.st_dev, log.st_ino)
        file = os.path.join(os.path.dirname(log_file), stack.FILE)
        self.session.trunk = Trunk(
            branching,
            self._pipe,
            identity,
            self._become_branch,
            lambda pid: stack.ask(pid, file, self.job.root),
        )

    def switch_off_checks(self) -> None:
        """Let tests check nothing."""
        self._no_oracle = NoOracle(self.job.root, self.locator)
        self._no_oracle.install()

    def seed_of(self, name: str) -> int:
        """The seed of a test or shared fixture in this round."""
        return seeds.derive(self.job.seed, self.job.round, name)

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Keep the job's tests, in the job's order."""
        self._collected = tuple(item.nodeid for item in items)
        self.footprints.has_others = len(items) > 1
        self._select(items)

    def _select(self, items: list[pytest.Item]) -> None:
        if self.job.tests is None:
            return
        by_id = {item.nodeid: item for item in items}
        missing = [test for test in self.job.tests if test not in by_id]
        if missing:
            self._errors.append(f"tests that were there before are gone: {', '.join(missing)}")
        items[:] = [by_id[test] for test in self.job.tests if test in by_id]

    @pytest.hookimpl(tryfirst=True)
    def pytest_pycollect_makemodule(self, module_path: Any) -> None:
        """A test file is about to be imported."""
        if self._no_oracle is not None:
            self._no_oracle.note_tests(str(module_path))

    @pytest.hookimpl(wrapper=True)
    def pytest_make_collect_report(
        self, collector: pytest.Collector
    ) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
        """Note whose doing it is that something cannot be collected."""
        report = yield
        call: pytest.CallInfo[Any] | None = getattr(report, "call", None)
        if report.failed and call is not None and call.excinfo is not None:
            error = call.excinfo.value
            is_wrapped = isinstance(error, collector.CollectError) and error.__cause__ is not None
            self.import_failed(error.__cause__ if is_wrapped else error, collector.nodeid)
        return report

    def import_failed(self, error: BaseException | None, node: str) -> None:
        """Test files cannot be imported. If the mutant did something meanwhile, their tests noticed it.

        Args:
            error: what was raised.
            node: id of what could not be collected; empty for all there is.
        """
        evidence = self.session.evidence
        if error is None or not evidence.acted:
            return
        below = (f"{node}::", f"{node}/") if node not in ("", ".") else ("",)
        tests = [test for test in self.job.tests or () if test.startswith(below)]
        for test in tests[:1] if self.job.stop_at_kill else tests:
            file = os.path.join(self.job.root, test.partition("::")[0])
            ending = classify(error, "collect", file, self.locator, self.job.vocabulary, evidence)
            end = TestEnd(
                test, "failed", ending.by, ending.phase, ending.exception, ending.message, ending.place,
                failure=evidence.failure or ending.failure, refused=ending.refused,
                invalid=evidence.invalid or _is_no_program(evidence, ending),
                hits=evidence.hits, acted=evidence.acted, example=evidence.example,
            )  # fmt: skip
            self._pipe.send(end)

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Note what could not be collected."""
        if report.failed:
            self._errors.append(f"{report.nodeid}: {str(report.longrepr)[-1500:]}")

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> Generator[None, Any, Any]:
        """All tests are collected: run them, or fork a copy of this process for every job."""
        commission = self._server.serve() if self._server is not None else None
        if self._server is not None and commission is None:
            session.items.clear()
        if commission is None:
            self.session.look_ahead()
            seeds.seed_all(seeds.derive(self.job.seed, self.job.round, "session"))
            result = yield
            drop_idle_plugins(session.config)
            return result
        return (yield from self._run_copy(session, commission))

    def _run_copy(self, session: pytest.Session, commission: Commission) -> Generator[None, Any, Any]:
        """A copy of the fork server runs its job and ends."""
        from mutabot.inside.fork.copies import leave  # noqa: PLC0415  # see above

        status = int(pytest.ExitCode.INTERNAL_ERROR)
        try:
            self._take_on(session, commission)
            yield
            status = int(bool(session.testsfailed))
            self._say_goodbye(status)
        except BaseException as error:
            status = self._say_why(error)
        finally:
            leave(status)

    def _take_on(self, session: pytest.Session, commission: Commission) -> None:
        """Become the session of a job."""
        job = read_job(os.path.join(commission.home, "job.json"))
        self.job, self._server, self._pid = job, None, os.getpid()
        self._make_private(commission.home)
        self._pipe = pipe_of(job, commission.home, commission.descriptor)
        self.session.take_on(job, self._pipe)
        for line in self._held.lines:
            self._pipe.send(line)
        self._select(session.items)
        cache = getattr(session.config, "cache", None)
        if cache is not None:  # what one job keeps there, others must not find
            cache._cachedir = Path(commission.home, "cache")
        say_where_on_signal(commission.home)
        self._begin(commission.home)
        self.session.look_ahead()
        seeds.seed_all(seeds.derive(job.seed, job.round, "session"))

    def _say_why(self, error: BaseException) -> int:
        """A copy's tests were interrupted: its end, as pytest would tell it."""
        status = int(getattr(error, "returncode", None) or pytest.ExitCode.INTERRUPTED)
        if not isinstance(error, pytest.exit.Exception | pytest.Session.Interrupted | pytest.Session.Failed):
            traceback.print_exception(error)
            status = int(pytest.ExitCode.INTERNAL_ERROR)
        elif isinstance(error, pytest.exit.Exception):
            print(f"\n!!! {type(error).__module__}.{type(error).__qualname__}: {error}")
        self._say_goodbye(status)
        return status

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        """One test, its fixtures included."""
        self._ending, self._expected, self._outcome, self._reading = None, None, PASSED, Reading()
        self._pipe.send(TestStart(item.nodeid))
        limit = watched_by_faulthandler(item)
        if limit is not None:
            self._pipe.send(limit)
        seeds.seed_all(self.seed_of(item.nodeid))
        self._item = item
        self.footprints.start_test()
        self._start_clocks()
        self.session.start_test(item.nodeid)
        try:
            result = yield
        except BaseException as error:
            self._leave_if_branch(error)
            raise
        self._leave_if_branch(None)
        end = self._test_end(item.nodeid)
        self.session.end_test()
        self._pipe.send(end)
        if self.job.stop_at_kill and end.is_decided:
            item.session.shouldstop = "the mutant's verdict is known"
        return result

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """The fixtures of a test are next."""
        if self.session.trunk is not None:
            drop_idle_watchdog(item)

    @pytest.hookimpl(optionalhook=True, tryfirst=True)
    def pytest_timeout_set_timer(self, item: pytest.Item, settings: Any) -> None:
        """Pytest-timeout is about to watch a test: its thread leaves the process without a word."""
        if settings.method == "thread":
            self._pipe.send(watched(item.nodeid, settings.timeout, "pytest-timeout"))

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_call(self) -> None:
        """The test's fixtures are set up."""
        if self.session.returns is not None:
            self.session.returns.begin_call()

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_teardown(self) -> Generator[None, Any, Any]:
        """Before fixtures take the world down: take the probes."""
        self._reading = self.session.take_probes()
        if self._item is not None:
            self.footprints.take_fixtures(self._item)
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

    def _note_failure(self, ending: Ending) -> None:
        """The first failure counts; of several subtests, the first that is more than a refusal."""
        if self.job.no_oracle and ending.is_mere_check:
            return
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
            self.job.vocabulary,
            self.session.evidence,
        )

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, exitstatus: int) -> None:
        """Everything has run."""
        if self._server is None:
            self._say_goodbye(int(exitstatus))

    def _say_goodbye(self, status: int) -> None:
        """Say what is left to say, and goodbye."""
        self.session.finish()
        self._pipe.send(SessionEnd(status, self._collected, tuple(self._errors), self._not_private))

    def _start_clocks(self) -> None:
        self._started = (time.perf_counter(), time.process_time())

    def _become_branch(self) -> None:
        """In a branch, right after the fork: it finishes its test and takes down nothing that is shared."""
        die_with_parent(self._pid)
        self._start_clocks()
        meter = self.session.meter
        self._shared = meter.simulated if meter is not None else None
        assert self._item is not None
        keep_shared_fixtures(self._item)
        self.footprints.files.on_deed = self._leave_before
        gc.freeze()  # what is never looked at stays shared with the trunk
        # nobody reads a branch's traceback, and to lay one out takes longer than most branches
        self._item.config.option.tbstyle = "value"

    def _leave_before(self, deed: Deed) -> None:
        """A branch is about to do what the original does not, and what others would notice: it leaves."""
        test, mutant = self.session.test, self.session.branch
        try:
            self._pipe.send(Unbranched(test, (mutant or "",), f"with a mutant, it {deed}"))
        finally:
            os._exit(STOPPED)

    def _leave_if_branch(self, error: BaseException | None) -> None:
        """A branch has finished its test: report and go, without running anything of the trunk's."""
        mutant = self.session.branch
        if mutant is None:
            return
        code = BRANCH_FAILED
        try:
            if error is None:
                code = self._report_branch(mutant)
        finally:  # whatever happens, the trunk's code must not run on in this process
            os._exit(code)

    def _report_branch(self, mutant: str) -> int:
        """Say how the test of this branch ended; returns the exit code that tells the trunk."""
        end = self._test_end(self.session.test)
        sites = self.session.recorder.sites_of_trace() if end.outcome != FAILED else ()
        if end.outcome == FAILED:
            end = replace(
                end, trace=(), returned=(), moments=()
            )  # only survivors are compared with the original
        self._pipe.send(BranchEnd(mutant, end, sites, self._shared))
        return DECIDED if end.is_decided else ALIVE

    def _test_end(self, test: str) -> TestEnd:
        session, evidence, ending = self.session, self.session.evidence, self._ending
        wall, cpu = time.perf_counter() - self._started[0], time.process_time() - self._started[1]
        meter, returns = session.meter, session.returns
        assert meter is not None
        cause = ending or self._expected  # what a test said that it would do ends it as well
        ended_by_refusal = cause is not None and cause.refused is not None
        refusal = evidence.refusal
        if evidence.is_of_text and not ended_by_refusal:
            refusal = None
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
            invalid=evidence.invalid or _is_no_program(evidence, cause),
            refused=refusal,
            caught=refusal is not None and self._outcome == FAILED and not ended_by_refusal,
            hits=evidence.hits,
            acted=evidence.acted,
            away=evidence.away,
            partly=evidence.is_partial and not evidence.acted,
            example=evidence.example,
            operations=meter.operations,
            commands=session.commands,
            wall=wall,
            cpu=cpu,
            simulated=meter.simulated,
            trace=tuple(session.recorder.trace) if self.job.record else (),
            truncated=session.recorder.truncated,
            returned=tuple(returns.entries) if returns is not None and self.job.record else (),
            prepared=returns.prepared if returns is not None else 0,
            probes=self._reading.values,
            unread=self._reading.unread,
            footprint=self._footprint(),
            moments=tuple(session.along.entries) if self.job.record else (),
            reading=session.rehearsal.seconds,
            not_along=session.rehearsal.why_not,
        )

    def _footprint(self) -> Footprint | None:
        """What the test leaves; a branch that has failed has nothing to leave it to."""
        if not self.job.record or (self.session.branch is not None and self._outcome == "failed"):
            return None
        return self.footprints.of_test()


def read_job(file_name: str) -> Job:
    """The job in a file."""
    with open(file_name, encoding="utf-8") as file:
        job: Job = from_data(Job, json.load(file))
    return job


def pipe_of(job: Job, home: str, descriptor: int) -> Pipe:
    """The pipe of a job; a trunk shares it with its branches."""
    if job.branching is None:
        return Pipe(descriptor)
    return Pipe(descriptor, os.open(os.path.join(home, "lock"), os.O_RDWR | os.O_CREAT | os.O_CLOEXEC))


def drop_idle_plugins(config: pytest.Config) -> None:
    """Hypothesis's plugin imports all of hypothesis for its summary, even if no test has used it."""
    plugin = config.pluginmanager.get_plugin("hypothesispytest")
    if plugin is not None and "hypothesis" not in sys.modules:
        config.pluginmanager.unregister(plugin)


def _is_no_program(evidence: Evidence, ending: Ending | None) -> bool:
    """Whether a mutant of the program text made a text that is no program or no command."""
    if not evidence.is_of_text or ending is None:
        return False
    return ending.is_syntax or (evidence.is_unknown and ending.refused is not None)


class _Parent:
    """Stands for a next test in the same place: nothing above the present test is taken down for it."""

    def __init__(self, item: pytest.Item) -> None:
        self._chain = item.listchain()[:-1]

    def listchain(self) -> list[Any]:
        return self._chain


def keep_shared_fixtures(item: pytest.Item) -> None:
    """Let the teardown of this test take down what is the test's own, and nothing that others share."""
    state = item.session._setupstate
    teardown = state.teardown_exact

    def teardown_own(nextitem: pytest.Item | None) -> None:
        teardown(_Parent(item))  # type: ignore[arg-type]  # only its chain is looked at

    state.teardown_exact = teardown_own  # type: ignore[method-assign]  # in this process alone
