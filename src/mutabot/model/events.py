"""The events that the processes of a job report, each process in its own file.

The test process, its forks and the processes below the tests report the same kinds. Times are those of
``time.monotonic``, which all processes share. The end of a test is also what the journal keeps
of the baseline.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any

from mutabot.frozen import frozen
from mutabot.model.codec import from_data, to_data
from mutabot.model.mutant import Span
from mutabot.model.outcome import By, Check
from mutabot.model.program_text import Sighting
from mutabot.model.source_units import Executed

#: origins of processes below the tests: a program that was started, or a copy of another process
STARTED, FORKED = "started", "forked"
#: hits per test that are reported with their values, and compared; of later ones the first at each site
TRACE_LIMIT = 5000


class Event:
    """Base of all events, which are the classes below."""

    __slots__ = ()


@frozen
class OutOfReach(Event):
    """A process that cannot join the campaign: nothing in it is seen, and no mutant of a call acts in it.

    Attributes:
        command: how its command begins.
        why: why it cannot join.
        files: real paths of the Python files that its command names; None if it is known to run the program,
            but not by which files.
        imports: what these files may import, see ``languages.imported_names``.
    """

    command: str
    why: str
    files: tuple[str, ...] | None
    imports: tuple[str, ...] = ()


@frozen
class TestEnd(Event):
    """A test has ended.

    Attributes:
        test: node id.
        outcome: as pytest counts it: ``passed``, ``failed``, ``skipped``, ``xfailed`` or ``xpassed``. Only
            ``failed`` makes the suite fail.
        by: what noticed, for a failure.
        exception: type of the exception as ``module:Name``.
        message: first lines of the exception's text.
        place: ``file:line`` where the failure was noticed.
        timeout: which limit was exceeded, or None.
        hindered: why the limit of wall clock that it exceeded says little, as the machine was busy;
            else None.
        failure: the simulator's failure, or None.
        invalid: whether the mutated call rejected its arguments' types.
        refused: text of the refusal of a mutated call, or None.
        guarded: which command a guard kept from the robot, and why; None if none did.
        refused_calls: in the baseline, the calls that the robot refused: site index, and the call's number
            among those of its site, from 1.
        live: in the baseline, indexes of sites that returned the robot's own memory, not a copy of it.
        caught: whether the program handled that refusal, so that the test ended for another reason.
        hits: calls at the mutant's site (with its operation and pattern).
        acted: hits at which the mutant changed something.
        away: hits at which it stayed away, by the reason.
        example: value before and after at the first hit at which it acted.
        operations: intercepted calls at any site.
        commands: operations that made the robot do something, from any site.
        wall, cpu: seconds of the test, fixtures included.
        simulated: simulated seconds, or None if there is no clock.
        trace: per hit: site index, values written, values read, and in the baseline a note of what the call
            returned: a plain value, ``{"kept": data}`` or ``{"opaque": what}`` at a site's first hit,
            ``{"same"}`` or ``{"other"}`` than that later on, ``{"raised"}`` if it did not return.
        truncated: whether the trace was cut off.
        returned: what functions of the program returned to the test: name, and the value in a list or, for
            one that raised, ``{"raised": text}``.
        prepared: how many of these are from before the test itself began: from its fixtures.
        probes: values of each probe by ``target.part``; those of the second object of a class by
            ``target#2.part``.
        unread: why a probe could not be read, by target.
        processes: processes below the tests that were there during it, by number, with a name for people.
        below: indexes of the sites that processes below the tests called, by their origin.
        hit_below: origins of the processes below the tests in which the mutant was hit.
        exclusive: description of how it gets in the way of other processes, or None.
        moments: probes along the way: after which call (from 1), parts that differ from the moment before,
            and whether these are all parts.
        reading: processor seconds it takes to read all probes; None if they cannot be read along the way.
        not_along: why not, or None.
        checks: the checks of the tests that were made, and what they compared.
        more_checks: how many further ones were made.
        recording: what the world did, as ``evidence.recording.to_text`` writes it; None if that was not asked
            for.
        out_of_reach: the processes that were started during it and cannot join the campaign.
        executed: units of the project's files that were executed until the test ended, but for those that
            tests before it have reported; of a mutant that this test neither reached nor failed, those of the
            test alone. None if that is not known.
    """

    __test__ = False  # not a test class, whatever pytest may think of the name

    test: str
    outcome: str
    by: By | None = None
    exception: str | None = None
    message: str | None = None
    place: str | None = None
    timeout: str | None = None
    failure: str | None = None
    invalid: bool = False
    refused: str | None = None
    refused_calls: tuple[tuple[int, int], ...] = ()
    live: tuple[int, ...] = ()
    caught: bool = False
    hits: int = 0
    acted: int = 0
    away: Mapping[str, int] = field(default_factory=dict)
    example: tuple[Any, ...] | None = None
    operations: int = 0
    commands: int = 0
    wall: float = 0.0
    cpu: float = 0.0
    simulated: float | None = None
    trace: tuple[Any, ...] = ()
    truncated: bool = False
    returned: tuple[Any, ...] = ()
    prepared: int = 0
    probes: Mapping[str, Any] = field(default_factory=dict)
    unread: Mapping[str, str] = field(default_factory=dict)
    processes: tuple[tuple[int, str], ...] = ()
    below: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    hit_below: tuple[str, ...] = ()
    exclusive: str | None = None
    moments: tuple[Any, ...] = ()
    reading: float | None = None
    not_along: str | None = None
    checks: tuple[Check, ...] = ()
    more_checks: int = 0
    out_of_reach: tuple[OutOfReach, ...] = ()
    recording: str | None = None
    hindered: str | None = None
    guarded: str | None = None
    executed: Executed | None = None

    @property
    def lasting(self) -> str:
        """The outcome on which equal runs must agree; a test that may fail may also pass."""
        return "xfailed" if self.outcome == "xpassed" else self.outcome

    @property
    def notices(self) -> bool:
        """Whether this test noticed its mutant, provided that the mutant had changed anything."""
        if self.failure is not None or self.invalid or self.guarded is not None:
            return False
        is_refused = self.refused is not None and not self.caught
        return self.timeout is not None or (self.outcome == "failed" and not is_refused)

    @property
    def is_decided(self) -> bool:
        """Whether this test alone decides about its mutant, so that no other test needs to run."""
        if self.failure is not None or self.invalid or self.timeout is not None or self.guarded is not None:
            return True
        return self.outcome == "failed" and (self.refused is None or self.caught)


@frozen
class SiteSeen(Event):
    """A site was reached for the first time in this session; traces refer to it by ``index``.

    ``direct`` is whether the call that stands there is that of the operation itself, rather than of something
    that leads to it, ``stands_in`` whether a mock or a fake of the project got the call; only the baseline
    finds out.
    """

    index: int
    span: Span
    operation: str
    pattern: str | None
    oracle: bool
    direct: bool = False
    stands_in: bool = False


@frozen
class TestStart(Event):
    """A test begins: its fixtures are next."""

    __test__ = False

    test: str


@frozen
class Watched(Event):
    """The suite itself ends this process with exit code 1 if a test takes too long.

    Attributes:
        test: the test.
        until: from when on, by the clock of ``time.monotonic``, which all processes share.
        text: description of the limit.
    """

    test: str
    until: float
    text: str


@frozen
class Acted(Event):
    """The mutant has changed something: proof that mutated code ran.

    Attributes:
        test: the test; empty for a mutant of the program text before any test began.
        in_call: whether a mutated call begins, or has ended, which shows whether a process died in it; None
            where the mutant changed something for the first time in this test.
    """

    test: str
    in_call: bool | None = None


@frozen
class PlacesReached(Event):
    """Places of the program text that a test reached; those before any test, if ``test`` is empty.

    ``below``: the origin of the processes below the tests in which that was; empty for the test process.
    """

    test: str
    places: tuple[int, ...]
    below: str = ""


@frozen
class TextsSeen(Event):
    """What a recording observed in the program text, over all tests.

    Attributes:
        imported: files that were imported, relative to the root.
        sightings: what was seen at each place.
    """

    imported: tuple[str, ...]
    sightings: tuple[Sighting, ...]


@frozen
class NotInstrumented(Event):
    """A file was imported without its alternatives, so its mutants cannot run."""

    file: str
    reason: str


@frozen
class KnownLater(Event):
    """An operation was called at a site at which another test called something unrecognised."""

    span: Span
    operation: str


@frozen
class CallsAsked(Event):
    """The places where calls of the program were intercepted in the text, over all tests.

    Attributes:
        files: files whose calls of an operation's name are asked about, relative to the root.
        alone: of these calls, where something stood that is no operation.
        unmeant: where an operation's callable was called for none of its commands, or only by what wraps it.
    """

    files: tuple[str, ...]
    alone: tuple[Span, ...] = ()
    unmeant: tuple[Span, ...] = ()


@frozen
class ForkTestEnd(Event):
    """A fork has finished a test, either the one in which it was forked or a later one.

    Attributes:
        mutant: id of the mutant it was.
        end: what the test ended like.
        sites: the sites that the trace refers to.
        shared: simulated seconds it inherited from the fork parent, or None without a clock.
        is_early: whether it was forked before any test.
        is_test_control: whether it was the control of this test alone: its id is none of the plan's.
    """

    mutant: str
    end: TestEnd
    sites: tuple[SiteSeen, ...] = ()
    shared: float | None = None
    is_early: bool = False
    is_test_control: bool = False


@frozen
class ForkSessionEnd(Event):
    """A fork has reached the end of the session.

    Attributes:
        mutants: ids of the mutants it was.
        exit_code: its exit code, by which the suite says how it has ended; its parent's word.
        errors: what could not be collected.
        gone: tests that are not collected since the mutant changed something.
        has_acted: whether it had changed something by then.
    """

    mutants: tuple[str, ...]
    exit_code: int = 0
    errors: tuple[str, ...] = ()
    gone: tuple[str, ...] = ()
    has_acted: bool = False


@frozen
class ForkDied(Event):
    """A fork ended without reporting how its test ended.

    Attributes:
        mutant: id of the mutant it was.
        test: the test it was in; empty before any.
        exit_code: its exit code, negative for a signal.
        overdue: description of the limit of time that it exceeded, or None.
        hindered, is_starved: as in ``Result``.
        acted: whether the mutant had changed anything.
        in_mutated_call: whether it was in the midst of a mutated call.
    """

    mutant: str
    test: str
    exit_code: int
    overdue: str | None = None
    hindered: str | None = None
    is_starved: bool = False
    acted: bool = False
    in_mutated_call: bool = False


@frozen
class ForkEnded(Event):
    """A process that this one forked has ended.

    Attributes:
        fork: the number of a fork among the forks of its parent, from 1; that of the process for a copy of
            a fork server.
        exit_code: its exit code, negative for a signal.
        died: what else is known of it, if it was a fork that did not say how its test ended.
    """

    fork: int
    exit_code: int
    died: ForkDied | None = None


@frozen
class Unforked(Event):
    """It was not safe to fork these mutants at their first hit in this test; they need own processes.

    The test is empty before any.
    """

    test: str
    mutants: tuple[str, ...]
    reason: str


@frozen
class Undiverged(Event):
    """A fork parent reached these mutants of the program text, always with the original's value.

    The fork parent itself has run this test for them.

    Attributes:
        test: the test, which is about to end.
        hits: evaluations of the mutant's place in it, by mutant id.
    """

    test: str
    hits: Mapping[str, int]


@frozen
class TestControls(Event):
    """A test of the original has ended in which control forks were made.

    Attributes:
        test: the test.
        count: how many identities were forked for it alone, each beside the mutants of one moment.
    """

    test: str
    count: int


@frozen
class TokensHeld(Event):
    """The number of tokens that a fork parent and its forks hold, to be returned if the parent dies."""

    held: int


@frozen
class Problem(Event):
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


@frozen
class Remark(Event):
    """Something about the vocabulary that the user should know and that is no error.

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


@frozen
class Serving(Event):
    """A fork server has collected its tests and waits for jobs, or cannot serve for a ``reason``.

    ``copy``: the process that it has forked for the job that came last.
    """

    reason: str | None = None
    copy: int | None = None


@frozen
class Began(Event):
    """A process below the tests has begun to report.

    Attributes:
        pid, group: its number, and that of its process group.
        command: its command line.
        test: number of the test that was running.
        unable: why nothing in it can be seen; None if it can.
        forked: whether it is a copy of a process of the campaign, and no program that was started.
    """

    pid: int
    group: int
    command: tuple[str, ...]
    time: float
    test: int = 0
    unable: str | None = None
    forked: bool = False


@frozen
class Called(Event):
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


@frozen
class Noted(Event):
    """A call of the original that the robot refused, or that returned the robot's own memory.

    Attributes:
        site: its site.
        refused: its number there in this process, from 1, if it was refused; else None.
    """

    site: int
    refused: int | None = None


@frozen
class Did(Event):
    """What the mutant did since the last report; counts are to be added up.

    Attributes:
        test: the test that runs.
        hits, acted, away, example, failure: as in ``TestEnd``.
        refused: how the robot refused a mutated call; None if it did not.
        is_final: whether this refusal decides about a test that fails, since it came as data.
    """

    test: str
    hits: int = 0
    acted: int = 0
    away: Mapping[str, int] = field(default_factory=dict)
    example: tuple[Any, ...] | None = None
    failure: str | None = None
    refused: str | None = None
    is_final: bool = False


@frozen
class Used(Event):
    """The time that the process has used in the running test; only the last event counts.

    ``exceeded`` names the limit that was exceeded, ``guarded`` the command that a guard kept from the robot.
    """

    operations: int
    commands: int
    simulated: float | None = None
    exceeded: str | None = None
    guarded: str | None = None


@frozen
class Raised(Event):
    """An uncaught exception ended the process, or one of its threads.

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


@frozen
class Found(Event):
    """Targets of the vocabulary, its modules, and nodes that exist in the process; files read as text."""

    targets: tuple[str, ...] = ()
    modules: tuple[str, ...] = ()
    nodes: tuple[str, ...] = ()
    texts: tuple[str, ...] = ()


@frozen
class Signalled(Event):
    """The process sends a signal to another, or to a group (negative), or to ``ANY_PROCESS``."""

    pid: int


@frozen
class SessionEnd(Event):
    """The process ends in an orderly way; this is its last event.

    Attributes:
        exit_status: pytest's exit status; 0 for a process below the tests.
        collected: node ids of the tests collected, in order.
        errors: texts of collection errors.
        not_private: why its files were not its own, though that was asked for; None if they were.
        gone, has_acted: as in ``ForkSessionEnd``.
    """

    exit_status: int = 0
    collected: tuple[str, ...] = ()
    errors: tuple[str, ...] = ()
    not_private: str | None = None
    gone: tuple[str, ...] = ()
    has_acted: bool = False


@frozen
class Untrusted(Event):
    """The events of a process are unreliable; added by their reader, not by the process.

    Attributes:
        reason: the reason, for the user.
    """

    reason: str


#: the kinds of event by their names
EVENTS: dict[str, type[Event]] = {kind.__name__: kind for kind in Event.__subclasses__()}


def event_to_data(event: Event) -> dict[str, Any]:
    """Return JSON-like data of an event, with its type."""
    return {"type": type(event).__name__, **to_data(event)}


def event_from_data(data: dict[str, Any]) -> Event:
    """Return the event in such data.

    Raises KeyError for a type that is not known, TypeError or ValueError for data that does not fit it.
    """
    if not isinstance(data, dict):
        raise TypeError(f"an event is an object, not {type(data).__name__}")
    return from_data(EVENTS[data["type"]], {key: value for key, value in data.items() if key != "type"})
