"""Tasks, results, and the interface of executors that run them.

An executor only runs what it is given, in worker processes on this machine or on others: which tasks there
are, and what their results mean, is the engines' business. A package brings another executor by a
``campaign.request.ExecutorChoice``.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Protocol

from mutabot.frozen import frozen
from mutabot.model import Span, events
from mutabot.model.codec import from_data, to_data
from mutabot.model.deadline import Limit
from mutabot.model.event_file import UNWRITTEN
from mutabot.model.job import Job

if TYPE_CHECKING:
    from mutabot.model.events import Event

#: pytest's exit statuses after which a run of the suite says nothing about its tests
ABNORMAL = {2: "it was interrupted", 3: "an internal error", 4: "a wrong command line or configuration"}
_ESCAPES = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07]*\x07|.)")
#: what pytest prints around a mistake explains nothing
_OF_NO_USE = re.compile(
    r"\s*(inifile|rootdir|configfile|cachedir|plugins|testpaths): |platform |collected \d|=+ .* =+$"
    r"|.*usage: .*\[options\]"
)
_LINES = 20


def tail_of(log: str) -> str:
    """Return the last lines of a process's output, in their own layout, to append to a message."""
    lines = [line.rstrip() for line in _ESCAPES.sub("", log).splitlines() if line.strip()]
    lines = [_without_frame(line) for line in lines if not _OF_NO_USE.match(line)] or lines
    if not lines:
        return ""
    return "; pytest said:" + "".join(f"\n  {line}" for line in lines[-_LINES:])


def _without_frame(line: str) -> str:
    """Return a line without the exclamation marks with which pytest fills it."""
    return line.strip("! ") if line.startswith("!!!") else line


def last_line(log: str) -> str:
    """Return the last line with text in it."""
    lines = [line.strip() for line in log.splitlines() if line.strip()]
    return lines[-1][:300] if lines else ""


#: seconds a worker may take until its first test begins, at least
STARTUP_SECONDS = 60.0


@frozen
class Task:
    """A job with what the controller needs to run it.

    Attributes:
        key: what the caller knows it by.
        job: the job.
        deadlines: what each test may take; tests that are missing get ``deadline``.
        deadline: the same for any other test.
        startup: the same until the first test begins.
        is_fork_parent: whether it forks: it then runs on a token of the pool.
        may_share: whether it may begin as a copy of a fork server instead of in a fresh process.
        alone: whether nothing may run beside it.
    """

    key: Any
    job: Job
    deadlines: Mapping[str, Limit] = field(default_factory=dict)
    deadline: Limit = Limit(600.0)
    startup: Limit = Limit(STARTUP_SECONDS)
    is_fork_parent: bool = False
    may_share: bool = False
    alone: bool = False

    def to_bytes(self) -> bytes:
        """Return the task as JSON, without its key, which has a meaning on this machine only."""
        return json.dumps(to_data(replace(self, key=None)), separators=(",", ":")).encode()

    @classmethod
    def of_bytes(cls, data: bytes) -> Task:
        """Return the task in the JSON of ``to_bytes``; its key is None."""
        return from_data(cls, json.loads(data))

    def in_folder(self, root: str) -> Task:
        """Return the task with the project in another folder, given by its absolute path."""
        return replace(self, job=replace(self.job, root=root))

    def only(self, mutants: Collection[str]) -> Task:
        """Return the task of the same fork parent with some of its mutants, given by their ids."""
        forking = self.job.forking
        assert forking is not None
        own = replace(
            forking,
            mutants=tuple(mutant for mutant in forking.mutants if mutant.id in mutants),
            keys={mutant: found for mutant, found in forking.keys.items() if mutant in mutants},
        )
        active = {mutant: found for mutant, found in self.job.active.items() if mutant in mutants}
        return replace(self, job=replace(self.job, forking=own, active=active))

    def without_mutant(self, test: str) -> Task:
        """Return the task with the original program, up to a test, given by its node id."""
        tests = self.job.tests or ()
        job = replace(
            self.job, tests=tests[: tests.index(test) + 1] if test in tests else tests, mutant=None,
            forking=None, active={}, stop_at_kill=False, instrumentation=None, record=False, evidence=False,
        )  # fmt: skip
        return replace(self, job=job, is_fork_parent=False, may_share=False)


@dataclass(slots=True)
class Result:
    """The result of a worker.

    Attributes:
        task: its task.
        sites, ends, problems: what it reported.
        acted: tests in which its mutant did something; the empty one stands for before any test.
        reached: places of the program text by test, likewise.
        reached_below: the same in processes below the tests, by their origin.
        called_at_import: the calls of operations before any test.
        seen: what a recording saw of the program text.
        not_instrumented: files whose mutants cannot run, with the reason.
        known_later: operations by sites at which only some tests show that they stand there.
        asked: which calls of the program were asked about, by each of its processes.
        in_mutated_call: whether it was in the midst of a mutated call when it was last heard of.
        held: tokens that it and its forks held when it was last heard of.
        running: test that was under way when it ended, or None.
        watched: limits of the suite's own that would end it during that test.
        end: its orderly end; None if there was none.
        exit_code: its exit code, negative for a signal.
        overdue: description of the limit of time that it exceeded, or None.
        hindered: why that says little of it, as the machine was busy; None if it was not.
        is_starved: whether it was ended although it had not had its time, as it would have taken too long.
        wall: seconds from its start to its end.
        log: the last lines it printed.
        lost: why no process could be had that runs it to its end, or None.
        untrusted: why what it reported cannot be relied on, or None.
    """

    task: Task
    sites: list[events.SiteSeen] = field(default_factory=list)
    ends: list[events.TestEnd] = field(default_factory=list)
    problems: list[events.Problem] = field(default_factory=list)
    acted: list[str] = field(default_factory=list)
    reached: dict[str, tuple[int, ...]] = field(default_factory=dict)
    reached_below: dict[str, dict[str, tuple[int, ...]]] = field(default_factory=dict)
    called_at_import: list[events.Called] = field(default_factory=list)
    seen: events.TextsSeen | None = None
    not_instrumented: dict[str, str] = field(default_factory=dict)
    known_later: dict[Span, str] = field(default_factory=dict)
    asked: list[events.CallsAsked] = field(default_factory=list)
    in_mutated_call: bool = False
    held: int = 0
    running: str | None = None
    watched: list[events.Watched] = field(default_factory=list)
    end: events.SessionEnd | None = None
    exit_code: int = 0
    overdue: str | None = None
    hindered: str | None = None
    is_starved: bool = False
    wall: float = 0.0
    log: str = ""
    lost: str | None = None
    untrusted: str | None = None

    def take(self, line: events.Event) -> None:  # noqa: PLR0912  # one case per kind of line is the clearest there is
        """Update the result by one event."""
        match line:
            case events.SiteSeen():
                self.sites.append(line)
            case events.TestStart():
                self.running = line.test
                self.watched.clear()
            case events.Watched():
                self.watched.append(line)
            case events.Acted(in_call=None):
                self.acted.append(line.test)
            case events.Acted(in_call=bool(in_call)):
                self.in_mutated_call = in_call
            case events.PlacesReached() if line.below:
                self.reached_below.setdefault(line.below, {})[line.test] = line.places
            case events.PlacesReached():
                self.reached[line.test] = line.places
            case events.Called():
                self.called_at_import.append(line)
            case events.TextsSeen():
                self.seen = line
            case events.NotInstrumented():
                self.not_instrumented[line.file] = line.reason
            case events.KnownLater():
                self.known_later[line.span] = line.operation
            case events.CallsAsked():
                self.asked.append(line)
            case events.TokensHeld():
                self.held = line.held
            case events.TestEnd():
                self.ends.append(line)
                self.running = None
            case events.Problem():
                self.problems.append(line)
            case events.SessionEnd():
                self.end = line
            case events.Untrusted() if self.untrusted is None:
                during = f" (during {self.running})" if self.running else ""
                self.untrusted = f"{line.reason}{during}"

    def death(self, *, with_message: bool = True) -> str:
        """Return how a process ended abnormally, and if ``with_message`` the last line it printed."""
        if self.lost is not None:
            return self.lost
        during = f" during {self.running}" if self.running else ""
        if self.overdue:
            return f"{self.overdue}{during}"
        line = last_line(self.log) if with_message else ""
        return f"{how_ended(self.exit_code)}{during}{f'; it said last: {line}' if line else ''}"

    def find_overdue(self, now: float) -> bool:
        """Note and return whether the suite's own limit ended the process by ``now`` (``time.monotonic``)."""
        if self.end is None and self.overdue is None and self.running is not None and self.exit_code == 1:
            self.overdue = next((watch.text for watch in self.watched if now >= watch.until), None)
            return self.overdue is not None
        return False


def how_ended(code: int) -> str:
    """Return how a process ended without a report, by its exit code."""
    if code == UNWRITTEN:
        return "the tests' process could not write its events: a full disk, or RLIMIT_FSIZE?"
    return f"killed by signal {-code}" if code < 0 else f"the process ended with exit code {code}"


class Executor(Protocol):
    """Runs a limited number of tasks at a time. Leaving its context ends those that still run.

    Attributes:
        spread: how many places share nothing, neither fork parents nor fork servers. Work for them is cut
            into parts, the longest first. 1 on one machine.
        remarks: what readers of the journal should know of where tasks ran.
    """

    @property
    def spread(self) -> int: ...

    @property
    def remarks(self) -> Sequence[str]: ...

    def run(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield results in the order in which tasks end. Tasks are taken when a place is free."""

    def events(self, tasks: Iterable[Task]) -> Iterator[Result | tuple[Task, Event]]:
        """Yield results and events as they come.

        A task whose job forks is a fork parent: the executor gives it and its forks the tokens by which
        they share its places with the other tasks. A task that is ``alone`` has nothing beside it.
        """

    def rest(self, is_awaited: Callable[[], bool], seconds: float) -> Iterator[Result | tuple[Task, Event]]:
        """After an interruption of ``events``, yield what fork parents report while they end their forks.

        It ends once they have reported all forks and nothing ``is_awaited`` any more, or when that takes much
        longer than these ``seconds``. There is nothing where forks cannot be heard of before their parents
        end.
        """

    def apart(self) -> AbstractContextManager[Executor]:
        """Return an executor for one task at a time, which shares nothing with tasks that run here."""
