"""A forked run: a process that was forked in the middle of a test, and goes on to the end as its mutant."""

from __future__ import annotations

import gc
import os
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from mutabot.model import Mutant
from mutabot.model.events import ForkSessionEnd, ForkTestEnd, TestEnd
from mutabot.model.job import write_job
from mutabot.runtime import test_end
from mutabot.runtime.audit import listen
from mutabot.runtime.isolation.fork_parent import DECIDED, ForkParent
from mutabot.runtime.processes.member import watch_forks
from mutabot.runtime.processes.members import Members

if TYPE_CHECKING:
    from mutabot.runtime.session import Session

_PROCESSES = {"subprocess.Popen", "os.posix_spawn", "os.system", "os.fork", "os.forkpty", "os.exec"}


class ForkedRun:
    """This process from its fork on.

    Args:
        session: the job at hand.
        parent: what has forked it.
        mutant: its mutant.
        folder: its own folder.

    Attributes:
        choices: what its mutant is in the program text.
        members: the processes below it; None until it starts one.
    """

    def __init__(self, session: Session, parent: ForkParent, mutant: Mutant, folder: str) -> None:
        self.mutant = mutant
        self.choices = parent.forking.choices.get(mutant.id, ())
        self.members: Members | None = None
        self._session, self._parent, self._folder = session, parent, folder
        self._pid = os.getpid()
        self._shared = session.meter.simulated if session.meter is not None else None
        self._is_early = not session.test
        self._has_acted = False
        gc.freeze()  # what is never looked at stays shared with the parent
        listen(_PROCESSES, self._hear)

    def start_test(self) -> None:
        """A test begins, its second at least."""
        self._parent.note_next_test(self.mutant.id)
        self._shared = None

    def end_test(self, end: TestEnd) -> None:
        """A test is over: tell how it ended, and leave if it decides about the mutant."""
        self._has_acted |= end.acted > 0
        if not end.is_decided or self._parent.forking.every_test:
            self._report(end)
            return
        try:
            self._report(end)
        finally:  # whatever happens, nothing must run on in this process
            os._exit(DECIDED)

    def finish(self, errors: list[str]) -> None:
        """The session is over: what its exit code is, the parent will tell."""
        self._parent.note_next_test(self.mutant.id)
        self._parent.note_finished(self.mutant.id)
        self._session.pipe.send(ForkSessionEnd((self.mutant.id,), errors=tuple(errors)))

    def _report(self, end: TestEnd) -> None:
        sites = self._session.recorder.sites_of(end.trace) if end.outcome != test_end.FAILED else ()
        if end.outcome == test_end.FAILED:  # only survivors are compared with the original
            end = replace(end, trace=(), returned=(), moments=())
        self._session.pipe.send(ForkTestEnd(self.mutant.id, end, sites, self._shared, self._is_early))

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        """The program is about to start its first process, which is to be the mutant as well."""
        if self.members is None and os.getpid() == self._pid:
            self.members = self._own_processes()

    def _own_processes(self) -> Members:
        session, job = self._session, self._session.job
        text = job.instrumentation
        if text is not None:
            text = text.only(tuple(self.choices))
        job = replace(job, mutant=self.mutant, forking=None, instrumentation=text)
        write_job(self._folder, replace(job, reaching={}))
        session.job = replace(job, forking=session.job.forking)
        members = Members(self._folder, session, has_acted=self._has_acted)
        members.start_test(session.test)
        watch_forks(members.folder, session)
        return members
