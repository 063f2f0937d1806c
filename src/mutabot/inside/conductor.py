"""The conductor: makes pytest run a job, and reports what becomes of each test."""

from __future__ import annotations

import ctypes
import json
import os
import select
import signal
import time
from collections.abc import Generator
from dataclasses import replace
from typing import Any

import pytest

from mutabot.model import BranchEnd, Branching, Job, SessionEnd, TestEnd, TestStart, from_data

from . import seeds
from .activate import Evidence
from .branch import ALIVE, DECIDED, FAILED, Trunk
from .classify import Ending, classify
from .limits import limit_memory
from .locate import Locator
from .no_oracle import NoOracle
from .pipe import Pipe
from .probes import take
from .session import Session

_PR_SET_PDEATHSIG = 1  # <linux/prctl.h>


class Conductor:
    """Pytest's hooks for one job."""

    def __init__(self, job: Job, pipe: Pipe) -> None:
        self.job = job
        self.locator = Locator(job.root, job.program, job.oracle)
        self.session = Session(job, pipe, self.locator.locate)
        self._pipe = pipe
        self._ending: Ending | None = None
        self._outcome = "passed"
        self._probes: dict[str, Any] = {}
        self._collected: tuple[str, ...] = ()
        self._errors: list[str] = []
        self._started = (0.0, 0.0)
        self._pid = os.getpid()
        self._shared: float | None = None
        self._item: pytest.Item | None = None
        self._no_oracle: NoOracle | None = None

    @classmethod
    def from_files(cls, job_file: str, descriptor: int) -> Conductor:
        """Read the job, set the limits of the process and put the interception in place."""
        die_with_parent()
        if nobody_listens(descriptor):  # the controller died before the kernel was asked
            os._exit(FAILED)
        home = os.path.dirname(job_file)
        with open(job_file, encoding="utf-8") as file:
            job = from_data(Job, json.load(file))
        if job.memory is not None:
            limit_memory(job.memory)
        seeds.seed_all(seeds.derive(job.seed, job.round, "session"))
        lock = None
        if job.branching is not None:
            lock = os.open(os.path.join(home, "lock"), os.O_RDWR | os.O_CREAT | os.O_CLOEXEC)
        conductor = cls(job, Pipe(descriptor, lock))
        conductor.session.install()
        if job.no_oracle:
            conductor.switch_off_checks()
        if job.branching is not None:
            conductor.grow(job.branching, os.path.join(home, "log.txt"))
        return conductor

    def grow(self, branching: Branching, log_file: str) -> None:
        """Be a trunk: fork a branch for every live mutant."""
        log = os.stat(log_file)
        self.session.trunk = Trunk(branching, self._pipe, (log.st_dev, log.st_ino), self._become_branch)

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
        if error is None or not evidence.is_of_text or not evidence.acted:
            return
        below = (f"{node}::", f"{node}/") if node not in ("", ".") else ("",)
        tests = [test for test in self.job.tests or () if test.startswith(below)]
        for test in tests[:1] if self.job.stop_at_kill else tests:
            file = os.path.join(self.job.root, test.partition("::")[0])
            ending = classify(error, "collect", file, self.locator, self.job.vocabulary, evidence)
            end = TestEnd(
                test, "failed", ending.by, ending.phase, ending.exception, ending.message, ending.place,
                failure=ending.failure, invalid=_is_no_program(evidence, ending),
                hits=evidence.hits, acted=evidence.acted, example=evidence.example,
            )  # fmt: skip
            self._pipe.send(end)

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Note what could not be collected."""
        if report.failed:
            self._errors.append(f"{report.nodeid}: {str(report.longrepr)[-1500:]}")

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        """One test, its fixtures included."""
        self._ending, self._outcome, self._probes = None, "passed", {}
        self._pipe.send(TestStart(item.nodeid))
        seeds.seed_all(self.seed_of(item.nodeid))
        self._item = item
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

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_teardown(self) -> Generator[None, Any, Any]:
        """Before fixtures take the world down: take the probes."""
        meter, self.session.meter = self.session.meter, None  # probes are no operations of the program's
        self._probes = take(self.job.vocabulary.probes)
        self.session.meter = meter
        return (yield)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_makereport(
        self, item: pytest.Item, call: pytest.CallInfo[None]
    ) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        """Note the first thing that ended the test."""
        report = yield
        if report.skipped and self._outcome == "passed":
            self._outcome = "skipped"
        if report.failed and self._outcome != "failed":
            ending = self._classified(item, call)
            if not self.job.no_oracle or (ending is not None and not ending.is_mere_check):
                self._outcome, self._ending = "failed", ending
        return report

    def _classified(self, item: pytest.Item, call: pytest.CallInfo[None]) -> Ending | None:
        """What ended the test; None if nothing was raised, as where a test passes that was to fail."""
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
        """Everything has run: say what is left to say, and goodbye."""
        self.session.finish()
        self._pipe.send(SessionEnd(int(exitstatus), self._collected, tuple(self._errors)))

    def _start_clocks(self) -> None:
        self._started = (time.perf_counter(), time.process_time())

    def _become_branch(self) -> None:
        """In a branch, right after the fork: it finishes its test and takes down nothing that is shared."""
        die_with_parent()
        if os.getppid() != self._pid:  # the trunk died before the kernel was asked
            os._exit(FAILED)
        self._start_clocks()
        meter = self.session.meter
        self._shared = meter.simulated if meter is not None else None
        assert self._item is not None
        keep_shared_fixtures(self._item)

    def _leave_if_branch(self, error: BaseException | None) -> None:
        """A branch has finished its test: report and go, without running anything of the trunk's."""
        mutant = self.session.branch
        if mutant is None:
            return
        code = FAILED
        try:
            if error is None:
                code = self._report_branch(mutant)
        finally:  # whatever happens, the trunk's code must not run on in this process
            os._exit(code)

    def _report_branch(self, mutant: str) -> int:
        """Say how the test of this branch ended; returns the exit code that tells the trunk."""
        end = self._test_end(self.session.test)
        sites = self.session.recorder.sites_of_trace() if end.outcome == "passed" else ()
        if end.outcome != "passed":
            end = replace(end, trace=())  # only survivors are compared with the original
        self._pipe.send(BranchEnd(mutant, end, sites, self._shared))
        return DECIDED if end.is_decided else ALIVE

    def _test_end(self, test: str) -> TestEnd:
        session, evidence, ending = self.session, self.session.evidence, self._ending
        wall, cpu = time.perf_counter() - self._started[0], time.process_time() - self._started[1]
        meter = session.meter
        assert meter is not None
        ended_by_refusal = ending is not None and ending.refused is not None
        refusal = str(evidence.refusal) if evidence.refusal is not None else None
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
            timeout=meter.exceeded,
            failure=evidence.failure or (ending.failure if ending else None),
            invalid=evidence.invalid or _is_no_program(evidence, ending),
            refused=refusal,
            caught=refusal is not None and self._outcome == "failed" and not ended_by_refusal,
            hits=evidence.hits,
            acted=evidence.acted,
            partly=evidence.is_partial and not evidence.acted,
            example=evidence.example,
            operations=meter.operations,
            commands=session.commands,
            wall=wall,
            cpu=cpu,
            simulated=meter.simulated,
            trace=tuple(session.recorder.trace) if self.job.record else (),
            truncated=session.recorder.truncated,
            probes=self._probes,
        )


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


def nobody_listens(descriptor: int) -> bool:
    """Whether the reading end of the pipe is gone."""
    poll = select.poll()
    poll.register(descriptor, select.POLLERR)
    return any(event & select.POLLERR for _, event in poll.poll(0))


def die_with_parent() -> None:
    """Ask the kernel to end this process when the controller dies, however that happens."""
    libc = ctypes.CDLL(None, use_errno=True)
    libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
