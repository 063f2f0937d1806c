"""Locks for simulated threads."""

from __future__ import annotations

import sys
from collections import deque

from ros_in_process.machine.imports import is_of_project
from ros_in_process.machine.scheduler import SCHEDULER, SECOND, SimulatedThread


def _is_asked_by_project() -> bool:
    """Return whether the project itself takes a lock; switches in rclpy would only find its own races."""
    frame = sys._getframe(2)
    if frame.f_code is Lock.__enter__.__code__ and frame.f_back is not None:
        frame = frame.f_back
    return is_of_project(str(frame.f_globals.get("__file__", "")))


class Lock:
    """`_thread.lock` for simulated threads."""

    def __init__(self) -> None:
        self._is_held = False
        self._waiting: deque[SimulatedThread] = deque()

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        if not blocking and timeout != -1:
            raise ValueError("can't specify a timeout for a non-blocking call")
        if timeout < 0 and timeout != -1:
            raise ValueError("timeout value must be a non-negative number")
        if SCHEDULER.is_preemptive and _is_asked_by_project():
            SCHEDULER.may_switch()
        if self._is_held and not (blocking and self._wait(timeout)):
            return False
        self._is_held = True
        return True

    def _wait(self, timeout: float) -> bool:
        deadline = None if timeout == -1 else SCHEDULER.now + round(timeout * SECOND)
        while self._is_held:
            task = SCHEDULER.current
            self._waiting.append(task)
            try:
                SCHEDULER.park(deadline, "waits for a lock or a condition")
            finally:
                if task in self._waiting:
                    self._waiting.remove(task)
            if self._is_held and deadline is not None and SCHEDULER.now >= deadline:
                return False
        return True

    def release(self) -> None:
        if not self._is_held:
            raise RuntimeError("release unlocked lock")
        self._is_held = False
        if self._waiting:
            SCHEDULER.wake(self._waiting.popleft())

    def locked(self) -> bool:
        return self._is_held

    def __enter__(self) -> bool:
        if self._is_held or SCHEDULER.is_preemptive:
            return self.acquire()
        self._is_held = True
        return True

    def __exit__(self, kind: object = None, error: object = None, trace: object = None) -> None:
        if self._waiting or not self._is_held:
            self.release()
        self._is_held = False

    def _at_fork_reinit(self) -> None:
        self._is_held = False


class RLock(Lock):
    """`_thread.RLock` for simulated threads."""

    def __init__(self) -> None:
        super().__init__()
        self._owner: SimulatedThread | None = None
        self._count = 0

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        if self._owner is not SCHEDULER.current:
            if not super().acquire(blocking, timeout):
                return False
            self._owner = SCHEDULER.current
        self._count += 1
        return True

    def release(self) -> None:
        if self._owner is not SCHEDULER.current:
            raise RuntimeError("cannot release un-acquired lock")
        self._count -= 1
        if not self._count:
            self._owner = None
            super().release()

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, kind: object = None, error: object = None, trace: object = None) -> None:
        self.release()

    def _at_fork_reinit(self) -> None:
        super()._at_fork_reinit()
        self._owner, self._count = None, 0

    # what `threading.Condition` asks for

    def _is_owned(self) -> bool:
        return self._owner is SCHEDULER.current

    def _recursion_count(self) -> int:
        return self._count if self._is_owned() else 0

    def _release_save(self) -> int:
        count = self._recursion_count()
        if count:
            self._count = 1
        self.release()
        return count

    def _acquire_restore(self, count: int) -> None:
        self.acquire()
        self._count = count
