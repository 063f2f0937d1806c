"""A process below the tests that is part of a campaign and runs the session of its job.

It finds, mutates and records calls as the test process does. What it sees goes into its own file at once.
Which test runs is looked up at each call, since a process may outlive the test that started it. Of a job
without operations it runs the program text alone.
"""

from __future__ import annotations

import atexit
import os
import sys
import threading
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from functools import partial
from sys import _getframe
from typing import TYPE_CHECKING, Any

from mutabot.errors import text_of
from mutabot.model import events
from mutabot.model.clocks import monotonic
from mutabot.model.event_file import ANY_PROCESS
from mutabot.model.job import Job, read_job
from mutabot.runtime import FOLDER as OURS
from mutabot.runtime import executed_text
from mutabot.runtime.activity import Activity
from mutabot.runtime.event_file import EventFile
from mutabot.runtime.exceptions import failure_in, is_due_to, leaves
from mutabot.runtime.meter import Meter, TimeExceeded
from mutabot.runtime.paths import watch_copies
from mutabot.runtime.processes.commands import STARTS, starts_a_killer
from mutabot.runtime.processes.environment import (
    PREPARED,
    PREPARES,
    Now,
    export_folder,
    listen,
    out_of_reach,
)  # fmt: skip
from mutabot.runtime.program_text.instrument import SessionText
from mutabot.runtime.program_text.loading import hook_script
from mutabot.runtime.program_text.text_mutant import TextMutant
from mutabot.runtime.text_reads import TextReads

if TYPE_CHECKING:
    from mutabot.runtime.event_file import EventWriter
    from mutabot.runtime.session import Session  # of no use to a job that has nothing to do with calls


class TextOnly:
    """A session of a job that concerns the program text alone.

    Args:
        job: what to do.
        writer: where reports go.

    Attributes:
        text: the program text, if it is instrumented.
        test: node id of the running test.
        meter: what the running test has used.
        commands, is_fork: of calls there are none.
        seconds: there is no clock.
    """

    commands = 0
    is_fork = False
    seconds: float | None = None

    def __init__(self, job: Job, writer: EventWriter) -> None:
        self.job, self.writer = job, writer
        self.text: SessionText | None = None
        self.test = ""
        self.meter = Meter()
        self._fault: TextMutant | None = None

    def install(self) -> None:
        """Instrument the program from now on, with the mutant."""
        self.text = SessionText.of(self.job, self.writer, self.acted)
        if self.job.mutant is not None:
            activation = self.job.active[self.job.mutant.id]
            self._fault = TextMutant(self.job.mutant, activation.data, self)
            self._fault.prepare_process()

    def start_test(self, test: str) -> None:
        """Begin a test."""
        self.test = test
        self.meter = Meter()
        if self.text is not None:
            self.text.start_test(test)

    def look_back(self, *, at_all: bool = False) -> None:
        """Do nothing, as no mutant has passed on a copy."""

    @property
    def activity(self) -> Activity:
        """What the mutant did in the running test."""
        return self._fault.activity if self._fault is not None else Activity()

    @property
    def round(self) -> int:
        """The round, from 0."""
        return self.job.round

    def untracked(self) -> AbstractContextManager[None]:
        """Do nothing, as no calls are tracked."""
        return nullcontext()

    def change_file(self, path: str, content: bytes) -> None:
        """Do nothing, as the test process has changed the file."""

    def acted(self) -> None:
        """Report that the mutant changed something for the first time in a test."""
        self.writer.send(events.Acted(self.test))


#: events of a session that are written down as they are
_AS_THEY_ARE = (
    events.Acted, events.NotInstrumented, events.Problem, events.Remark, events.SiteSeen, events.TextsSeen,
)  # fmt: skip
#: the member that this process is; None in all others
_member: Member | None = None


def join(folder: str) -> None:
    """Join the campaign whose processes have this folder."""
    global _member  # noqa: PLW0603  # one process, one member
    if _member is None:
        job = read_job(os.path.dirname(folder))
        _member = Member(folder, job)
        _member.begin()


def is_member() -> bool:
    """Return whether the tests started this process, rather than being run in it."""
    return _member is not None


class Member:
    """This process as part of a campaign, to which its session sends events.

    Args:
        folder: the folder of the campaign's processes.
        job: the job of the test process.
        session: the session that goes on, in a process that was forked; None to make one.
    """

    def __init__(self, folder: str, job: Job, session: Session | TextOnly | None = None) -> None:
        self._folder = folder
        self._now = Now(folder)
        self._test = self._now.number
        now = monotonic()
        name = f"{os.getpid()}-{int(now * 1e6)}"
        self.event_file = EventFile(folder, name, job.key, self._now.note_unwritten)
        command = tuple(getattr(sys, "orig_argv", sys.argv))
        is_forked = session is not None
        self.event_file.send(
            events.Began(os.getpid(), os.getpgrp(), command, now, self._test, forked=is_forked)
        )
        if session is None:
            watch_copies(job.root, job.program, self._now.began)
            executed_text.install()
        self.session = session or _session(job, self)
        self._targets: set[str] = set()
        self._reported = Activity()
        self._acted = 0
        self._places: set[int] = set()
        self._texts: set[str] = set()
        self._exceeded = False
        self._is_over = False

    def begin(self) -> None:
        """Start the session."""
        export_folder(self._folder)
        self.session.install()
        hook_script()
        self._attend()
        self.session.start_test(self._now.name_of(self._test))
        self._watch_text()

    def go_on(self) -> None:
        """Continue with the parent's session in a process that was forked, and report it."""
        session = self.session
        for site in () if isinstance(session, TextOnly) else session.recorder.sites:
            self.event_file.send(site)
        self._reported = session.activity.copy()
        if session.meter is not None:
            session.meter.continue_in_copy()
        self._attend()
        session.writer, session.is_fork = self, False  # it reports its own sites, also below a fork
        if session.text is not None:
            session.text.writer = self
        self._watch_text()

    def _attend(self) -> None:
        session = self.session
        watch_forks(self._folder, session)
        if not isinstance(session, TextOnly):
            self._watch_calls(session)
        atexit.register(self.end)
        self._watch_exits()
        if session.job.is_of_original:
            TextReads(session.job.root, self._read).install()

    def _watch_calls(self, session: Session) -> None:
        """Report each call that the session records."""

        def hit(site: int, written: Any, read: Any, answer: Any) -> None:
            self.event_file.send(events.Called(site, written, read, answer, monotonic()))

        def heard(hear: Callable[[str, Any], None], name: str, message: Any) -> None:
            before = session.activity.refusing_answer
            hear(name, message)
            if session.activity.refusing_answer != before:
                self.poll()

        session.recorder.on_hit, session.dispatcher.turn = hit, self.turn
        session.dispatcher.on_end = lambda call, read: self.poll()
        session.on_noted = self.event_file.send
        messages = session.messages
        if messages is None:
            return
        messages.on_node = lambda name: self.event_file.send(events.Found(nodes=(name,)))
        if messages.on_heard is not None:
            messages.on_heard = partial(heard, messages.on_heard)

    def _read(self, name: str, is_text: bool) -> None:
        """Report a file that this process reads as text."""
        if is_text and _member is self and name not in self._texts:
            self._texts.add(name)
            self.event_file.send(events.Found(texts=(name,)))

    def turn(self) -> None:
        """Check whether another test has begun."""
        if self._now.number != self._test:
            self._take_away()
            self.poll()
            self._use()
            self._test = self._now.number
            self._reported, self._acted, self._exceeded = Activity(), 0, False
            self._places.clear()
            self.session.start_test(self._now.name_of(self._test))

    def _take_away(self) -> None:
        """End the test for the mutant."""
        self.session.look_back(at_all=True)
        if not isinstance(self.session, TextOnly):
            self.session.fault.end_test()

    def send(self, line: events.Event) -> None:
        """Send an event of the session, if it is new."""
        match line:
            case events.Acted(in_call=None):
                self.poll()
            case events.PlacesReached():
                self._reached(line.places)
            case _ if isinstance(line, _AS_THEY_ARE):  # the test process reports its tests itself
                self.event_file.send(line)

    def poll(self) -> None:
        """Report what the mutant did, and which targets were found, since the last report."""
        session = self.session
        now, before = session.activity, self._reported
        if now.hits != before.hits or now != before:
            self._reported = now.copy()
            self.event_file.send(self._did(before, now))
        if not isinstance(session, TextOnly):
            self._report_found(session)
        meter = session.meter
        is_ended = meter is not None and (meter.exceeded is not None or meter.guarded is not None)
        if is_ended and not self._exceeded:
            self._exceeded = True
            self._use()

    def _report_found(self, session: Session) -> None:
        """Report targets that were found since the last report."""
        targets = {name for kind in session.targets for name in kind.here()} - self._targets
        if not targets:
            return
        self._targets |= targets
        for operation in session.job.vocabulary.operations:
            if operation.target in targets:
                session.inspection.check_target(operation, session.targets)
        self.event_file.send(events.Found(targets=tuple(sorted(targets))))

    def _did(self, before: Activity, now: Activity) -> events.Did:
        away = {why: count - before.away.get(why, 0) for why, count in now.away.items()}
        # an evaluation that began before the process was copied is no change of the copy: it takes none back
        acted = max(now.acted - before.acted, -self._acted)
        self._acted += acted
        is_refused = now.refusals != before.refusals or now.refusing_answer != before.refusing_answer
        return events.Did(
            self.session.test,
            hits=now.hits - before.hits,
            acted=acted,
            away={why: count for why, count in away.items() if count},
            example=now.example if before.example is None else None,
            failure=now.failure if before.failure is None else None,
            refused=now.refusal if is_refused and not now.is_of_text else None,
            is_final=now.refusing_answer is not None,
        )

    def _use(self) -> None:
        meter = self.session.meter
        if meter is not None:
            used = meter.operations, self.session.commands, meter.simulated
            self.event_file.send(events.Used(*used, meter.exceeded, meter.guarded))

    def _watch_text(self) -> None:
        """Report places of the program text as they are reached, since the process may end at any time."""
        text = self.session.text
        if text is None:
            return
        if text.sightings is not None:
            text.sightings.report_first(lambda place: self._reached((place,)))
        else:
            text.alternatives.on_first = lambda place: self.poll()
            text.alternatives.on_idle = self._take_back

    def _take_back(self) -> None:
        """Report that an alternative changed nothing, if it was reported while that was not known."""
        if self.session.activity.acted < self._reported.acted:
            self.poll()

    def _reached(self, places: tuple[int, ...]) -> None:
        self.turn()
        new = set(places) - self._places
        if new:
            self._places |= new
            self.event_file.send(events.PlacesReached(self.session.test, tuple(sorted(new))))

    def _own_failure(self, error: BaseException) -> str | None:
        return None if isinstance(self.session, TextOnly) else self.session.failure_in(error)

    def end(self) -> None:
        """Report what remains, as the process ends."""
        if self._is_over or _member is not self:
            return
        self._is_over = True
        self._take_away()
        self.poll()
        self._use()
        if self.session.text is not None:
            self.session.text.finish()
        if not isinstance(self.session, TextOnly) and self.session.job.record:
            self.event_file.send(self.session.intercepted_calls())
        self.event_file.send(events.Found(modules=tuple(sorted(self._modules_of_vocabulary()))))
        self.event_file.send(events.SessionEnd())

    def _modules_of_vocabulary(self) -> set[str]:
        vocabulary = self.session.job.vocabulary
        names = [operation.target for operation in vocabulary.operations if operation.named is None]
        names += [*vocabulary.refusals, *vocabulary.checks, *vocabulary.failures]
        names += [name for operation in vocabulary.operations for name in operation.refusals]
        return {module for name in names if (module := name.partition(":")[0]) in sys.modules}

    def _watch_exits(self) -> None:
        """Report uncaught exceptions, ends by ``os._exit``, and signals to other processes."""
        main, thread, leave = sys.excepthook, threading.excepthook, os._exit

        def in_main(kind: type[BaseException], error: BaseException, traceback: Any) -> None:
            self._raised(error, in_thread=False)
            main(kind, error, traceback)

        def in_thread(arguments: Any) -> None:
            if arguments.exc_value is not None:
                self._raised(arguments.exc_value, in_thread=True)
            thread(arguments)

        def leave_at_once(status: int) -> None:
            self.end()
            leave(status)

        sys.excepthook, threading.excepthook = in_main, in_thread
        os._exit = leave_at_once  # type: ignore[assignment]
        listen(("os.kill", "os.killpg", PREPARED, *STARTS), self._on_audit_event)

    def _on_audit_event(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event in ("os.kill", "os.killpg") and _member is self:
            self.event_file.send(events.Signalled(-arguments[0] if event == "os.killpg" else arguments[0]))
        elif event == PREPARED and _member is self and arguments[0] is not None:
            self._raised(arguments[0], in_thread=False)
        if event in ("os.exec", PREPARED) and _member is self:
            self.end()
        if _member is self and starts_a_killer(event, arguments):
            self.event_file.send(events.Signalled(ANY_PROCESS))
        if _member is self and (process := out_of_reach(event, arguments)):
            self.event_file.send(process)

    def _raised(self, error: BaseException, *, in_thread: bool) -> None:
        if isinstance(error, KeyboardInterrupt | SystemExit) or _member is not self:
            return
        self.poll()
        first = leaves(error)[0]
        if isinstance(first, TimeExceeded):
            return
        self.event_file.send(
            events.Raised(
                f"{type(first).__qualname__}: {text_of(first)[:2000].strip()}",
                is_refusal=is_due_to(error, self.session.activity.culprits),
                failure=failure_in(error, self.session.job.vocabulary.failures) or self._own_failure(error),
                in_thread=in_thread,
            )
        )


def _session(job: Job, writer: Member) -> Session | TextOnly:
    text = job.instrumentation
    if text is not None and job.mutant is None and not text.record:
        text = None  # those below a fork parent are the original, and do not fork mutants
    job = replace(job, inspect=False, moments={}, evidence=False, instrumentation=text)
    if job.is_of_text:
        return TextOnly(job, writer)
    from mutabot import extensions  # noqa: PLC0415  # see above
    from mutabot.runtime.interception.trace import Locator  # noqa: PLC0415
    from mutabot.runtime.session import Session  # noqa: PLC0415

    extensions.use(job.extensions)
    return Session(job, writer, Locator(job.root, job.program, job.oracle))


_watched: tuple[str, Session | TextOnly] | None = None


def watch_forks(folder: str, session: Session | TextOnly) -> None:
    """Make each process that the program forks from this one a member of its own."""
    global _watched  # noqa: PLW0603  # hooks cannot be taken back: the last one watched counts
    if _watched is None:
        os.register_at_fork(after_in_child=_after_fork)
        listen((PREPARES,), lambda event, arguments: _begin_copy())
    _watched = folder, session


def _after_fork() -> None:
    if not _getframe(1).f_code.co_filename.startswith(OURS):
        _begin_copy()


def _begin_copy() -> None:
    """Begin a member in a process that the program has forked."""
    global _member  # noqa: PLW0603  # see above
    if _watched is not None:
        folder, session = _watched
        _member = Member(folder, session.job, session)
        _member.go_on()
