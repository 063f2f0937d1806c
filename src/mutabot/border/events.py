"""Events: what the processes of a job tell, each in a file of its own, see ``event_file``.

The test process, its forks and the processes below the tests tell them alike. Times are those of
``time.monotonic``, which all processes share.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, get_args

from mutabot.model.alternative import Sighting
from mutabot.model.site import Span

from .codec import from_data, to_data
from .test_end import TestEnd


@dataclass(frozen=True, slots=True)
class SiteSeen:
    """A site was reached for the first time in this session; traces refer to it by ``index``.

    ``direct`` is whether the call that stands there is that of the operation itself, rather than of something
    that leads to it; only the baseline finds out.
    """

    index: int
    span: Span
    operation: str
    pattern: str | None
    oracle: bool
    direct: bool = False


@dataclass(frozen=True, slots=True)
class TestStart:
    """A test begins: its fixtures are next."""

    __test__ = False

    test: str


@dataclass(frozen=True, slots=True)
class Watched:
    """The suite itself ends this process with exit code 1 if a test takes too long.

    Attributes:
        test: the test.
        until: from when on, by the clock of ``time.monotonic``, which all processes share.
        text: the limit, in words.
    """

    test: str
    until: float
    text: str


@dataclass(frozen=True, slots=True)
class Acted:
    """The mutant is at work: proof that mutated code ran.

    Attributes:
        test: the test; empty for a mutant of the program text before any test began.
        in_call: whether a mutated call begins, or has ended, which tells whether a process died in it; None
            where the mutant changed something for the first time in this test.
    """

    test: str
    in_call: bool | None = None


@dataclass(frozen=True, slots=True)
class PlacesReached:
    """Places of the program text that a test reached; those before any test, if ``test`` is empty.

    ``elsewhere``: whether that was in processes below the tests.
    """

    test: str
    places: tuple[int, ...]
    elsewhere: bool = False


@dataclass(frozen=True, slots=True)
class TextsSeen:
    """What a recording saw of the program text, over all tests.

    Attributes:
        imported: files that were imported, relative to the root.
        sightings: what was seen at each place.
    """

    imported: tuple[str, ...]
    sightings: tuple[Sighting, ...]


@dataclass(frozen=True, slots=True)
class NotInstrumented:
    """A file whose mutants cannot run, because it was imported without its alternatives."""

    file: str
    reason: str


@dataclass(frozen=True, slots=True)
class KnownLater:
    """At a site stood an operation, and in another test something that nothing tells to be one."""

    span: Span
    operation: str


@dataclass(frozen=True, slots=True)
class BranchEnd:
    """A branch has finished a test: the one in which it was forked, or a later one.

    Attributes:
        mutant: id of the mutant it was.
        end: what the test ended like.
        sites: the sites that the trace refers to.
        shared: simulated seconds it inherited from the trunk, or None without a clock.
    """

    mutant: str
    end: TestEnd
    sites: tuple[SiteSeen, ...] = ()
    shared: float | None = None


@dataclass(frozen=True, slots=True)
class BranchFinished:
    """A branch has gone to the end of the session.

    Attributes:
        mutants: ids of the mutants it was.
        exit_code: its exit code, by which the suite says how it has ended; its parent's word.
    """

    mutants: tuple[str, ...]
    exit_code: int = 0


@dataclass(frozen=True, slots=True)
class BranchDied:
    """A branch ended without saying how its test ended.

    Attributes:
        mutant: id of the mutant it was.
        test: the test it was in.
        exit_code: its exit code, negative for a signal.
        overdue: which wall-clock limit it exceeded, in words, or None.
        hindered, is_starved: as in ``Result``.
        where: where it was then, if that is known.
        acted: whether the mutant had changed anything.
        in_mutated_call: whether it was in the midst of a mutated call.
    """

    mutant: str
    test: str
    exit_code: int
    overdue: str | None = None
    where: str | None = None
    hindered: str | None = None
    is_starved: bool = False
    acted: bool = False
    in_mutated_call: bool = False


@dataclass(frozen=True, slots=True)
class ForkEnded:
    """A process that this one forked has ended.

    Attributes:
        fork: the number of a branch among the forks of its parent, from 1; that of the process for a copy of
            a fork server.
        exit_code: its exit code, negative for a signal.
        died: what else is known of it, if it was a branch that did not say how its test ended.
    """

    fork: int
    exit_code: int
    died: BranchDied | None = None


@dataclass(frozen=True, slots=True)
class Unbranched:
    """It was not safe to fork at the first hit, in this test: these mutants need a process of their own."""

    test: str
    mutants: tuple[str, ...]
    reason: str


@dataclass(frozen=True, slots=True)
class Undiverged:
    """Mutants of the program text that were reached in a trunk's test and always had the original's value.

    The trunk itself has run this test for them.

    Attributes:
        test: the test, which is about to end.
        hits: evaluations of the mutant's place in it, by mutant id.
    """

    test: str
    hits: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class TokensHeld:
    """How many tokens a trunk and its branches hold: what the pool gets back if the trunk dies."""

    held: int


@dataclass(frozen=True, slots=True)
class Problem:
    """Something in the vocabulary does not fit the program.

    Attributes:
        source: where the vocabulary says so.
        key: the key below the source.
        text: what is wrong.
        name, known: the name that does not exist and those that do, where it is about a name.
    """

    source: str
    key: str
    text: str
    name: str | None = None
    known: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Remark:
    """Something about the vocabulary that the user should know; the program can be tested all the same.

    Attributes:
        source: where the vocabulary says so.
        key: the key below the source.
        text: what there is to say, and what to do about it.
    """

    source: str
    key: str
    text: str

    def __str__(self) -> str:
        return f"{self.source} · {self.key}: {self.text}"


@dataclass(frozen=True, slots=True)
class Serving:
    """A fork server has collected its tests and waits for jobs; or it does not, for a ``reason``.

    ``copy``: the process that it has forked for the job that came last.
    """

    reason: str | None = None
    copy: int | None = None


@dataclass(frozen=True, slots=True)
class Began:
    """A process below the tests has begun to tell.

    Attributes:
        pid, group: its number, and that of its process group.
        command: its command line.
        test: number of the test that was running.
        unable: why nothing in it can be seen; None if it can.
    """

    pid: int
    group: int
    command: tuple[str, ...]
    time: float
    test: int = 0
    unable: str | None = None


@dataclass(frozen=True, slots=True)
class Called:
    """A call of an operation below the tests, or of the program before any test began.

    Attributes:
        site, written, read, answer: as in a trace.
        time: when it was, below the tests.
    """

    site: int
    written: Any
    read: Any
    answer: Any = None
    time: float = 0.0


@dataclass(frozen=True, slots=True)
class Noted:
    """A call of the original that the robot refused, or that returned the robot's own memory.

    Attributes:
        site: its site.
        refused: its number there in this process, from 1, if it was refused; else None.
    """

    site: int
    refused: int | None = None


@dataclass(frozen=True, slots=True)
class Did:
    """What the mutant did since the last time: counts are to be added up.

    Attributes:
        test: the test that runs.
        hits, acted, away, example, invalid, failure: as in ``TestEnd``.
        refused: how the robot refused a mutated call; None if it did not.
        is_final: whether this refusal decides about a test that fails, since it was told as data.
    """

    test: str
    hits: int = 0
    acted: int = 0
    away: Mapping[str, int] = field(default_factory=dict)
    example: tuple[Any, ...] | None = None
    invalid: bool = False
    failure: str | None = None
    refused: str | None = None
    is_final: bool = False


@dataclass(frozen=True, slots=True)
class Used:
    """What the process used of the running test's budget by now: the last one counts.

    ``exceeded`` is the limit that was exceeded, in words.
    """

    operations: int
    commands: int
    simulated: float | None = None
    exceeded: str | None = None


@dataclass(frozen=True, slots=True)
class Raised:
    """An exception that nobody caught ended the process, or one of its threads.

    Attributes:
        text: its type and what it says.
        is_refusal: whether it is the robot's refusal of a mutated call.
        failure: the simulator's failure, or None.
        in_thread: whether only a thread ended.
    """

    text: str
    is_refusal: bool = False
    failure: str | None = None
    in_thread: bool = False


@dataclass(frozen=True, slots=True)
class Found:
    """Targets of the vocabulary, modules that it names, and nodes, that the process has."""

    targets: tuple[str, ...] = ()
    modules: tuple[str, ...] = ()
    nodes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Signalled:
    """The process sends a signal to another, or to a group (negative), or to ``ANYBODY``."""

    pid: int


@dataclass(frozen=True, slots=True)
class SessionEnd:
    """The process ends in an orderly way: the last of its events.

    Attributes:
        exit_status: pytest's exit status; 0 for a process below the tests.
        collected: node ids of the tests collected, in order.
        errors: texts of collection errors.
        not_private: why its files were not its own, though that was asked for; None if they were.
    """

    exit_status: int = 0
    collected: tuple[str, ...] = ()
    errors: tuple[str, ...] = ()
    not_private: str | None = None


@dataclass(frozen=True, slots=True)
class Untrusted:
    """What a process reports cannot be relied on: said of it by whoever reads its events.

    Attributes:
        reason: in words.
    """

    reason: str


Event = (
    SiteSeen
    | TestStart
    | Watched
    | Acted
    | PlacesReached
    | TextsSeen
    | NotInstrumented
    | KnownLater
    | TestEnd
    | BranchEnd
    | BranchFinished
    | BranchDied
    | Unbranched
    | Undiverged
    | TokensHeld
    | Problem
    | Remark
    | Serving
    | ForkEnded
    | Began
    | Called
    | Noted
    | Did
    | Used
    | Raised
    | Found
    | Signalled
    | SessionEnd
    | Untrusted
)

#: the kinds of event by their names
EVENTS: dict[str, type[Any]] = {kind.__name__: kind for kind in get_args(Event)}


def event_to_data(event: Event) -> dict[str, Any]:
    """JSON-like data of an event, with its type."""
    data: dict[str, Any] = to_data(event)
    return {"type": type(event).__name__, **data}


def event_from_data(data: dict[str, Any]) -> Event:
    """The event in such data.

    Raises KeyError for a type that is not known, TypeError or ValueError for data that does not fit it.
    """
    if not isinstance(data, dict):
        raise TypeError(f"an event is an object, not {type(data).__name__}")
    kind = EVENTS[data["type"]]
    event: Event = from_data(kind, {key: value for key, value in data.items() if key != "type"})
    return event
