"""The fork parent, which runs the suite once as the original and forks each mutant where it first differs.

At the first hit of a site the parent forks a child for each of the site's mutants. A child inherits all that
came before, takes on its mutant, and goes on to the end of the session, as the whole suite would with the
mutant in it; or until a test decides about the mutant. The parent goes on as the original.

A process that computes holds a token, and there are as many tokens as processes may run at a time. The pool
is a pipe with one byte for each free token. The parent hands its own token to the child that it forks, and
waits for another one, which is either free in the pool or comes back when a child ends. Children never touch
the
pool: the parent gives back for them, however they ended.
"""

from __future__ import annotations

import mmap
import os
import random
import select
import signal
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from io import TextIOWrapper

from mutabot.model import Mutant
from mutabot.model.activation import TEXT, Activation, Key, at_test, at_text, of_kind
from mutabot.model.clocks import monotonic
from mutabot.model.deadline import Deadline, Limit
from mutabot.model.events import ForkDied, ForkEnded, TestControls, TokensHeld, Undiverged, Unforked
from mutabot.model.files import real_open
from mutabot.model.job import STOP, Forking
from mutabot.operators.command import Identity
from mutabot.runtime.event_file import EventFile
from mutabot.runtime.isolation import forkable, namespaces
from mutabot.runtime.isolation.files import PrivateFiles
from mutabot.runtime.plugins import timers_held

#: exit code of a child whose test decides about its mutant: no other test needs to run. These codes are
#: unlike any that a program would leave with by itself
DECIDED = 113
#: exit code of a child that stopped before it did what others would have noticed
STOPPED = 116

#: bytes of a whole number on the board
_NUMBER_BYTES = 4
_TOKEN = b"t"

_NODES = "its nodes would meet those of other mutants"
_INTERRUPTED = "the campaign was interrupted"
#: seconds between two checks for that, while this process waits
_LOOKS = 0.5


@dataclass(slots=True)
class Child:
    """A running fork.

    Attributes:
        mutant: id of its mutant.
        is_control: whether that is a control, which goes on when the campaign is interrupted: what other
            forks have reported counts by it.
        is_test_control: whether that is a control of the test alone.
        fork: its number among those that were forked here.
        pids: its process, and what keeps its namespace.
        test: the number of the test that it was in when its time began.
        deadline: the time that it was given for that test.
        overdue: whether that was up.
        is_unwanted: whether it was ended, since the campaign was interrupted.
    """

    mutant: str
    is_control: bool
    is_test_control: bool
    fork: int
    pids: namespaces.ForkedPids
    test: int
    deadline: Deadline
    overdue: bool = False
    is_unwanted: bool = False

    def is_out_of_time(self, now: float) -> bool:
        """Return whether its time is up, so that it has to be ended."""
        return now >= self.deadline.until and not self.overdue and self.deadline.is_over(self.pids.fork)


@dataclass
class ForkParent:
    """Forks a child for each mutant.

    Attributes:
        forking: the mutants, and what children may use.
        tests: the tests of the session, in their order.
        event_file: the file of events.
        files: those of this process, which keep a child apart from it.
        active: how each mutant becomes active, by its id.
        become: called in a child, with its mutant and its folder: it goes on as that mutant.
        has_nodes: whether nodes below a child would meet those below others.
        has_started: whether processes of the program were started, which have run it as the original.
    """

    forking: Forking
    tests: tuple[str, ...]
    event_file: EventFile
    files: PrivateFiles
    active: Mapping[str, Activation]
    become: Callable[[Mutant, str], None]
    has_nodes: bool
    has_started: Callable[[], bool]

    def __post_init__(self) -> None:
        self._test, self._number, self._held, self._pid = "", -1, 1, os.getpid()
        self._test_controls = 0
        self._overtaken = self._forking = self._copied = self._stopped = False
        self._live: dict[Key, list[Mutant]] = {}
        self._gone: set[str] = set()
        self._children: dict[int, Child] = {}
        self._places: dict[int, frozenset[int]] | None = None
        self._of_control = Activation("")
        os.register_at_fork(before=self._note_copy)
        self._numbers = {test: number for number, test in enumerate(self.tests)}
        self._slots = {mutant.id: slot for slot, mutant in enumerate(self.forking.mutants)}
        # the board, which children write: whether each has gone to the end, and the number of its test
        count = len(self._slots) + 1  # the last is that of the controls that end with their test
        board = memoryview(mmap.mmap(-1, 2 * count * _NUMBER_BYTES)).cast("i")
        self._finished, self._tests = board[:count], board[count:]
        self._known = forkable.open_now()
        for mutant in self.forking.mutants:
            for key in self.forking.keys[mutant.id]:
                self._live.setdefault(key, []).append(mutant)

    def begin_test(self, test: str) -> None:
        """Fork, before a test begins, the mutants that differ from its start on."""
        self._is_overtaken()  # also if no place is reached before
        self._test, self._number = test, self._numbers[test]
        self._copied, self._test_controls = False, 0
        self._is_stopped()
        key = at_test(test)
        due = {mutant.id for mutant in self._live.get(key, ())} - self._gone
        if due and self.has_nodes:
            self._gone |= due
            self.event_file.send(Unforked(test, tuple(sorted(due)), _NODES))
        self.reach(key)

    @property
    def keys(self) -> Collection[Key]:
        """The keys that the parent waits for."""
        return self._live.keys()

    def reach(self, *keys: Key, is_due: Callable[[Mutant], bool] = lambda mutant: True) -> None:
        """Fork each mutant that differs from these keys on and has no process yet.

        In a child this process is its mutant from here on. ``is_due``: whether a mutant does differ.
        """
        here = [mutant for key in keys for mutant in self._live.get(key, ())]
        if here:
            self._fork([mutant for mutant in here if is_due(mutant)])

    def reach_alternatives(self, place: int, indexes: Iterable[int]) -> None:
        """Fork each mutant of the program text that may differ at a place from here on."""
        self.reach(*(at_text(place, index) for index in indexes))

    def places(self) -> dict[int, frozenset[int]]:
        """Return the alternatives of the program text that are live in the running test, by place."""
        if self._places is None:
            found: dict[int, set[int]] = {}
            for _, place, index in of_kind((key for key, here in self._live.items() if here), TEXT):
                found.setdefault(place, set()).add(index)
            self._places = {place: frozenset(indexes) for place, indexes in found.items()}
        return self._places

    def report_undiverged(self, hits: Mapping[int, int]) -> None:
        """Report, at the end of a test, which mutants of the program text did not differ in it.

        ``hits``: evaluations of each place in this test, and before any. If the test has forked copies of
        this process they are not all: a mutant may have differed in one, as in processes that were started
        before any test.
        """
        if self._copied or self._is_overtaken():
            return
        same = {
            mutant.id: hits[place]
            for _, place, index in of_kind(self._live, TEXT)
            if hits.get(place) and index >= 0
            for mutant in self._live[at_text(place, index)]
        }
        if same:
            self.event_file.send(Undiverged(self._test, same))

    def _fork(self, mutants: Iterable[Mutant]) -> None:
        due = [mutant for mutant in mutants if mutant.id not in self._gone]
        if not due or os.getpid() != self._pid:  # a copy that the test has forked for itself
            return
        with timers_held():
            self._gone.update(mutant.id for mutant in due)
            self._places = None
            for key, here in self._live.items():
                self._live[key] = [mutant for mutant in here if mutant.id not in self._gone]
            own = (pid for child in self._children.values() for pid in child.pids if pid is not None)
            due = self._wanted(due)
            reason = forkable.STARTED if self._is_overtaken() else self.files.forbids_fork()
            if due and (reason := reason or forkable.why_not(own, self._known)) is not None:
                self.event_file.send(Unforked(self._test, tuple(mutant.id for mutant in due), reason))
            elif due:
                self._fork_each([self._test_control_of(due[0]), *due] if self._number >= 0 else due)

    def _wanted(self, mutants: list[Mutant]) -> list[Mutant]:
        """Return the mutants to fork; after an interruption only controls, which other outcomes need."""
        if not self._is_stopped():
            return mutants
        unwanted = tuple(mutant.id for mutant in mutants if mutant.family != Identity.family)
        if unwanted:
            self.event_file.send(Unforked(self._test, unwanted, _INTERRUPTED))
        return [mutant for mutant in mutants if mutant.family == Identity.family]

    def _test_control_of(self, mutant: Mutant) -> Mutant:
        """Return the identity control at this mutant's place, which shows the effect of forking."""
        self._test_controls += 1
        name = Identity.name
        self._of_control = self.active[mutant.id].control()
        return Mutant(
            0, Identity.family, name, mutant.site, mutant.operation, mutant.pattern, None, self._test, name,
            provider=mutant.provider,
        )  # fmt: skip

    def is_test_control(self, mutant: Mutant) -> bool:
        """Return whether a mutant is the control of one test, whose process ends with that test."""
        return mutant.id not in self._slots

    def activation_of(self, mutant: Mutant) -> Activation:
        """Return the activation of a mutant or of the control of one test."""
        return self._of_control if self.is_test_control(mutant) else self.active[mutant.id]

    def end_test(self) -> None:
        """End a test: wait for its controls, holding no token meanwhile, and report their number."""
        if any(child.is_test_control for child in self._children.values()):
            self._give_back()
            while any(child.is_test_control for child in self._children.values()):
                self._is_stopped()
                if self._reap(self._wait()):
                    self._give_back()
            self._take_token()
        if self._test_controls:
            self.event_file.send(TestControls(self._test, self._test_controls))

    def _is_overtaken(self) -> bool:
        """Return whether processes were started before any test, which ran as the original."""
        if self._number < 0:
            self._overtaken = self._overtaken or self.has_started()
        return self._overtaken

    def _fork_each(self, mutants: Sequence[Mutant]) -> None:
        began = monotonic()
        for mutant in mutants:
            if not self._wanted([mutant]):
                continue
            try:
                pids = self._fork_one(mutant, began)
            except OSError as error:
                self._report_unforked(mutant, error)
                continue
            if pids is None:
                return
            deadline = Deadline(self._limit(self._number), is_counted=True)
            is_control, is_test_control = mutant.family == Identity.family, self.is_test_control(mutant)
            fork = self.event_file.forks
            child = Child(mutant.id, is_control, is_test_control, fork, pids, self._number, deadline)
            self._children[pids.fork] = child
            self._take_token()
        if not self._children:  # else a test of the original may notice, which the campaign will see
            with suppress(OSError):
                namespaces.leave_out(monotonic() - began)

    def _fork_one(self, mutant: Mutant, began: float) -> namespaces.ForkedPids | None:
        """Fork. Return None in the child, which becomes this mutant and continues at the time ``began``."""
        slot = self._slots.get(mutant.id, -1)
        self._finished[slot], self._tests[slot] = 0, self._number
        # random registers a hook that seeds anew in every child
        state, loop = random.getstate(), forkable.running_loop()
        for stream in (sys.stdout, sys.stderr):
            if issubclass(type(stream), TextIOWrapper):  # a test may put anything there
                with suppress(OSError, ValueError):  # it may be closed
                    stream.flush()
        self.event_file.forks += 1
        reading, writing = os.pipe()
        self._forking = True
        try:
            pids = namespaces.fork()
        except OSError:
            os.close(reading)
            os.close(writing)
            raise
        finally:
            self._forking = False
        if pids is None:
            os.close(reading)
            namespaces.die_with_parent(pipe=writing)
            random.setstate(state)
            forkable.mark_running(loop)
            self._begin_child(mutant, began)
            os.close(writing)
            return None
        os.close(writing)
        # what it inherits must not change before it has its own
        with real_open(reading, "rb") as ready:
            ready.read()
        return pids

    def _begin_child(self, mutant: Mutant, began: float) -> None:
        """Release what belongs to the parent, and become the mutant."""
        os.setsid()  # it leads its group and session, as a test process does
        self.event_file.continue_separately()
        try:
            folder = self.files.enter(self.event_file.name)
            self.event_file.keep_number()
            namespaces.leave_out(monotonic() - began)
        except OSError as error:
            try:
                self._report_unforked(mutant, error)
            finally:
                os._exit(STOPPED)
        self.become(mutant, folder)

    def _report_unforked(self, mutant: Mutant, error: OSError) -> None:
        why = f"a fork cannot be isolated: {error.strerror or error}"
        self.event_file.send(Unforked(self._test, (mutant.id,), why))

    def _note_copy(self) -> None:
        """Note that this process is about to be forked."""
        self._copied = self._copied or not self._forking

    def note_finished(self, mutant: str) -> None:
        """In a child, note that it has reached the end of the session."""
        self._finished[self._slots[mutant]] = 1

    def note_test(self, mutant: str, test: str | None = None) -> None:
        """In a child, note that it begins a test, which the parent need not have; None after the last one."""
        slot = self._slots.get(mutant, -1)
        number = len(self.tests) if test is None else self._numbers.get(test, max(self._tests[slot], 0))
        self._tests[slot] = number

    def finish(self) -> None:
        """Wait, after all tests, for children that still run, without holding a token."""
        self._give_back()
        while self._children:
            self._is_stopped()
            if self._reap(self._wait()):
                self._give_back()

    def _is_stopped(self) -> bool:
        """Return whether the campaign was interrupted, so that no more mutants begin and others are ended."""
        if not self._stopped and os.path.exists(os.path.join(self.files.home, STOP)):
            self._stopped = True
            # controls may end by themselves, and who has reached the end of the session
            ends = (child for child in self._children.values() if not child.is_control)
            unwanted = [child for child in ends if not self._finished[self._slots[child.mutant]]]
            for child in unwanted:
                child.is_unwanted = True
                os.kill(child.pids.fork, signal.SIGKILL)
            for child in unwanted:
                self._report_end(self._children.pop(child.pids.fork))
        return self._stopped

    def _limit(self, test: int) -> Limit:
        """Return the time limit of a fork for a test, by its number; -1 before any."""
        if test < 0:
            return self.forking.startup
        return self.forking.limits.get(self._name_of(test), self.forking.limit)

    def _name_of(self, test: int) -> str:
        """Return the node id of a test by its number: empty before any, the last one as the session ends."""
        return self.tests[min(test, len(self.tests) - 1)] if test >= 0 else ""

    def _take_token(self) -> None:
        """Wait for a token, from the pool or from a child's end, as the parent's went to the child."""
        with self._pool() as opened:
            pool = None if self.forking.serial else opened  # then no other child may run meanwhile
            while (pool is None and self._children) or (pool is not None and not self._take_free(pool)):
                if self._is_stopped() or self._reap(self._wait(pool)):
                    return

    def _take_free(self, pool: int) -> bool:
        try:
            taken = bool(os.read(pool, 1))
        except BlockingIOError:
            return False
        if taken:
            self._hold(self._held + 1)
        return taken

    def _give_back(self) -> None:
        """Return a token to the pool."""
        self._hold(self._held - 1)
        with self._pool() as pool, suppress(BlockingIOError):  # it is full, of what no parent has put there
            if pool is not None:
                os.write(pool, _TOKEN)

    @contextmanager
    def _pool(self) -> Iterator[int | None]:
        """Open the pipe of the token pool for a moment only, since tests may count open descriptors."""
        try:
            pool = os.open(self.forking.tokens, os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC)
        except OSError:  # the test gave up the right to: what ends is all that there is
            yield None
            return
        try:
            yield pool
        finally:
            os.close(pool)

    def _hold(self, count: int) -> None:
        self._held = count
        self.event_file.send(TokensHeld(count))

    def _wait(self, other: int | None = None) -> list[int]:
        """Wait until children end or exceed their limit, or ``other`` is readable. Return the ended ones."""
        until = min((child.deadline.until for child in self._children.values()), default=float("inf"))
        timeout = min(max(0.0, until - monotonic()), _LOOKS) * 1e3 + 1.0
        poll, children = select.poll(), {os.pidfd_open(pid): pid for pid in self._children}
        try:
            for descriptor in children if other is None else (*children, other):
                poll.register(descriptor, select.POLLIN)
            return [children[descriptor] for descriptor, _ in poll.poll(timeout) if descriptor in children]
        finally:
            for descriptor in children:
                os.close(descriptor)

    def _reap(self, ready: list[int]) -> bool:
        """Handle children that ended or exceeded their limit. Return whether the parent has a token to spare.

        One child at a time: each brings one token.
        """
        now = monotonic()
        for child in self._children.values():
            self._note_progress(child, now)
            if child.is_out_of_time(now):
                child.overdue = True
                os.kill(child.pids.fork, signal.SIGKILL)
        for pid in ready[:1]:
            self._report_end(self._children.pop(pid))
        return bool(ready)

    def _note_progress(self, child: Child, now: float) -> None:
        """Read whether a child whose time seems to be up has begun another test meanwhile."""
        is_late = now >= child.deadline.until and not child.is_test_control
        test = self._tests[self._slots[child.mutant]] if is_late else child.test
        if test != child.test:
            child.test, child.deadline = test, Deadline(self._limit(test))

    def _report_end(self, child: Child) -> None:
        """Report how a child has ended."""
        _, status = os.waitpid(child.pids.fork, 0)
        namespaces.end_first(child.pids.first)
        code, slot = os.waitstatus_to_exitcode(status), self._slots.get(child.mutant, -1)
        # at the end of the session the exit code is the suite's own; a silent control is missed
        is_reported = (
            code in (DECIDED, STOPPED) or child.is_test_control or (code >= 0 and self._finished[slot])
        )
        died = None
        if child.is_unwanted and not is_reported:
            self.event_file.send(Unforked(self._test, (child.mutant,), _INTERRUPTED))
        elif not is_reported or (child.overdue and not child.is_test_control):
            test, deadline = self._name_of(self._tests[slot]), child.deadline
            died = ForkDied(
                child.mutant, test, code, deadline.overdue(test) if child.overdue else None,
                hindered=deadline.hindered, is_starved=deadline.is_starved,
            )  # fmt: skip
        self.event_file.send(ForkEnded(child.fork, code, died))
