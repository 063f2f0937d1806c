"""A branch: a process that was forked in the middle of a test, and goes on to the end as its mutant.

Tests that are left out: those that do not reach the mutant, once one has reached it.

What they would have done is not known then: what is found without them is confirmed by the whole suite, or
said to be not. Fixtures live as long as in the whole suite.
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from mutabot.model.events import BranchEnd, BranchFinished, TestEnd, Unbranched
from mutabot.model.job import Job, write_job
from mutabot.runtime import test_end
from mutabot.runtime.isolation.fork_parent import DECIDED, FINISHED, STOPPED, Bunch
from mutabot.runtime.isolation.lifeline import die_with_parent
from mutabot.runtime.processes.member import watch_forks
from mutabot.runtime.processes.members import Members
from mutabot.runtime.seeds import node_id
from mutabot.runtime.session import Session


class LeftOut:
    """Which tests this process leaves out, and pytest's hook by which it does."""

    def __init__(self) -> None:
        self._left_out: frozenset[str] = frozenset()

    def become(self, job: Job, mutants: Iterable[str]) -> None:
        """This process is these mutants from now on: what reaches one of them is run."""
        self._left_out = frozenset.intersection(*(job.left_out(mutant) for mutant in mutants))

    def is_next(self, test: str) -> bool:
        """Whether the test that is about to begin is left out."""
        return test in self._left_out

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item, nextitem: pytest.Item | None) -> bool | None:
        """In place of running such a test: take down what ends with it."""
        if not self.is_next(node_id(item)):
            return None
        item.session._setupstate.teardown_exact(nextitem)
        return True


_PROCESSES = {"subprocess.Popen", "os.posix_spawn", "os.system", "os.fork", "os.forkpty", "os.exec"}


class BranchOfSession:
    """What a fork of the parent does to be its mutant; see ``runtime.isolation.fork_parent.Branch``.

    Args:
        session: the job at hand.
        start_clocks: lets what the test takes count from now on.

    Attributes:
        config: pytest's configuration; None until it reads the first of the user's code.
        errors: what could not be collected.
        members: the processes below a branch; None if it has started none.
        left_out: the tests that it does not run.
    """

    def __init__(self, session: Session, start_clocks: Callable[[], None]) -> None:
        self.config: pytest.Config | None = None
        self.errors: list[str] = []
        self.members: Members | None = None
        self.left_out = LeftOut()
        self._session = session
        self._start_clocks = start_clocks
        self._trunk = 0
        self._bunch: Bunch | None = None
        self._shared: float | None = None
        self._hears = self._has_acted = self._is_early = False

    def expect(self) -> None:
        """This process is a trunk from now on."""
        self._trunk = os.getpid()

    @property
    def is_one(self) -> bool:
        """Whether this process is a branch."""
        return self._bunch is not None

    def begin(self) -> None:
        """Right after the fork."""
        die_with_parent(self._trunk)
        self._start_clocks()
        meter = self._session.meter
        self._shared = meter.simulated if meter is not None else None
        gc.freeze()  # what is never looked at stays shared with the trunk
        if self.config is not None:
            # nobody reads a branch's traceback, and to lay one out takes longer than most branches
            self.config.option.tbstyle = "value"

    def become(self, bunch: Bunch, folder: str) -> None:
        """Go on from here as these mutants; ``folder`` is this process's own."""
        self._is_early = self._is_early or not self._session.test
        self._bunch, self._trunk, self._folder = bunch, os.getpid(), folder  # from which others may part
        self.left_out.become(self._session.job, [mutant.id for mutant in bunch.mutants])
        cache = getattr(self.config, "cache", None)
        if cache is not None:  # what one process keeps there, others must not find
            cache._cachedir = Path(folder, "cache")
        if not self._hears:
            self._hears = True
            sys.addaudithook(self._hear)
        self._session.become(bunch)

    def start_test(self) -> None:
        """A test begins, which is a branch's second at least."""
        if self._bunch is not None:
            self._bunch.next_test()
            self._bunch.waited = 0.0
            self._shared = None

    def end_test(self, end: TestEnd) -> None:
        """A test is over: a branch tells so, and leaves if it decides about its mutant."""
        if self._bunch is None:
            return
        self._has_acted |= end.acted > 0
        job = self._session.job
        if job.branching is not None and end.is_decided and not job.branching.every_test:
            try:
                self._report(self._bunch, end, self._bunch.end(DECIDED))
            finally:  # whatever happens, nothing must run on in this process
                os._exit(DECIDED)
        self._report(self._bunch, end, self._bunch.known)

    def finish(self) -> None:
        """The session is over: what its exit code is, the parent will tell."""
        if self._bunch is not None:
            self._bunch.next_test()
            mutants = tuple(self._bunch.end(FINISHED))
            self._session.pipe.send(BranchFinished(mutants, errors=tuple(self.errors)))

    def give_up(self, mutants: Sequence[str], reason: str) -> None:
        """Leave its mutants to a process of their own."""
        try:
            self._session.pipe.send(Unbranched(self._session.test, tuple(mutants), reason))
        finally:
            os._exit(STOPPED)

    def _report(self, bunch: Bunch, end: TestEnd, mutants: Sequence[str]) -> None:
        """Say how a test of this branch ended."""
        sites = self._session.recorder.sites_of(end.trace) if end.outcome != test_end.FAILED else ()
        if end.outcome == test_end.FAILED:  # only survivors are compared with the original
            end = replace(end, trace=(), returned=(), moments=())
        each = 1 / len(mutants)  # they share what it took
        end = replace(end, wall=max(0.0, end.wall - bunch.waited) * each, cpu=end.cpu * each)
        for number, mutant in enumerate(mutants):  # the first one was simulated, for all of them
            shared = end.simulated if number else self._shared
            self._session.pipe.send(BranchEnd(mutant, end, sites, shared, self._is_early))

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        """The program of a branch is about to start a process, which is to be the mutant as well."""
        if event not in _PROCESSES or self._bunch is None or self._bunch.is_parting:
            return
        if self.members is None or os.getpid() != self._trunk:
            if os.getpid() != self._trunk:  # a process that the test has forked
                return
            self._bunch.part_all()  # in those that part, it is another bunch
            self.members = self._own_processes(self._bunch)

    def _own_processes(self, bunch: Bunch) -> Members:
        session, job = self._session, self._session.job
        text = job.instrumentation
        if text is not None:
            text = text.only(tuple(bunch.choices[bunch.first.id]))
        job = replace(job, mutant=bunch.first, branching=None, instrumentation=text)
        write_job(self._folder, replace(job, reaching={}))
        session.job = replace(job, branching=session.job.branching)
        members = Members(self._folder, session, has_acted=self._has_acted)
        members.start_test(session.test)
        watch_forks(members.folder, session)
        return members
