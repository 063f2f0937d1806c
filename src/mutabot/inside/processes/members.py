"""What the members of a campaign told during a test, put into the end of that test."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from mutabot.border.lines import (
    MutatedCall,
    NotInstrumented,
    PlacesReached,
    Problem,
    Remark,
    SiteSeen,
    TextsSeen,
)
from mutabot.border.processes import (
    Began,
    Called,
    Did,
    Ended,
    Entry,
    Exceeded,
    Found,
    Live,
    Node,
    Places,
    Raised,
    RefusedCall,
    Signalled,
    Used,
)
from mutabot.border.signals import OWN_FAULT
from mutabot.border.test_end import TestEnd
from mutabot.inside.calls.trace import TRACE_LIMIT
from mutabot.inside.session import Session
from mutabot.model.outcome import added

from .host import Host
from .killers import ANYBODY
from .unseen import Unseen


@dataclass(slots=True)
class Account:
    """A process below the tests, and what it told.

    Attributes:
        began: what it is.
        nodes: nodes that live in it.
        sites: the test process's index of each of its sites.
        ended: whether it ended in an orderly way.
        raised: what ended it otherwise.
        is_in_call: whether a mutated call has begun in it and not ended.
        called, refused, live, did, used, exceeded: what it told during the running test.
    """

    began: Began
    nodes: list[str] = field(default_factory=list)
    sites: dict[int, int] = field(default_factory=dict)
    ended: bool = False
    raised: Raised | None = None
    is_in_call: bool = False
    called: list[Called] = field(default_factory=list)
    refused: list[RefusedCall] = field(default_factory=list)
    live: list[Live] = field(default_factory=list)
    did: list[Did] = field(default_factory=list)
    used: Used | None = None
    exceeded: str | None = None

    @property
    def name(self) -> str:
        """What people know it by: its node, or the file that it runs."""
        if self.nodes:
            return self.nodes[0]
        arguments = [one for one in self.began.command[1:] if not one.startswith("-")]
        return os.path.basename(arguments[0]) if arguments else os.path.basename(self.began.command[0])

    @property
    def is_alive(self) -> bool:
        """Whether the process is still there, and more than what its parent has not asked for."""
        try:
            with open(f"/proc/{self.began.pid}/stat", encoding="ascii", errors="replace") as file:
                return file.read().rpartition(")")[2].split()[0] not in "ZX"
        except OSError:
            return False

    def forget(self) -> None:
        """The test is over."""
        self.called.clear()
        self.refused.clear()
        self.live.clear()
        self.did.clear()
        self.used, self.exceeded = None, None
        if self.raised is not None and self.raised.in_thread:
            self.raised = None


class Members:
    """The members below one test process.

    Args:
        host: where they write.
        session: the session of the test process.
    """

    def __init__(self, host: Host, session: Session) -> None:
        self._host, self._session = host, session
        self._members: dict[str, Account] = {}
        self._present: list[Account] = []
        self._places: set[int] = set()
        self._texts: list[TextsSeen] = []
        self._signalled: set[int] = set()
        self._unable: set[str] = set()
        self._acted = False
        if session.job.inspect:
            Unseen(self._say_unseen).watch()

    def start_test(self, test: str) -> None:
        """A test begins: some may be there from before."""
        self._host.start_test(test)
        self._present = [one for one in self._members.values() if one.is_alive]

    def merged(self, end: TestEnd) -> TestEnd:
        """The end of the running test with what members did in it; an error if that cannot be known."""
        end = self._with_members(end)
        doubt = self._host.diaries.doubt
        return end if doubt is None else replace(end, failure=end.failure or doubt)

    def _with_members(self, end: TestEnd) -> TestEnd:
        self._take_all()
        here = sorted(self._here(), key=lambda one: (one.name, one.began.time))
        if not here:
            self._acted = self._acted or end.acted > 0
            return end
        end = self._with_calls(end, here)
        end = self._with_recorded(end, here)
        end = self._with_deeds(end, [did for one in here for did in one.did])
        end = self._with_ends(end, here)
        self._acted = self._acted or end.acted > 0
        if self._places:
            self._session.pipe.send(PlacesReached(end.test, tuple(sorted(self._places)), elsewhere=True))
        shared = tuple((one.began.pid, one.name) for one in here)
        footprint = replace(end.footprint, processes=shared) if end.footprint is not None else None
        for one in here:
            one.forget()
        self._places.clear()
        return replace(end, footprint=footprint)

    def texts_seen(self) -> list[TextsSeen]:
        """What members saw of the program text, over all tests."""
        self._take_all()
        return self._texts

    def _here(self) -> Iterable[Account]:
        """Those that were there during the test."""
        present = {id(one) for one in self._present}
        number = self._host.number
        for one in self._members.values():
            if id(one) in present or one.began.test == number or one.called or one.did:
                yield one

    def _take_all(self) -> None:
        for name, entries in self._host.diaries.new():
            for entry in entries:
                self._take(name, entry)

    def _take(self, name: str, entry: Entry) -> None:  # noqa: PLR0912  # one case per kind of entry
        if isinstance(entry, Began):
            if entry.unable is not None:
                self._say_unable(entry)
            else:
                self._members[name] = Account(entry)
            return
        member = self._members.get(name)
        if member is None:
            return
        match entry:
            case Node():
                member.nodes.append(entry.name)
            case SiteSeen():
                member.sites[entry.index] = self._session.recorder.index_of(entry)
            case Called():
                member.called.append(entry)
            case RefusedCall():
                member.refused.append(entry)
            case Live():
                member.live.append(entry)
            case Did():
                member.did.append(entry)
            case MutatedCall():
                member.is_in_call = entry.began
            case Places():
                self._places.update(entry.places)
            case TextsSeen():
                self._texts.append(entry)
            case Used():
                member.used = entry
            case Exceeded():
                member.exceeded = entry.text
            case Raised():
                member.raised = entry
            case Signalled():
                self._signalled.add(entry.pid)
            case Found():
                self._session.interception.found_elsewhere(entry.targets)
                self._session.inspection.elsewhere.update(entry.modules)
            case NotInstrumented() | Problem() | Remark():
                self._session.pipe.send(entry)
            case Ended():
                member.ended = True

    def _with_calls(self, end: TestEnd, here: list[Account]) -> TestEnd:
        """The calls of each process in their order, one process after the other."""
        called = [(one.sites[call.site], call) for one in here for call in one.called]
        trace = [*end.trace, *((site, call.written, call.read, call.answer) for site, call in called)]
        used = [one.used for one in here if one.used is not None]
        times = [end.simulated, *(one.simulated for one in used)]
        simulated = [time for time in times if time is not None]
        refused = ((one.sites[call.site], call.number) for one in here for call in one.refused)
        return replace(
            end,
            refused_calls=(*end.refused_calls, *refused),
            live=tuple(sorted({*end.live, *(one.sites[call.site] for one in here for call in one.live)})),
            trace=tuple(trace[:TRACE_LIMIT]) if self._session.job.record else (),
            truncated=end.truncated or len(trace) > TRACE_LIMIT,
            operations=end.operations + max(len(called), sum(one.operations for one in used)),
            commands=end.commands + sum(one.commands for one in used),
            simulated=max(simulated, default=None),
        )

    def _with_recorded(self, end: TestEnd, here: list[Account]) -> TestEnd:
        """The calls of all processes by their times, in what is recorded."""
        session = self._session
        recorder, recording = session.recorder, session.recording
        found = [
            recorder.told_of(one.sites[call.site], call.written, call.read, recording.since(call.time))
            for one in here
            for call in one.called
        ]
        if end.recording is None or not found:
            return end
        return replace(end, recording=recording.text([*recorder.told(), *found]))

    def _with_deeds(self, end: TestEnd, did: list[Did]) -> TestEnd:
        """What the mutant did in all processes together."""
        if not did:
            return end
        refused = [one for one in did if one.refused is not None]
        failures = [end.failure, *(one.failure for one in did)]
        examples = [end.example, *(one.example for one in did)]
        end = replace(
            end,
            hits=end.hits + sum(one.hits for one in did),
            acted=end.acted + sum(one.acted for one in did),
            away=added([end.away, *(one.away for one in did)]),
            example=next((one for one in examples if one is not None), None),
            failure=next((one for one in failures if one is not None), None),
            invalid=end.invalid or any(one.invalid for one in did),
        )
        if refused and end.refused is None:
            is_final = any(one.is_final for one in refused)
            caught = end.outcome == "failed" and not is_final
            end = replace(end, refused=refused[-1].refused, caught=caught)
        return self._of_all_parts(end, did)

    def _of_all_parts(self, end: TestEnd, did: list[Did]) -> TestEnd:
        """A mutant of several acts if all of them do, be it in different processes."""
        mutant = self._session.job.mutant
        if mutant is None or len(mutant.singles) < 2:
            return end
        parts = {part for one in did for part in one.parts} | self._session.parts
        is_whole = self._session.part_names <= parts
        return replace(end, acted=max(end.acted, 1) if is_whole else 0, partly=bool(parts) and not is_whole)

    def _with_ends(self, end: TestEnd, here: list[Account]) -> TestEnd:
        """What became of the processes, as far as it decides about the test."""
        raised = [one.raised for one in here if one.raised is not None]
        failure = end.failure or next((one.failure for one in raised if one.failure is not None), None)
        exceeded = next((one.exceeded for one in here if one.exceeded is not None), None)
        died_at_work = [one for one in here if one.is_in_call and not one.is_alive]
        end = replace(
            end,
            failure=failure,
            timeout=end.timeout or exceeded,
            hits=end.hits + len(died_at_work),
            acted=end.acted + len(died_at_work),
        )
        for one in died_at_work:
            one.is_in_call = False
        if end.refused is not None and any(one.is_refusal for one in raised):
            end = replace(end, caught=False)
        if end.outcome == "failed" and end.failure is None and self._session.job.mutant is not None:
            end = replace(end, failure=self._lost(end, here))
        return end

    def _lost(self, end: TestEnd, here: list[Account]) -> str | None:
        """Why a failed test says nothing about the mutant, or None."""
        for one in here:
            code = self._host.exits.codes.get(one.began.pid)
            is_killed = code is not None and code < 0 and -code not in OWN_FAULT
            if code is not None and is_killed and not one.ended and not self._was_signalled(one):
                return f"the process {one.name} was killed from outside, by signal {-code}"
        if end.acted or self._acted or end.refused is not None:
            return None
        for one in here:
            if one.raised is not None and not one.raised.in_thread:
                why = f"{one.raised.exception.rpartition(':')[2]}: {one.raised.text.strip()}"
                return f"the process {one.name} ended before the mutant changed anything: {why}"
        return None

    def _was_signalled(self, member: Account) -> bool:
        """Whether the tests, or a process below them, sent it a signal."""
        sent = self._signalled | self._host.exits.signalled
        pid, group = member.began.pid, member.began.group
        return not sent.isdisjoint({pid, -pid, -group, ANYBODY})

    def _say_unable(self, began: Began) -> None:
        name = " ".join(began.command[:3])
        if self._session.job.inspect and name not in self._unable:
            self._unable.add(name)
            self._say_unseen(name, began.unable or "")

    def _say_unseen(self, name: str, why: str) -> None:
        text = f"nothing in this process is seen or mutated: {why}"
        self._session.pipe.send(Remark("processes", name, text))
