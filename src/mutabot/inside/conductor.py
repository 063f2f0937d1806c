"""The conductor: makes pytest run a job, and reports what becomes of each test."""

from __future__ import annotations

import ctypes
import json
import signal
import time
from collections.abc import Generator
from typing import Any

import pytest

from mutabot.model import Job, SessionEnd, TestEnd, TestStart, from_data

from . import seeds
from .activate import Evidence
from .classify import Ending, classify
from .limits import limit_memory
from .locate import Locator
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

    @classmethod
    def from_files(cls, job_file: str, descriptor: int) -> Conductor:
        """Read the job, set the limits of the process and put the interception in place."""
        die_with_parent()
        with open(job_file, encoding="utf-8") as file:
            job = from_data(Job, json.load(file))
        if job.memory is not None:
            limit_memory(job.memory)
        seeds.seed_all(seeds.derive(job.seed, job.round, "session"))
        conductor = cls(job, Pipe(descriptor))
        conductor.session.install()
        return conductor

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
        self._started = (time.perf_counter(), time.process_time())
        self.session.start_test(item.nodeid)
        result = yield
        end = self._test_end(item.nodeid)
        self.session.end_test()
        self._pipe.send(end)
        if self.job.stop_at_kill and is_kill(end):
            item.session.shouldstop = "the mutant is killed"
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
            self._outcome = "failed"
            if call.excinfo is not None:
                self._ending = classify(
                    call.excinfo.value,
                    call.when,
                    str(item.path),
                    self.locator,
                    self.job.vocabulary,
                    self._evidence,
                )
        return report

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, exitstatus: int) -> None:
        """Everything has run: check the vocabulary if asked to, and say goodbye."""
        if self.job.inspect:
            self.session.inspect_targets()
        self._pipe.send(SessionEnd(int(exitstatus), self._collected, tuple(self._errors)))

    @property
    def _evidence(self) -> Evidence:
        activation = self.session.activation
        return activation.evidence if activation is not None else Evidence()

    def _test_end(self, test: str) -> TestEnd:
        session, evidence, ending = self.session, self._evidence, self._ending
        wall, cpu = time.perf_counter() - self._started[0], time.process_time() - self._started[1]
        meter = session.meter
        assert meter is not None
        refusal = str(evidence.refusal) if evidence.refusal is not None else None
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
            invalid=evidence.invalid,
            refused=refusal,
            caught=refusal is not None and self._outcome == "failed" and not (ending and ending.refused),
            hits=evidence.hits,
            acted=evidence.acted,
            example=evidence.example,
            operations=meter.operations,
            wall=wall,
            cpu=cpu,
            simulated=meter.simulated,
            trace=tuple(session.recorder.trace) if self.job.record else (),
            truncated=session.recorder.truncated,
            probes=self._probes,
        )


def is_kill(end: TestEnd) -> bool:
    """Whether this test alone decides that the mutant is killed (or timed out)."""
    if end.outcome != "failed" or end.failure is not None or end.invalid:
        return False
    return end.refused is None or end.caught


def die_with_parent() -> None:
    """Ask the kernel to end this process when the controller dies, however that happens."""
    libc = ctypes.CDLL(None, use_errno=True)
    libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
