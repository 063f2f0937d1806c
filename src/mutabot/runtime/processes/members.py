"""The test process's side: what it gives to processes below it, and what it makes of what they tell.

What a process below the tests tells of calls, at once.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from mutabot.extensions import brought
from mutabot.model import Call
from mutabot.model.event_file import FOLDER
from mutabot.model.events import (
    Began,
    Called,
    Event,
    Found,
    Noted,
    NotInstrumented,
    PlacesReached,
    Problem,
    Remark,
    Signalled,
    TestEnd,
    TextsSeen,
)
from mutabot.model.fold import ChildRecord, Children, Known, calls_of, fold, is_alive
from mutabot.model.job import Job
from mutabot.model.quantity import Value
from mutabot.runtime.event_file import EventFile
from mutabot.runtime.processes.environment import Exits, Now, carry, watch_unseen, write_wake
from mutabot.runtime.session import Session

#: what processes of interest load
_JOIN = "mutabot.runtime.processes.member"


class Members:
    """The processes below one test process; from now on, every Python that it starts finds its way here.

    Args:
        home: the home of the test process.
        session: its session.
        has_acted: whether the mutant changed anything before.

    Attributes:
        folder: where the members write.
    """

    def __init__(self, home: str, session: Session, *, has_acted: bool = False) -> None:
        self.folder = os.path.join(home, FOLDER)
        os.makedirs(self.folder, exist_ok=True)
        _write_wake(self.folder, session.job)
        self._session = session
        self._now = Now(self.folder, is_host=True)
        self._children = Children(home, session.job.key)
        self._exits = Exits()
        self._present: list[ChildRecord] = []
        self._texts: list[TextsSeen] = []
        self._unseen: set[str] = set()
        self._acted = has_acted
        carry(self.folder)
        self._exits.watch()
        if session.job.inspect:
            watch_unseen(self._say_unseen)

    def start_test(self, test: str) -> None:
        """A test begins: some may be there from before."""
        self._now.begin(test)
        self._present = [one for one in self._children.records.values() if is_alive(one.began.pid)]

    def merged(self, end: TestEnd) -> TestEnd:
        """The end of the running test with what members did in it; an error if that cannot be known."""
        self._take_all()
        here = sorted(self._here(), key=lambda one: (one.name, one.began.time))
        known = self._known()
        end = self._with_recorded(fold(end, here, known), here, known)
        self._acted = self._acted or end.acted > 0
        if places := {place for one in here for place in one.places}:
            self._session.pipe.send(PlacesReached(end.test, tuple(sorted(places)), elsewhere=True))
        end = replace(end, processes=tuple((one.began.pid, one.name) for one in here))
        for one in here:
            one.forget()
        return end if self.doubt is None else replace(end, failure=end.failure or self.doubt)

    def have_begun(self) -> bool:
        """Whether there has been any until now."""
        self._take_all()
        return bool(self._children.records)

    @property
    def doubt(self) -> str | None:
        """Why what members told cannot be relied on, or None."""
        return self._children.doubt

    def texts_seen(self) -> list[TextsSeen]:
        """What members saw of the program text, over all tests."""
        self._take_all()
        return self._texts

    def _here(self) -> Iterable[ChildRecord]:
        """Those that were there during the test."""
        present = {id(one) for one in self._present}
        number = self._now.number
        for one in self._children.records.values():
            if id(one) in present or one.began.test == number or one.called or one.did or one.places:
                yield one

    def _known(self) -> Known:
        session = self._session
        return Known(
            session.job,
            session.recorder.index_of,
            self._acted,
            self._exits.codes,
            self._exits.signalled,
        )

    def _take_all(self) -> None:
        for event in self._children.read():
            self._take(event)

    def _take(self, event: Event) -> None:
        """What concerns the session, and no test alone."""
        match event:
            case Began(unable=why) if why is not None and self._session.job.inspect:
                self._say_unseen(" ".join(event.command[:3]), why)
            case TextsSeen():
                self._texts.append(event)
            case Signalled():
                self._exits.signalled.add(event.pid)
            case Found():
                self._session.interception.found_elsewhere(event.targets)
                self._session.inspection.elsewhere.update(event.modules)
            case NotInstrumented() | Problem() | Remark():
                self._session.pipe.send(event)
            case _:
                pass

    def _with_recorded(self, end: TestEnd, here: list[ChildRecord], known: Known) -> TestEnd:
        """The calls of all processes by their times, in what is recorded."""
        recorder, recording = self._session.recorder, self._session.recording
        if end.recording is None:
            return end
        found = [
            recorder.told_of(site, call.written, call.read, recording.since(call.time))
            for site, call in calls_of(here, known)
        ]
        return replace(end, recording=recording.text([*recorder.told(), *found])) if found else end

    def _say_unseen(self, name: str, why: str) -> None:
        if name in self._unseen:
            return
        self._unseen.add(name)
        text = f"nothing in this process is seen or mutated: {why}"
        self._session.pipe.send(Remark("processes", name, text))


def _write_wake(folder: str, job: Job) -> None:
    names: set[str] = set()
    nodes = {_top(module) for module in brought("middlewares")}  # what any node imports
    for operation in job.vocabulary.operations:
        names.update(nodes if operation.named is not None else [_top(operation.target)])
    if job.vocabulary.clock is not None:
        names.add(_top(job.vocabulary.clock.tick))
    files = [os.path.realpath(os.path.join(job.root, path)) for path in (*job.program, *job.oracle)]
    for path in (*job.program, *job.oracle):
        names.update(part.removesuffix(".py") for part in path.split("/") if part not in (".", "..", ""))
    write_wake(folder, _JOIN, names, files)


def _top(target: str) -> str:
    return target.partition(":")[0].partition(".")[0]


class CallsTold:
    """Writes down what a session sees of calls, from now on.

    Args:
        session: the session.
        file: where it is told.
        poll: tells what the mutant did.
    """

    def __init__(self, session: Session, file: EventFile, poll: Callable[[], None]) -> None:
        self._session, self._file, self._poll = session, file, poll
        self._found: set[str] = set()
        session.recorder.on_hit = self._hit
        session.on_refused, session.on_live = self._refused, self._is_live
        session.passing.on_end = self._after
        for targets in session.interception.kinds:
            if targets.on_heard is not None:
                targets.on_heard = partial(self._heard, targets.on_heard)

    def tell_found(self) -> None:
        """Tell of targets that were found since the last time."""
        targets = self._session.interception.found - self._found
        if targets:
            self._found |= targets
            for operation in self._session.job.vocabulary.operations:
                if operation.target in targets:
                    self._session.inspection.check_target(operation, self._session.interception)
            self._file.send(Found(targets=tuple(sorted(targets))))

    def _hit(self, site: int, written: Any, read: Any, answer: Any) -> None:
        self._file.send(Called(site, written, read, answer, time.monotonic()))

    def _refused(self, site: int, number: int) -> None:
        self._file.send(Noted(site, number))

    def _is_live(self, site: int) -> None:
        self._file.send(Noted(site))

    def _after(self, call: Call, read: Mapping[str, Value]) -> None:
        self._poll()

    def _heard(self, heard: Callable[[str, Any], None], name: str, message: Any) -> None:
        before = self._session.evidence.said
        heard(name, message)
        if self._session.evidence.said != before:
            self._poll()
