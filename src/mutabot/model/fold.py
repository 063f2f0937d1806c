"""Combine the events of several processes into the record of a test.

The same functions serve the test process, which must know whether a test decides about its mutant, and the
controller, if the test process did not get that far.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from mutabot.frozen import frozen
from mutabot.model import events
from mutabot.model.clocks import monotonic, sleep
from mutabot.model.event_file import ANY_PROCESS, FOLDER, NOW, OWN_FAULT, SUFFIX, EventReader
from mutabot.model.files import read_file
from mutabot.model.job import Job
from mutabot.model.outcome import added

#: seconds that a process may take to write what it has begun to write, and between two looks at it
_PATIENCE, _PAUSE = 1.0, 0.002


@dataclass(slots=True)
class ChildRecord:
    """A process below the tests, with its events.

    Attributes:
        began: what it is.
        nodes: nodes that live in it.
        sites: its sites, by its own indexes.
        ended: whether it ended in an orderly way.
        raised: what ended it otherwise.
        is_in_call: whether a mutated call has begun in it and not ended.
        acted: tests in which the mutant did something in it, in their order.
        called, noted, did, places, used, exceeded, guarded: what it reported during the running test.
    """

    began: events.Began
    nodes: list[str] = field(default_factory=list)
    sites: dict[int, events.SiteSeen] = field(default_factory=dict)
    ended: bool = False
    raised: events.Raised | None = None
    is_in_call: bool = False
    acted: dict[str, None] = field(default_factory=dict)
    called: list[events.Called] = field(default_factory=list)
    noted: list[events.Noted] = field(default_factory=list)
    did: list[events.Did] = field(default_factory=list)
    places: set[int] = field(default_factory=set)
    used: events.Used | None = None
    exceeded: str | None = None
    guarded: str | None = None

    @property
    def name(self) -> str:
        """The process's name in messages: its node, or the file that it runs."""
        if self.nodes:
            return self.nodes[0]
        arguments = [argument for argument in self.began.command[1:] if not argument.startswith("-")]
        return os.path.basename(arguments[0]) if arguments else os.path.basename(self.began.command[0])

    @property
    def origin(self) -> str:
        """How the process was started."""
        return events.FORKED if self.began.forked else events.STARTED

    def add(self, event: events.Event) -> None:
        """Add an event; ignore events outside a test."""
        match event:
            case events.SiteSeen():
                self.sites[event.index] = event
            case events.Called():
                self.called.append(event)
            case events.Noted():
                self.noted.append(event)
            case events.Did():
                self.did.append(event)
                if event.acted:
                    self.acted[event.test] = None
            case events.Acted(in_call=bool(is_in_call)):
                self.is_in_call = is_in_call
                if is_in_call:
                    self.acted[event.test] = None
            case events.PlacesReached():
                self.places.update(event.places)
            case events.Used():
                self.used, self.exceeded = event, event.exceeded or self.exceeded
                self.guarded = event.guarded or self.guarded
            case events.Raised():
                self.raised = event
            case events.Found():
                self.nodes += event.nodes
            case events.SessionEnd():
                self.ended = True

    def forget(self) -> None:
        """Forget the events of the test, which is over."""
        for records in (self.called, self.noted, self.did, self.places):
            records.clear()
        self.used, self.exceeded, self.guarded = None, None, None
        if self.raised is not None and self.raised.in_thread:
            self.raised = None


def is_alive(pid: int) -> bool:
    """Return whether a process runs, rather than being a zombie that awaits its parent."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii", errors="replace") as file:
            return file.read().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


class Children:
    """The processes below a test process, by their files of events.

    The tests know the folder, and so does whatever they start: files may be gone or damaged.

    Args:
        home: the home of the test process.
        key: of the seals.

    Attributes:
        records: what each of them reported, by file.
        doubt: why their reports cannot be relied on, or None.
        number: that of the running test, as the test process knows it; None elsewhere, and before any test.
    """

    def __init__(self, home: str, key: str) -> None:
        self.number: int | None = None
        self.records: dict[str, ChildRecord] = {}
        self.doubt: str | None = None
        self._folder, self._key = os.path.join(home, FOLDER), key
        self._readers: dict[str, EventReader] = {}

    def read(self) -> list[events.Event]:
        """Read the new events, sort them in, and return them."""
        found: list[events.Event] = []
        for name in [*self._readers, *(name for name in self._names() if name not in self._readers)]:
            for event in self._new_in(name):
                self._take(name, event)
                found.append(event)
        self._look_at_now()
        return found

    def _take(self, name: str, event: events.Event) -> None:
        if isinstance(event, events.Untrusted):
            self._note(event.reason)
        elif isinstance(event, events.Began):
            if str(event.pid) != name.partition("-")[0] or name in self.records:
                self._note(f"{name} was not begun by its process")
            elif event.unable is None:
                self.records[name] = ChildRecord(event)
        elif name in self.records:
            self.records[name].add(event)

    def _names(self) -> list[str]:
        try:
            files = sorted(os.listdir(self._folder))
        except OSError:
            self._note("their folder was deleted")
            files = []
        return [file for file in files if file.endswith(SUFFIX) and file[0].isdigit()]

    def _new_in(self, name: str) -> list[events.Event]:
        """Return the new events of a process, which may still be writing the last one."""
        path = os.path.join(self._folder, name)
        reader = self._readers.setdefault(name, EventReader(path, self._key))
        found = reader.read()
        until = monotonic() + _PATIENCE
        while reader.is_torn and reader.damage is None:
            is_writing = monotonic() < until and is_alive(int(name.partition("-")[0]))
            found += reader.read(is_last=not is_writing)
            sleep(_PAUSE)
        return found

    def _look_at_now(self) -> None:
        try:
            now = read_file(os.path.join(self._folder, NOW), 16)
        except OSError as error:
            if self.number is None and isinstance(error, FileNotFoundError):  # before the first test
                return
            now = b""
        is_number = self.number is None or now[:8] == self.number.to_bytes(8, sys.byteorder)
        if any(now[8:]):
            self._note("one of them could not write its events: a full disk, or RLIMIT_FSIZE?")
        elif len(now) < 16 or not is_number:  # they have read another number, or died of reading
            self._note("the number of the running test was deleted or changed")

    def _note(self, why: str) -> None:
        self.doubt = self.doubt or f"what processes below the tests reported was damaged: {why}"


def acted_in(records: Collection[ChildRecord]) -> list[str]:
    """Return the tests in which a process below them reports that the mutant changed something."""
    return list(dict.fromkeys(test for record in records for test in record.acted))


def fold_fork(
    seen: Sequence[events.Event], exit_code: int, died: events.ForkDied | None, below: Collection[str] = ()
) -> list[events.Event]:
    """Return the events of a fork that has ended, completed by its parent's report of how it ended.

    ``below``: tests in which the mutant changed something in a process below it.
    """
    found: list[events.Event] = [
        replace(event, exit_code=exit_code) if isinstance(event, events.ForkSessionEnd) else event
        for event in seen
        if not isinstance(event, events.Acted)
    ]
    if died is None:
        return found
    in_calls = [event.in_call for event in seen if isinstance(event, events.Acted)]
    calls = [in_call for in_call in in_calls if in_call is not None]
    return [
        *found,
        replace(died, acted=None in in_calls or bool(below), in_mutated_call=calls[-1:] == [True]),
    ]


@frozen
class FactsOfTest:
    """Facts about a test and the processes below it that only the test process knows.

    Attributes:
        job: its job.
        index_of: its own index of a site.
        has_acted: whether the mutant changed anything in an earlier test.
        codes: exit codes of processes.
        signalled: processes, and groups (negative), that were sent a signal, or ``ANY_PROCESS``.
    """

    job: Job
    index_of: Callable[[events.SiteSeen], int]
    has_acted: bool = False
    codes: Mapping[int, int] = field(default_factory=dict)
    signalled: Collection[int] = ()


def fold(end: events.TestEnd, records: Sequence[ChildRecord], facts: FactsOfTest) -> events.TestEnd:
    """Return the end of a test, combined with the events of the processes below it."""
    if not records:
        return end
    end = _with_calls(end, records, facts)
    end = _with_deeds(end, records)
    return _with_ends(end, records, facts)


def calls_of(records: Sequence[ChildRecord], facts: FactsOfTest) -> Iterator[tuple[int, events.Called]]:
    """Yield the calls of each process in order, one process after the other, each with its site."""
    for record in records:
        yield from ((facts.index_of(record.sites[call.site]), call) for call in record.called)


def _with_calls(end: events.TestEnd, records: Sequence[ChildRecord], facts: FactsOfTest) -> events.TestEnd:
    called = list(calls_of(records, facts))
    trace = [*end.trace, *((site, call.written, call.read, call.answer) for site, call in called)]
    used = [child.used for child in records if child.used is not None]
    times = [end.simulated, *(use.simulated for use in used)]
    below: dict[str, set[int]] = {}
    for record in records:
        sites = {facts.index_of(record.sites[call.site]) for call in record.called}
        below.setdefault(record.origin, set()).update(sites)
    noted = [
        (facts.index_of(child.sites[each.site]), each.refused) for child in records for each in child.noted
    ]
    return replace(
        end,
        refused_calls=(*end.refused_calls, *((site, number) for site, number in noted if number is not None)),
        live=tuple(sorted({*end.live, *(site for site, number in noted if number is None)})),
        below={origin: tuple(sorted(sites)) for origin, sites in below.items() if sites},
        trace=tuple(_within_limit(trace)) if facts.job.record else (),
        truncated=end.truncated or len(trace) > events.TRACE_LIMIT,
        operations=end.operations + max(len(called), sum(use.operations for use in used)),
        commands=end.commands + sum(use.commands for use in used),
        simulated=max((time for time in times if time is not None), default=None),
    )


def _within_limit(trace: Sequence[tuple[Any, ...]]) -> Iterator[tuple[Any, ...]]:
    """Yield the hits that are kept: the first ones, and of what comes later the first at each site."""
    reached: set[int] = set()
    for number, hit in enumerate(trace):
        if number < events.TRACE_LIMIT or hit[0] not in reached:
            reached.add(hit[0])
            yield hit


def _with_deeds(end: events.TestEnd, records: Sequence[ChildRecord]) -> events.TestEnd:
    """Return the end of a test with what the mutant did in all processes."""
    did = [each for record in records for each in record.did]
    if not did:
        return end
    refused = [report for report in did if report.refused is not None]
    failures = [end.failure, *(report.failure for report in did)]
    examples = [end.example, *(report.example for report in did)]
    end = replace(
        end,
        hits=end.hits + sum(report.hits for report in did),
        acted=end.acted + sum(report.acted for report in did),
        hit_below=tuple(
            sorted({record.origin for record in records if any(each.hits for each in record.did)})
        ),
        away=added([end.away, *(report.away for report in did)]),
        example=next((example for example in examples if example is not None), None),
        failure=next((failure for failure in failures if failure is not None), None),
    )
    if refused and end.refused is None:
        is_final = any(report.is_final for report in refused)
        caught = end.outcome == "failed" and not is_final
        end = replace(end, refused=refused[-1].refused, caught=caught)
    return end


def _with_ends(end: events.TestEnd, records: Sequence[ChildRecord], facts: FactsOfTest) -> events.TestEnd:
    """Return the end of a test, adjusted for how the processes below it ended."""
    raised = [child.raised for child in records if child.raised is not None]
    failure = end.failure or next(
        (raising.failure for raising in raised if raising.failure is not None), None
    )
    exceeded = next((child.exceeded for child in records if child.exceeded is not None), None)
    died_at_work = [child for child in records if child.is_in_call and not is_alive(child.began.pid)]
    end = replace(
        end,
        failure=failure,
        timeout=end.timeout or exceeded,
        guarded=end.guarded or next((child.guarded for child in records if child.guarded is not None), None),
        hits=end.hits + len(died_at_work),
        acted=end.acted + len(died_at_work),
        hit_below=tuple(sorted({*end.hit_below, *(child.origin for child in died_at_work)})),
    )
    for record in died_at_work:
        record.is_in_call = False
    if end.refused is not None and any(raising.is_refusal for raising in raised):
        end = replace(end, caught=False)
    if end.outcome == "failed" and end.failure is None and facts.job.mutant is not None:
        end = replace(end, failure=_lost(end, records, facts))
    return end


def _lost(end: events.TestEnd, records: Sequence[ChildRecord], facts: FactsOfTest) -> str | None:
    """Return why a failed test shows nothing about the mutant; None if it does."""
    for record in records:
        code = facts.codes.get(record.began.pid)
        is_killed = code is not None and code < 0 and -code not in OWN_FAULT
        if code is not None and is_killed and not record.ended and not _was_signalled(record, facts):
            return f"the process {record.name} was killed from outside, by signal {-code}"
    if end.acted or facts.has_acted or end.refused is not None:
        return None
    for record in records:
        if record.raised is not None and not record.raised.in_thread:
            return f"the process {record.name} ended before the mutant changed anything: {record.raised.text}"
    return None


def _was_signalled(record: ChildRecord, facts: FactsOfTest) -> bool:
    """Return whether the tests, or a process below them, sent the process a signal."""
    pid, group = record.began.pid, record.began.group
    return not {pid, -pid, -group, ANY_PROCESS}.isdisjoint(facts.signalled)
