"""The processes below a test process: what it passes to them, and how their events are merged."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from mutabot.extensions import brought, package_of
from mutabot.model import events
from mutabot.model.activation import Activation
from mutabot.model.event_file import FOLDER
from mutabot.model.fold import ChildRecord, Children, FactsOfTest, calls_of, fold, is_alive
from mutabot.model.source_units import AS_TEXT, WHOLE, Executed, together
from mutabot.runtime.processes.environment import Announced, ProcessWatch, export_folder, write_wake
from mutabot.runtime.processes.member import is_member

if TYPE_CHECKING:
    from mutabot.model.job import Job
    from mutabot.runtime.session import Session

#: what processes of interest load
_JOIN = "mutabot.runtime.processes.member"


class Members:
    """The processes below one test process; every Python process that it starts takes part.

    Args:
        home: the home of the test process.
        session: its session.
        has_acted: whether the mutant changed anything before.

    Attributes:
        folder: where the members write.
        children: what they report.
    """

    def __init__(self, home: str, session: Session, *, has_acted: bool = False) -> None:
        self.folder = os.path.join(home, FOLDER)
        os.makedirs(self.folder, exist_ok=True)
        _write_wake(self.folder, session.job)
        self._session = session
        self._running = Announced(self.folder)
        self.children = Children(home, session.job.key)
        self._present: list[ChildRecord] = []
        self._texts: list[events.TextsSeen] = []
        self._unseen: set[str] = set()
        self._out_of_reach: list[events.OutOfReach] = []
        self._read: set[str] = set()
        self._acted = has_acted
        export_folder(self.folder)
        self._watch = ProcessWatch(self._report_unseen)

    def start_test(self, test: str) -> None:
        """Begin a test, during which earlier processes may still run."""
        self.children.number = self._running.begin(test)
        self._present = [record for record in self.children.records.values() if is_alive(record.began.pid)]

    def merged(self, end: events.TestEnd) -> events.TestEnd:
        """Return the end of the running test with what members did in it; an error if that is not known."""
        self._take_all()
        here = sorted(self._here(), key=lambda record: (record.name, record.began.time))
        job, watch, index_of = self._session.job, self._watch, self._session.recorder.index_of
        facts = FactsOfTest(job, index_of, self._acted, watch.codes, watch.signalled)
        end = self._with_recorded(fold(end, here, facts), here, facts)
        self._acted = self._acted or end.acted > 0
        for origin in (events.STARTED, events.FORKED):
            if places := {place for record in here if record.origin == origin for place in record.places}:
                self._session.writer.send(events.PlacesReached(end.test, tuple(sorted(places)), origin))
        end = replace(end, processes=tuple((record.began.pid, record.name) for record in here))
        for child in here:
            child.forget()
        read: Executed = dict.fromkeys(sorted(self._read), (AS_TEXT, WHOLE))
        self._read.clear()
        executed = together([end.executed, read]) if read else end.executed
        out_of_reach, self._out_of_reach = tuple(dict.fromkeys(self._out_of_reach)), []
        failure = end.failure or self.children.doubt
        return replace(end, failure=failure, executed=executed, out_of_reach=out_of_reach)

    def have_begun(self) -> bool:
        """Return whether any member has begun until now."""
        self._take_all()
        return bool(self.children.records)

    def texts_seen(self) -> list[events.TextsSeen]:
        """Return what members observed in the program text, over all tests."""
        self._take_all()
        return self._texts

    def _here(self) -> Iterable[ChildRecord]:
        """Return the processes that existed during the test."""
        present = {id(child) for child in self._present}
        number = self._running.number
        for record in self.children.records.values():
            if (
                id(record) in present
                or record.began.test == number
                or record.called
                or record.did
                or record.places
            ):
                yield record

    def _take_all(self) -> None:
        """Read new events, and handle those that concern the session rather than a test."""
        for event in self.children.read():
            match event:
                case events.Began(unable=why) if why is not None:
                    self._report_unseen(events.OutOfReach(" ".join(event.command[:3]), why, None))
                case events.OutOfReach():
                    self._report_unseen(event)
                case events.TextsSeen():
                    self._texts.append(event)
                case events.Signalled():
                    self._watch.signalled.add(event.pid)
                case events.Found():
                    for targets in self._session.targets:
                        targets.found_elsewhere(event.targets)
                    self._session.inspection.elsewhere.update(event.modules)
                    self._read.update(event.texts)
                case events.CallsAsked() | events.NotInstrumented() | events.Problem() | events.Remark():
                    self._session.writer.send(event)

    def _with_recorded(
        self, end: events.TestEnd, here: list[ChildRecord], facts: FactsOfTest
    ) -> events.TestEnd:
        """Return the end of a test whose recording has the calls of all processes by their times."""
        recorder, recording = self._session.recorder, self._session.recording
        if end.recording is None:
            return end
        found = [
            recorder.recorded_call(site, call.written, call.read, recording.since(call.time))
            for site, call in calls_of(here, facts)
        ]
        return replace(end, recording=recording.text([*recorder.recorded_calls(), *found])) if found else end

    def _report_unseen(self, process: events.OutOfReach) -> None:
        if is_member():  # a copy of the test process reports it by itself
            return
        self._out_of_reach.append(process)
        if process.command in self._unseen or not self._session.job.inspect:
            return
        self._unseen.add(process.command)
        text = f"nothing in this process is seen or mutated: {process.why}"
        self._session.writer.send(events.Remark("processes", process.command, text))


def _write_wake(folder: str, job: Job) -> None:
    names: set[str] = set()
    nodes = {package_of(module) for module in brought("middlewares")}  # what any node imports
    for operation in job.vocabulary.operations:
        names.update(nodes if operation.named is not None else [package_of(operation.target)])
    if job.vocabulary.clock is not None:
        names.add(package_of(job.vocabulary.clock.tick))
    awaited = {activation.awaits for activation in job.active.values()}
    modules = awaited - {Activation.AT_ONCE, Activation.FIRST_TEST, Activation.FIRST_TICK}
    names.update(map(package_of, modules))
    files = [os.path.realpath(os.path.join(job.root, path)) for path in (*job.program, *job.oracle)]
    for path in (*job.program, *job.oracle):
        names.update(part.removesuffix(".py") for part in path.split("/") if part not in (".", "..", ""))
    write_wake(folder, _JOIN, job.key, names, files)
