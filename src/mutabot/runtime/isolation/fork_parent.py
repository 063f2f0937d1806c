"""Trunk and branches: run the suite once as the original, and fork at the first moment a mutant differs.

At the first hit of a site the trunk forks one child for each of its mutants, or for each bunch of mutants
that behave alike. The child inherits everything that came before, takes on its mutant, and goes on to the end
of the session, as the whole suite would with the mutant in it; or until a test decides about it. The trunk
goes on as the original.

Several mutants in one branch, as long as they behave alike.

Alternatives that give one value at their place leave the program in one state, so one process does for all of
them until the place is evaluated again and they differ.

Tokens: whoever computes holds one, and there are as many as processes may run at a time.

The pool is a pipe with one byte per free token. A trunk hands its own token to the branch it forks and
waits for another one, which is either free in the pool or comes back with a branch that has ended. Branches
never touch the pool: the trunk gives back for them, however they ended.
"""

from __future__ import annotations

import mmap
import os
import select
import signal
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from time import monotonic, perf_counter  # tests may replace those of the module
from typing import Any, Protocol

from mutabot.model import Call, Choice, Mutant, Span
from mutabot.model.events import BranchDied, ForkEnded, TokensHeld, Unbranched, Undiverged
from mutabot.model.job import Branching
from mutabot.model.process_time import MOST, TimeUsed, overdue
from mutabot.runtime.event_file import EventFile
from mutabot.runtime.isolation.files import Apart, Foot
from mutabot.runtime.isolation.forkable import STARTED, open_now, why_not
from mutabot.runtime.isolation.lifeline import ALONE
from mutabot.runtime.plugins import alarm_held

#: a mutant's place on the board: how its branch ended, and which test it is in, -1 before any
_CELL = struct.Struct("=Bxxxi")


class Board:
    """How far branches are and how they have ended, by mutant, in memory that they share with their trunk."""

    def __init__(self, mutants: Iterable[Mutant]) -> None:
        self._places = {mutant.id: place for place, mutant in enumerate(mutants)}
        self._memory = mmap.mmap(-1, max(1, len(self._places)) * _CELL.size)

    def begin(self, mutant: str, test: int) -> None:
        """A branch of it is about to begin, in this test by its number in the session; -1 before any."""
        self._write(mutant, 0, test)

    def note(self, mutant: str, code: int) -> None:
        """Its branch ends like this."""
        self._write(mutant, code, self.test(mutant))

    def next_test(self, mutant: str) -> None:
        """Its branch begins another test."""
        self._write(mutant, self.code(mutant), self.test(mutant) + 1)

    def code(self, mutant: str) -> int:
        """What was noted last; 0 if its branch has not said how it ended."""
        return self._cell(mutant)[0]

    def test(self, mutant: str) -> int:
        """The number of the test that its branch is in."""
        return self._cell(mutant)[1]

    def _cell(self, mutant: str) -> tuple[int, int]:
        code, test = _CELL.unpack_from(self._memory, self._places[mutant] * _CELL.size)
        return code, test

    def _write(self, mutant: str, code: int, tests: int) -> None:
        _CELL.pack_into(self._memory, self._places[mutant] * _CELL.size, code, tests)


@dataclass(slots=True)
class Bunch:
    """The mutants that a branch is.

    Attributes:
        mutants: those that have behaved alike until now; the first one stands for all.
        choices: their alternatives in the program text, by id.
        board: where to note how the branch ends.
        part: told a place, and the alternatives there, by the value that they have, that are about to differ
            from those of the first mutant: they go on in other processes.
        part_all: from here on each goes on in a process of its own.
        is_copied: whether the test has forked copies of this process, in which mutants may have differed.
        waited: seconds that this process has waited, in the running test, for those that parted.
        is_parting: whether it is about to fork for them.
    """

    mutants: list[Mutant]
    choices: Mapping[str, tuple[Choice, ...]]
    board: Board
    part: Callable[[int, Sequence[frozenset[int]]], None]
    part_all: Callable[[], None]
    is_copied: bool = False
    waited: float = 0.0
    is_parting: bool = False

    @property
    def first(self) -> Mutant:
        """The mutant that stands for all."""
        return self.mutants[0]

    @property
    def watched(self) -> dict[int, frozenset[int]]:
        """The alternatives that the others are, by place."""
        found: dict[int, set[int]] = {}
        for mutant in self.mutants[1:]:
            for choice in self.choices[mutant.id]:
                found.setdefault(choice.place, set()).add(choice.index)
        return {place: frozenset(indexes) for place, indexes in found.items()}

    def take_out(self, place: int, indexes: frozenset[int]) -> list[Mutant]:
        """The mutants but the first that are these alternatives; they are no longer of this bunch."""
        places = {Choice(place, index) for index in indexes}
        out = [one for one in self.mutants[1:] if not places.isdisjoint(self.choices[one.id])]
        self.mutants = [one for one in self.mutants if one not in out]
        return out

    def end(self, code: int) -> list[str]:
        """The branch ends like this; the ids of the mutants for which that holds."""
        for mutant in self.known:
            self.board.note(mutant, code)
        return self.known

    @property
    def known(self) -> list[str]:
        """The ids of the mutants for which holds what this process sees."""
        return [mutant.id for mutant in (self.mutants[:1] if self.is_copied else self.mutants)]

    @property
    def test(self) -> int:
        """The number of the test that the branch is in."""
        return self.board.test(self.first.id)

    def next_test(self) -> None:
        """The branch begins another test."""
        for mutant in self.mutants:
            self.board.next_test(mutant.id)


BYTE = b"t"


class Tokens:
    """A trunk's side of the pool.

    Args:
        reading, writing: descriptors of the pool's ends; the reading end does not block.
        on_change: told how many tokens this trunk and its branches hold.

    A trunk begins with the token its starter took for it.
    """

    def __init__(self, reading: int, writing: int, on_change: Callable[[int], None]) -> None:
        self.reading = reading
        self._writing = writing
        self._on_change = on_change
        self.held = 1

    def take(self) -> bool:
        """Take a free token, if there is one."""
        try:
            taken = bool(os.read(self.reading, 1))
        except BlockingIOError:
            return False
        if taken:
            self.held += 1
            self._on_change(self.held)
        return taken

    def give_back(self) -> None:
        """Put one token back into the pool."""
        self.held -= 1
        self._on_change(self.held)
        with suppress(BlockingIOError):  # it is full, of what no trunk has put there
            os.write(self._writing, BYTE)

    def close(self) -> None:
        """In a branch: a mutant cannot write into the pool."""
        os.close(self.reading)
        os.close(self._writing)


#: exit code of a branch whose test decides about its mutant: no other test needs to run. These codes are
#: unlike any that a program would leave with by itself
DECIDED = 113
#: exit code of a branch that could not report
FAILED = ALONE
#: noted of a branch that has gone to the end of the session; its exit code is the suite's own
FINISHED = 114
#: exit code of a branch that stopped before it did what others would have noticed
STOPPED = 116

#: seconds by which a branch's time is extended at least
_LEAST = 0.2

#: where a mutant is branched: a site with its operation and pattern, or a place of the program text
Key = tuple[Span, str, str | None] | int
_NODES = "its nodes would meet those of other mutants"


@dataclass(slots=True)
class Child:
    """A branch that runs.

    Attributes:
        mutants: ids of the mutants that it began as.
        fork: its number among those that were forked here.
        pid, pidfd: its process.
        until: moment (``time.monotonic``) at which its time is up.
        limit: the seconds it was given for the test it is in.
        used: how much of them it has used.
        tests: which tests its mutants were in when that began.
        overdue, where: whether its time was up, and where it was then.
        hindered, is_starved: as in ``BranchDied``.
    """

    mutants: tuple[str, ...]
    fork: int
    pid: int
    pidfd: int
    until: float
    limit: float
    used: TimeUsed
    tests: tuple[int, ...]
    overdue: bool = False
    where: str | None = None
    hindered: str | None = None
    is_starved: bool = False

    def is_out_of_time(self, now: float) -> bool:
        """Whether it is to be ended. If the clock has run out, but not its time, it gets what is left."""
        if now < self.until or self.overdue:
            return False
        left = self.used.left(self.limit, [self.pid])
        if left > 0:
            self.until = now + max(left, _LEAST)
            return False
        self.hindered = self.used.hindrance([self.pid])
        self.is_starved = now >= self.used.began + MOST * self.limit
        return True


class Branch(Protocol):
    """The branch's side: what a process does that was forked from the trunk."""

    def begin(self) -> None:
        """First of all, right after the fork."""

    def become(self, bunch: Bunch, folder: str) -> None:
        """Last of all: go on from here as these mutants; ``folder`` is this process's own."""

    def give_up(self, mutants: Sequence[str], reason: str) -> None:
        """It cannot be kept apart from its trunk: leave."""


@dataclass(slots=True)
class Trunk:
    """The trunk's side of branching.

    Attributes:
        branching: what to branch.
        tests: the tests of the session, in their order.
        pipe: the file of events.
        apart: how a branch is kept apart from this process.
        branch: what every branch does.
        where_is: tells where a process is, in words, or None.
        has_nodes: whether nodes below a fork would meet those below others.
        has_started: whether processes of the program were started, which have run it as the original.
        is_moment: whether a mutant acts at a call, given the call's number among those of its site in the
            running test.
    """

    branching: Branching
    tests: tuple[str, ...]
    pipe: EventFile
    apart: Apart
    branch: Branch
    where_is: Callable[[int], str | None] = lambda _: None
    has_nodes: bool = False
    has_started: Callable[[], bool] = lambda: False
    is_moment: Callable[[Mutant, int], bool] = lambda mutant, number: True
    _tokens: Tokens = field(init=False)
    _board: Board = field(init=False)
    _live: dict[Key, list[Mutant]] = field(default_factory=dict)
    _gone: set[str] = field(default_factory=set)
    _children: dict[int, Child] = field(default_factory=dict)
    _known: frozenset[tuple[int, str]] = frozenset()
    _test: str = ""
    _number: int = -1
    _pid: int = field(default_factory=os.getpid)
    _overtaken: bool = False
    _forking: bool = False
    _copied: bool = False
    _bunch: Bunch | None = None

    def __post_init__(self) -> None:
        os.register_at_fork(before=self._note_copy)
        reading, writing = self.branching.tokens
        self._tokens = Tokens(reading, writing, lambda held: self.pipe.send(TokensHeld(held)))
        self._board = Board(self.branching.mutants)
        self._known = open_now()
        for mutant in self.branching.mutants:
            for key in self._keys(mutant):
                self._live.setdefault(key, []).append(mutant)

    def _keys(self, mutant: Mutant) -> list[Key]:
        """Where it is to be branched."""
        site = mutant.site.span, mutant.operation, mutant.pattern
        return [site, *(choice.place for choice in self.branching.choices.get(mutant.id, ()))]

    def begin_test(self, test: str) -> None:
        """A test is about to begin: fork for the mutants that may be hit in processes below it."""
        self._is_overtaken()  # also if no place is reached before
        self._test, self._number = test, self.tests.index(test)
        self._copied = False
        due = set(self.branching.at_start.get(test, ())) - self._gone
        if due and self.has_nodes:
            self._gone |= due
            self.pipe.send(Unbranched(test, tuple(sorted(due)), _NODES))
        elif due and os.getpid() == self._pid:
            with alarm_held():
                self._fork_due([[one] for one in self.branching.mutants if one.id in due])

    def fork_at(self, span: Span, call: Call, number: int) -> None:
        """Fork for every mutant that acts at this call and has no branch yet.

        In a branch this process is its mutant from here on.
        """
        pattern = call.pattern.text if call.pattern is not None else None
        key = (span, call.operation.target, pattern)
        here = self._live.get(key, ())
        self._fork([[one] for one in here if one.moment is None or self.is_moment(one, number)])

    def fork_at_place(self, place: int, alike: Sequence[frozenset[int]]) -> None:
        """The same at a place of the program text, for the mutants that are these alternatives.

        ``alike``: those that have one value now stand together.
        """
        here = self._live.get(place, ())
        bunches: list[list[Mutant]] = []
        for indexes in alike:
            found = [one for one in here if self._index(one) in indexes]
            bunches += [found] if min(indexes) >= 0 else [[one] for one in found]
        self._fork(bunches)

    def places(self) -> dict[int, frozenset[int]]:
        """The alternatives of the program text that are live in the running test, by place."""
        found = {place: [self._index(one) for one in self._live_at(place)] for place in self._places}
        return {place: frozenset(indexes) for place, indexes in found.items() if indexes}

    def tell_undiverged(self, hits: Mapping[int, int], early: Mapping[int, int]) -> None:
        """The test is over: tell which mutants of the program text were no different from the original.

        ``hits``: evaluations of each place in this test. If the test has forked copies of this process they
        are not all: a mutant may have differed in one, as in processes that were started before any test.
        ``early``: those before any test.
        """
        if self._copied or self._is_overtaken():
            return
        same = {
            mutant.id: hits.get(place, 0) + early.get(place, 0)
            for place in self._places
            if place in early or hits.get(place)
            for mutant in self._live_at(place)
            if self._index(mutant) >= 0
        }
        if same:
            self.pipe.send(Undiverged(self._test, same))

    @property
    def _places(self) -> list[int]:
        return [key for key in self._live if isinstance(key, int)]

    def _live_at(self, place: int) -> Iterator[Mutant]:
        return (one for one in self._live[place] if one.id not in self._gone)

    def _index(self, mutant: Mutant) -> int:
        """Which alternative the mutant is; negative if it cannot wait until that changes something."""
        return self.branching.choices[mutant.id][0].index

    def _fork(self, bunches: Sequence[Sequence[Mutant]]) -> None:
        if not any(bunches) or os.getpid() != self._pid:  # a copy that the test has forked for itself
            return
        with alarm_held():
            self._fork_due(bunches)

    def _fork_due(self, bunches: Sequence[Sequence[Mutant]]) -> None:
        found = [[mutant for mutant in bunch if mutant.id not in self._gone] for bunch in bunches]
        due = [bunch for bunch in found if bunch]
        ids = [mutant.id for bunch in due for mutant in bunch]
        self._gone.update(ids)
        for key, here in self._live.items():
            self._live[key] = [one for one in here if one.id not in self._gone]
        if not due:
            return
        if self._may_fork(ids):
            self._fork_each(due)

    def _may_fork(self, mutants: Sequence[str]) -> bool:
        """Whether forking is safe; if not, it is told that these mutants are not branched here."""
        own = (child.pid for child in self._children.values())
        reason = STARTED if self._is_overtaken() else self.apart.reason() or why_not(own, self._known)
        if reason is not None:
            self.pipe.send(Unbranched(self._test, tuple(mutants), reason))
        return reason is None

    def _is_overtaken(self) -> bool:
        """Whether processes were started before any test: what they did, they did as the original."""
        if self._number < 0:
            self._overtaken = self._overtaken or self.has_started()
        return self._overtaken

    def part_at_place(self, place: int, alike: Sequence[frozenset[int]]) -> None:
        """In a branch of several mutants: those that have another value now go on in branches of their own.

        One after the other, while this process waits: together they need the one token that they have.
        """
        bunch = self._bunch
        if bunch is not None and os.getpid() == self._pid:  # as above
            self._part(bunch, (bunch.take_out(place, indexes) for indexes in alike))

    def part_all(self) -> None:
        """The same for all of them: from here on each is in a process of its own."""
        bunch = self._bunch
        if bunch is not None and os.getpid() == self._pid:
            self._part(bunch, ([bunch.mutants.pop()] for _ in bunch.mutants[1:]))

    def _part(self, bunch: Bunch, parts: Iterable[list[Mutant]]) -> None:
        with alarm_held():
            for parting in parts:
                if self._may_fork([mutant.id for mutant in parting]):
                    began = perf_counter()
                    pid = self._fork_one(parting)
                    if pid == 0:
                        return
                    fork = self.pipe.forks
                    _, status = os.waitpid(pid, 0)
                    self._tell_end(fork, [one.id for one in parting], os.waitstatus_to_exitcode(status))
                    bunch.waited += perf_counter() - began

    def finish(self) -> None:
        """All tests are over: wait for the branches that still run, holding no token meanwhile."""
        self._tokens.give_back()
        while self._children:
            if self._reap(self._wait()):
                self._tokens.give_back()

    def _fork_each(self, bunches: Sequence[list[Mutant]]) -> None:
        for bunch in bunches:
            self._wait_while_paused()
            pid = self._fork_one(bunch)
            if pid == 0:
                return
            pidfd = os.pidfd_open(pid)
            ids = tuple(mutant.id for mutant in bunch)
            limit, used = self._limit(ids), TimeUsed.from_now()
            until, fork = used.began + limit, self.pipe.forks
            self._children[pidfd] = Child(ids, fork, pid, pidfd, until, limit, used, self._tests_of(ids))
            self._take_token()

    def _limit(self, mutants: Sequence[str]) -> float:
        """Seconds for the test that a branch is in; those that part wait for each other."""
        return max(self._wall(mutant) for mutant in mutants) * len(mutants)

    def _wall(self, mutant: str) -> float:
        test = self._test_of(mutant)
        return self.branching.walls.get(test, self.branching.wall) if test else self.branching.startup

    def _test_of(self, mutant: str) -> str:
        """The test that its branch was in when it was last heard of; the last one while the session ends.

        Empty before any test.
        """
        number = self._board.test(mutant)
        return self.tests[min(number, len(self.tests) - 1)] if number >= 0 else ""

    def _tests_of(self, mutants: Sequence[str]) -> tuple[int, ...]:
        return tuple(self._board.test(mutant) for mutant in mutants)

    def _fork_one(self, bunch: list[Mutant]) -> int:
        """Fork a branch; 0 in the branch, which is these mutants then."""
        for mutant in bunch:
            self._board.begin(mutant.id, self._number if self._bunch is None else self._bunch.test)
        foot = Foot()
        self.pipe.forks += 1
        reading, writing = os.pipe()
        self._note_forking(is_on=True)
        pid = os.fork()
        self._note_forking(is_on=False)
        if pid == 0:
            os.close(reading)
            self._become_branch(bunch, foot)
            os.close(writing)
            return pid
        os.close(writing)
        with open(reading, "rb") as ready:  # what it inherits must not change before it has its own
            ready.read()
        return pid

    def _note_forking(self, *, is_on: bool) -> None:
        self._forking = is_on
        if self._bunch is not None:
            self._bunch.is_parting = is_on

    def _note_copy(self) -> None:
        """This process is about to be forked, by whomever."""
        self._copied = self._copied or not self._forking
        if self._bunch is not None:
            self._bunch.is_copied |= not self._forking

    def _become_branch(self, mutants: list[Mutant], foot: Foot) -> None:
        self.branch.begin()
        self.pipe.go_on_apart()
        for child in self._children.values():
            os.close(child.pidfd)
        self._children.clear()
        if self._bunch is None:  # else those that it was forked from have closed them
            self._tokens.close()
            if self.branching.gate is not None:
                os.close(self.branching.gate)
        try:
            self.apart = self.apart.go(self.pipe.name)
        except OSError as error:
            why = f"a fork cannot have files of its own: {error.strerror or error}"
            self.branch.give_up([mutant.id for mutant in mutants], why)
        foot.restore()
        choices = {mutant.id: self.branching.choices.get(mutant.id, ()) for mutant in mutants}
        self._bunch = Bunch(mutants, choices, self._board, self.part_at_place, self.part_all)
        self._pid = os.getpid()
        self.branch.become(self._bunch, self.apart.folder)

    def _wait_while_paused(self) -> None:
        """Branches at work end meanwhile, and what they held goes back; the trunk keeps its own token."""
        gate = self.branching.gate
        while gate is not None and not self._is_open(gate):
            if self._reap(self._wait(gate)):
                self._tokens.give_back()

    @staticmethod
    def _is_open(gate: int) -> bool:
        poll = select.poll()
        poll.register(gate, select.POLLIN)
        return bool(poll.poll(0))

    def _take_token(self) -> None:
        """The trunk's token went to the branch: wait for another, from the pool or from a branch's end."""
        while self.branching.serial or not self._tokens.take():
            if self._reap(self._wait(None if self.branching.serial else self._tokens.reading)):
                return

    def _wait(self, other: int | None = None) -> list[int]:
        """Sleep until a branch ends, its time is up, or this ``other`` descriptor can be read."""
        poll = select.poll()
        for pidfd in self._children:
            poll.register(pidfd, select.POLLIN)
        if other is not None:
            poll.register(other, select.POLLIN)
        until = min((child.until for child in self._children.values()), default=None)
        timeout = None if until is None else max(0.0, until - monotonic()) * 1e3 + 1.0
        return [descriptor for descriptor, _ in poll.poll(timeout)]

    def _reap(self, ready: list[int]) -> bool:
        """Look after branches that ended or whose time is up. True if the trunk now has a token to spare.

        One branch at a time: each brings one token.
        """
        now = monotonic()
        for child in self._children.values():
            self._note_progress(child, now)
            if child.is_out_of_time(now):
                child.overdue = True
                child.where = self.where_is(child.pid)
                os.kill(child.pid, signal.SIGKILL)
        for descriptor in ready:
            child_ended = self._children.pop(descriptor, None)
            if child_ended is not None:
                self._bury(child_ended)
                return True
        return False

    def _note_progress(self, child: Child, now: float) -> None:
        """A branch whose time seems to be up may have begun another test meanwhile."""
        tests = self._tests_of(child.mutants) if now >= child.until else child.tests
        if tests != child.tests:
            child.tests, child.used = tests, TimeUsed.from_now([child.pid])
            child.limit = self._limit(child.mutants)
            child.until = now + child.limit

    def _bury(self, child: Child) -> None:
        _, status = os.waitpid(child.pid, 0)
        os.close(child.pidfd)
        code = os.waitstatus_to_exitcode(status)
        limit = overdue(child.limit, self._test_of(child.mutants[0])) if child.overdue else None
        self._tell_end(
            child.fork, child.mutants, code, overdue=limit,
            where=child.where, hindered=child.hindered, is_starved=child.is_starved,
        )  # fmt: skip

    def _tell_end(self, fork: int, mutants: Sequence[str], code: int, **more: Any) -> None:
        """How a branch has ended. Of several mutants nobody knows which of them made it die."""
        is_told = code in (DECIDED, STOPPED) or (code >= 0 and self._board.code(mutants[0]) == FINISHED)
        died = None
        if len(mutants) == 1 and (not is_told or more.get("overdue")):
            died = BranchDied(mutants[0], self._test_of(mutants[0]), code, **more)
        self.pipe.send(ForkEnded(fork, code, died))
