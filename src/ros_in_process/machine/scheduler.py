"""Runs all threads of a simulation in one native thread, in simulated time.

Each simulated thread is a greenlet. One runs until it waits; the scheduler then picks the next that can
run. When none can, time jumps to the earliest deadline. So waiting costs no wall time, the order of events
depends on the schedule alone, and `os.fork` takes every thread along. (A fork copies one native thread
only: threads that are native and hand over a baton would be lost in it.)
"""

from __future__ import annotations

import _thread
import gc
from collections.abc import Callable
from heapq import heappop, heappush
from itertools import count
from typing import Any, Protocol

from greenlet import greenlet

from ros_in_process.errors import Deadlock, NeedsRealRos
from ros_in_process.machine.schedules import FirstIn, Schedule

SECOND = 1_000_000_000
#: what reading a clock costs, so that two readings are never equal
READING = 1_000
#: number of fruitless polls in a row after which a poll takes time: a loop that polls must not stop time
PATIENCE = 64
#: the longest time that one fruitless poll takes
LONGEST_POLL = SECOND // 1_000
#: number of jumps of time after which garbage is collected, where it is not collected at any time
JUMPS = 10_000
#: alarms in a row that wake no task before the graph counts as stuck
FRUITLESS_ALARMS = 100_000


class SimulatedProcess(Protocol):
    """The process of simulated threads, as the scheduler, the middleware and the standard library use it.

    Attributes:
        contexts: its contexts of ROS.
        streams: of `sys`, those that are not its parent's.
        main_thread: what `threading.main_thread` gives there; None for that of the tests.
    """

    contexts: list[Any]
    streams: dict[str, Any]
    main_thread: Any


class SimulatedThread:
    """A simulated thread."""

    def __init__(self, number: int, run: greenlet, process: SimulatedProcess | None) -> None:
        self.number = number
        self.greenlet = run
        self.process = process
        self.waits = 0  # how often it has waited, by which an outdated deadline is recognized
        self.is_parked = False
        self.was_woken = False
        self.is_over = False
        self.pending: BaseException | None = None
        self.calls: list[Callable[[], object]] = []
        self.reason = ""
        self.sentinel: Any = None  # the lock that `Thread.join` waits for
        self.polls = 0  # looks without a wait, since something last happened
        self.seen_events = self.own_events = 0

    def __repr__(self) -> str:
        return f"<thread {self.number} of {self.process}>"


class Alarm:
    """A function that is called at a simulated time, unless cancelled."""

    def __init__(self, function: Callable[[], None]) -> None:
        self.function: Callable[[], None] | None = function

    def cancel(self) -> None:
        self.function = None


class Scheduler:
    """Simulated time, and the threads that share it."""

    def __init__(self) -> None:
        self.now = SECOND  # steady time, in nanoseconds
        self.epoch = 1_700_000_000 * SECOND  # the system time at steady time 0
        self.limit: int | None = None
        self.schedule: Schedule = FirstIn()
        self.is_preemptive = False  # whether the schedule switches where a thread need not wait
        self._numbers = count()
        self._native_thread = _thread.get_ident()
        self.main = SimulatedThread(next(self._numbers), greenlet.getcurrent(), None)
        self.current = self.main
        self._hub = greenlet(self._serve)
        self._ready: list[SimulatedThread] = []
        self._tasks: list[SimulatedThread] = []
        self._deadlines: list[tuple[int, int, SimulatedThread | Alarm, int]] = []
        self._order = count()
        self._events = 0  # counts what makes another look worth while
        self._jumps = 0
        self._dropped: list[
            SimulatedThread
        ] = []  # kept, because a greenlet that is freed runs its `finally` blocks
        self.on_switch: list[
            Callable[[SimulatedThread, SimulatedThread], None]
        ] = []  # what changes when another thread goes on

    def follow(self, schedule: Schedule) -> None:
        """Follow a schedule from now on."""
        self.schedule = schedule
        self.is_preemptive = not isinstance(schedule, FirstIn)

    @property
    def system_time(self) -> int:
        return self.now + self.epoch

    # --- threads ---

    def spawn(self, function: Callable[[], None], process: SimulatedProcess | None = None) -> SimulatedThread:
        """Start a thread; it runs when the schedule chooses it."""
        task = SimulatedThread(next(self._numbers), greenlet(None), process or self.current.process)
        task.greenlet = greenlet(lambda: self._run(task, function), self._hub)
        self._ready.append(task)
        self._tasks.append(task)
        self.progress()
        return task

    def _run(self, task: SimulatedThread, function: Callable[[], None]) -> None:
        try:
            if task.pending is None:
                function()
        except BaseException as error:  # no caller could report it
            self.interrupt(self.main, error)
        finally:
            task.is_over = True
            self._tasks.remove(task)
            if task.sentinel is not None and task.sentinel.locked():
                task.sentinel.release()

    def _serve(self, *_: object) -> None:
        """Continue with another thread when one has ended; ended greenlets return here."""
        while True:
            self._enter(self._next())

    def drop_process(self, process: SimulatedProcess) -> None:
        """Stop all threads of a process but the running one for ever, without their `finally` blocks."""
        for task in [task for task in self._tasks if task.process is process and task is not self.current]:
            task.is_over, task.is_parked = True, False
            if task in self._ready:
                self._ready.remove(task)
            self._tasks.remove(task)
            self._dropped.append(task)

    def end_thread(self) -> None:
        """End the running thread for ever."""
        self._dropped.append(self.current)
        self._tasks.remove(self.current)
        self.current.is_over = True
        self._hub.switch()

    # --- waiting ---

    def park(self, deadline: int | None = None, reason: str = "") -> bool:
        """Let other threads run until this one is woken (True) or the deadline has come (False)."""
        self._require_own_thread()
        task = self.current
        task.waits += 1
        task.is_parked, task.was_woken, task.reason = True, False, reason
        task.polls = 0
        if deadline is not None:
            heappush(self._deadlines, (deadline, next(self._order), task, task.waits))
        self._go_on(task)
        return task.was_woken

    def wake(self, task: SimulatedThread) -> None:
        """Let a waiting thread continue."""
        if task.is_parked and not task.is_over:
            task.is_parked, task.was_woken = False, True
            self._ready.append(task)
        self.progress()

    def interrupt(self, task: SimulatedThread, error: BaseException) -> None:
        """Raise an error in a thread, where it waits or as soon as it waits."""
        if task.pending is None:
            task.pending = error
        self.wake(task)

    def run_in(self, task: SimulatedThread, function: Callable[[], object]) -> None:
        """Run a function in a waiting thread, as Python runs signal handlers; then the thread waits on."""
        task.calls.append(function)
        self.wake(task)

    def sleep(self, duration: int) -> None:
        """Let `duration` nanoseconds pass, even if this thread is notified meanwhile."""
        end = self.now + max(duration, 0)
        if duration <= 0:
            self.pause()
        while self.now < end:
            self.park(end, "sleeps")

    def pause(self) -> None:
        """Let other ready threads run first."""
        self._require_own_thread()
        task = self.current
        self._collect_due()
        if self._ready or task.pending is not None:
            self._ready.append(task)
            self._go_on(task)

    def poll(self) -> None:
        """Count a poll that does not wait; if nothing but polls happens, they take time."""
        self.now += READING
        task = self.current
        by_others = self._events - task.own_events
        if task.seen_events != by_others:
            task.seen_events, task.polls = by_others, 0
        task.polls += 1
        if task.polls > PATIENCE:
            polls = task.polls
            self.park(self.now + min(LONGEST_POLL, READING << min((polls - PATIENCE) // 4, 20)), "polls")
            task.polls = polls

    def may_switch(self) -> None:
        """Mark a place at which a native thread could lose the processor; some schedules switch here."""
        if self.is_preemptive and self.schedule.switches_here() and self._is_own_thread():
            self.pause()

    def progress(self) -> None:
        """Note that something has happened, so that polling again makes sense for all other threads."""
        self._events += 1
        self.current.own_events += 1

    # --- alarms ---

    def call_at(self, deadline: int, function: Callable[[], None]) -> Alarm:
        """Call a function at a simulated time. It must not wait."""
        alarm = Alarm(function)
        heappush(self._deadlines, (deadline, next(self._order), alarm, 0))
        return alarm

    # --- choosing ---

    def _go_on(self, task: SimulatedThread) -> None:
        chosen = self._next()
        if chosen is not task:
            self._enter(chosen)
        while task.calls:
            task.calls.pop(0)()
        if task.pending is not None:
            error, task.pending = task.pending, None
            raise error

    def _enter(self, task: SimulatedThread) -> None:
        for change in self.on_switch:
            change(self.current, task)
        self.current = task
        task.greenlet.switch()

    def _next(self) -> SimulatedThread:
        """Return the thread to run next; time jumps if none is ready."""
        for _ in range(FRUITLESS_ALARMS):
            self._collect_due()
            if self._ready:
                return self._ready.pop(self.schedule.choose(len(self._ready)))
            if not self._deadlines:
                break
            self.now = max(self.now, self._deadlines[0][0])
            self._jumps += 1
            if self._jumps % JUMPS == 0 and not gc.isenabled():
                gc.collect()
            try:
                self.advanced()
            except BaseException as error:  # an observer of time ends the test
                return self._stop(error)
            if self.limit is not None and self.now > self.limit:
                self.limit = None
                return self._stop(self._deadlock("the test's limit of simulated time has passed"))
        return self._stop(self._deadlock("all threads wait, and nothing will ever wake one"))

    def advanced(self) -> float:
        """Return the time to which simulated time has jumped, s; a vocabulary may use it as clock tick."""
        return self.now / SECOND

    def _collect_due(self) -> None:
        deadlines = self._deadlines
        while deadlines and deadlines[0][0] <= self.now:
            _, _, what, waits = heappop(deadlines)
            if isinstance(what, Alarm):
                function, what.function = what.function, None
                if function is not None:
                    function()
            elif what.is_parked and what.waits == waits and not what.is_over:
                what.is_parked = False
                self._ready.append(what)

    def _deadlock(self, why: str) -> Deadlock:
        return Deadlock(f"{why}; the test's thread {self.main.reason or 'waits'}")

    def _stop(self, error: BaseException) -> SimulatedThread:
        """End the test by raising the error in its own thread."""
        self.main.pending = error
        self.main.is_parked = False
        if self.main in self._ready:
            self._ready.remove(self.main)
        return self.main

    # --- native threads ---

    def _is_own_thread(self) -> bool:
        return _thread.get_ident() == self._native_thread

    def _require_own_thread(self) -> None:
        if not self._is_own_thread():
            raise NeedsRealRos(
                "a native thread, started by a module outside the project, waits for a simulated one"
            )

    def after_fork(self) -> None:
        """Continue in a forked process, whose native thread has another number on some systems."""
        self._native_thread = _thread.get_ident()


#: the one simulation of this process
SCHEDULER = Scheduler()
