"""Dispatches units to workers, one at a time each, and returns their answers.

A worker that dies, hangs or goes away with a unit is not the mutant's fault: the unit goes to another, at
most three times. It goes to one that it has failed at only where there is no other; one at which units fail
one after the other gets none any more.
"""

from __future__ import annotations

import queue
import time
from collections import deque
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from itertools import count
from secrets import token_hex

from mutabot.api.processes import Answer, Result, Task, interruptible

from . import worker_side
from .connection import ClusterConnection
from .link import WorkerReply, one_line
from .unit import InvalidData, UnitAnswer, WorkUnit

#: how often a unit is tried: at first, and three times elsewhere
TRIES = 4
#: seconds between two looks at all
_PERIOD = 0.2
#: seconds for a worker's own work around a unit, at most
_GRACE = 300.0
#: seconds in which a worker that has come may get ready for what was lost elsewhere
_COMING = 60.0
#: seconds without any worker until that is reported, and until the campaign goes on without the cluster
_REPORTED_AFTER, _PATIENCE = 5.0, 600.0


@dataclass(slots=True)
class _RunningTask:
    """A task that is running on a worker.

    Attributes:
        task: the task.
        faults: how it was lost, one entry each.
        avoided: the workers with which it was.
        answer: what became of the task where it was lost last, if that is known.
        unit: what the worker that runs it was given.
        until: when (``time.monotonic``) it must have ended, whatever it does.
        number: distinguishes it from others.
        lost_at: when it was lost last.
    """

    task: Task
    faults: list[str] = field(default_factory=list)
    avoided: set[str] = field(default_factory=set)
    answer: Answer | None = None
    unit: WorkUnit | None = None
    until: float = 0.0
    number: int = field(default_factory=count(1).__next__)
    lost_at: float = 0.0


class Dispatch:
    """Runs tasks on a cluster.

    Args:
        connection: the cluster.
        tasks: what is to be run; taken as places free up.
    """

    def __init__(self, connection: ClusterConnection, tasks: Iterator[Task]) -> None:
        self._connection, self._tasks = connection, tasks
        self._ground = connection.ground
        self._again: deque[_RunningTask] = deque()
        self._running: dict[int, tuple[str, _RunningTask]] = {}
        self._settled: deque[Answer] = deque()
        self._next = self._taken()
        self._lonely_since: float | None = None
        self._was_reported = False

    def answers(self) -> Iterator[Answer | Task]:
        """Yield answers, and the tasks that have to run on this machine if the cluster is given up."""
        try:
            while self._running or self._again or self._next is not None:
                self._assign()
                self._wait()
                while self._settled:
                    yield self._settled.popleft()
                if not self._can_go_on():
                    yield from self._rest()
                    return
        finally:
            self._connection.link.forget(*self._running)

    def _taken(self) -> _RunningTask | None:
        task = next(self._tasks, None)
        return _RunningTask(task) if task is not None else None

    def _assign(self) -> None:
        busy = {worker for worker, _ in self._running.values()}
        fit = self._connection.roster.fit
        for worker in (name for name in fit if name not in busy):
            trial = self._next_trial(worker, fit)
            if trial is None:
                continue
            trial.unit = WorkUnit(self._ground, trial.task, token_hex(16))
            trial.until = time.monotonic() + longest(trial.task)
            number = self._connection.link.ask(worker, worker_side.run_unit, trial.unit.data())
            self._running[number] = worker, trial

    def _next_trial(self, worker: str, fit: Collection[str]) -> _RunningTask | None:
        """Return the next trial for a worker: first one lost once; one lost more often when all have begun.

        Losses come together, as where a cluster is taken away piece by piece: later tries are better later.
        What was lost at this worker waits for another, if there is one.
        """
        trial = next((task for task in self._again if self._may_run(task, worker, fit)), None)
        if trial is not None and (self._next is None or len(trial.faults) < 2):
            self._again.remove(trial)
            return trial
        trial, self._next = self._next, None if self._next is None else self._taken()
        return trial

    def _may_run(self, trial: _RunningTask, worker: str, fit: Collection[str]) -> bool:
        """Return whether a worker may run a trial that it lost before: only if there is no other worker."""
        if worker not in trial.avoided:
            return True
        is_coming = time.monotonic() < trial.lost_at + _COMING
        others = {*fit, *(self._connection.roster.usable if is_coming else ())} - trial.avoided
        return not others

    def _wait(self) -> None:
        roster, link = self._connection.roster, self._connection.link
        try:
            with interruptible():
                reply = link.replies.get(timeout=_PERIOD)
            while True:
                if not roster.take(reply):
                    self._take(reply)
                reply = link.replies.get_nowait()
        except queue.Empty:
            pass
        gone = roster.update()
        now = time.monotonic()
        for number, (worker, trial) in list(self._running.items()):
            if worker in gone or now > trial.until:
                del self._running[number]
                link.forget(number)
                why = "its worker was lost" if worker in gone else "no answer in all the time it may take"
                self._lost(trial, worker, why)

    def _take(self, reply: WorkerReply) -> None:
        worker, trial = self._running.pop(reply.asked, ("", None))
        if trial is None or trial.unit is None:
            return
        if reply.data is None:
            if reply.is_foreign:
                self._connection.roster.refuse(worker, reply.why)
            self._lost(trial, worker, f"its worker gave no answer: {reply.why}")
            return
        try:
            answer = UnitAnswer.of(reply.data, trial.unit)
        except InvalidData as error:
            self._reject(trial, worker, one_line(str(error)))
            return
        if answer.fault is not None:
            trial.answer = None if answer.is_unfit else answer.found
            if answer.is_unfit:
                self._connection.roster.refuse(worker, answer.fault)
            self._lost(trial, worker, one_line(answer.fault))
            return
        self._connection.roster.record_run(worker)
        self._connection.done += 1
        self._settled.append(answer.found or Answer([], Result(trial.task, lost=answer.lost)))

    def _reject(self, trial: _RunningTask, worker: str, why: str) -> None:
        """Reject a wrong answer, and refuse the worker from now on."""
        self._connection.roster.refuse(worker, f"its answer does not fit: {why}")
        lost = f"the answer of its worker does not fit: {why} ({worker})"
        self._settled.append(Answer([], Result(trial.task, lost=lost)))

    def _lost(self, trial: _RunningTask, worker: str, why: str) -> None:
        trial.faults.append(f"{why} ({worker})")
        trial.avoided.add(worker)
        trial.lost_at = time.monotonic()
        self._connection.roster.record_failure(worker, trial.number, trial.avoided, why)
        if len(trial.faults) < TRIES:
            self._again.append(trial)
            self._again = deque(sorted(self._again, key=lambda task: len(task.faults)))
            return
        if trial.answer is not None:  # what ended it each time may be the mutant after all: the judge knows
            self._settled.append(trial.answer)
            return
        lost = f"{TRIES} workers could not run it: {'; '.join(dict.fromkeys(trial.faults))}"
        self._settled.append(Answer([], Result(trial.task, lost=lost)))

    def _can_go_on(self) -> bool:
        """Return whether there is a cluster; reconnect or wait if necessary."""
        cluster = self._connection
        if cluster.link.is_lost:
            self._again.extendleft(trial for _, trial in self._running.values())
            self._running.clear()
            if not cluster.reconnect():
                cluster.give_up(f"the scheduler at {cluster.link.address} does not come back")
                return False
        cluster.restart_workers()
        if self._running or cluster.roster.fit:
            self._lonely_since = None
            return True
        now = time.monotonic()
        self._lonely_since = self._lonely_since or now
        if cluster.link.workers and not cluster.roster.usable:
            cluster.give_up("no worker can be used")
            return False
        if now - self._lonely_since > _PATIENCE:
            cluster.give_up(f"no worker has come to {cluster.link.address} for {_PATIENCE / 60:.0f} minutes")
            return False
        if now - self._lonely_since > _REPORTED_AFTER and not self._was_reported:
            self._was_reported = True
            cluster.notify(f"no worker is at {cluster.link.address}: waiting for one")
        return True

    def _rest(self) -> Iterator[Task]:
        """Yield tasks that have begun and have no answer, and the remaining ones."""
        for trial in (*(task for _, task in self._running.values()), *self._again, self._next):
            if trial is not None:
                yield trial.task


def longest(task: Task) -> float:
    """Return the seconds after which a worker's answer is given up; limits inside end a task much earlier."""
    walls = [task.deadlines.get(test, task.deadline).wall for test in task.job.tests or ()]
    forking = task.job.forking
    if forking is not None:
        suite = [forking.limits.get(test, forking.limit).wall for test in task.job.tests or ()]
        walls += [task.deadline.wall, *suite, len(forking.mutants) * sum(suite)]
    return _GRACE + 2 * (task.startup.wall + sum(walls))
