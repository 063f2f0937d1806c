"""Guard conditions, and the wait sets in which executors wait."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType
from typing import Any
from weakref import ref

from mutabot_ros.simulation.machine.scheduler import SCHEDULER
from mutabot_ros.simulation.middleware.graph import Destroyable, Participant, Waitable
from mutabot_ros.simulation.middleware.records import (
    MODULE,
    RCLError,
)


class GuardCondition(Waitable):
    """Wakes a wait set by hand."""

    def __init__(self, context: Participant) -> None:
        super().__init__()
        self.is_ready = False
        maker = sys._getframe(2)  # below it, rclpy's own class of guard conditions
        is_of_executor = maker.f_globals.get("__name__") == "rclpy.executors"
        self._executor = ref(maker.f_locals["self"]) if is_of_executor else None

    def trigger_guard_condition(self) -> None:
        self.is_ready = True
        self.changed()

    def reset(self) -> None:
        self.is_ready = False

    @property
    def tells_nothing_new(self) -> bool:
        """Whether an executor that begins to wait would look at the same again if this woke it.

        An executor triggers a guard condition of its own after each callback. One with a single thread that
        has no task under way has gathered everything since then, without a switch of threads. Waitables that
        are not rclpy's may count on being looked at once more.
        """
        executor = None if self._executor is None else self._executor()
        return (
            executor is not None
            and type(executor).__qualname__ == "SingleThreadedExecutor"
            and type(executor).__module__ == "rclpy.executors"
            and not executor._tasks
            and _are_rclpys(sys.modules["rclpy.waitable"].Waitable)
        )


def _are_rclpys(kind: Any) -> bool:
    """Whether all that is derived from a class is part of rclpy."""
    return all(one.__module__.startswith("rclpy.") and _are_rclpys(one) for one in kind.__subclasses__())


KINDS = ("subscription", "guard_condition", "timer", "client", "service", "event")


def _adder(kind: str) -> Callable[[WaitSet, Any], int]:
    """A method of a wait set: adds a member of a kind. An executor calls it for each of its entities."""

    def add(self: WaitSet, member: Any) -> int:
        members = self._members[kind]
        index = len(members)
        if index >= self._sizes[kind]:
            raise RCLError(f"failed to add {kind} to wait set: {kind}s set is full")
        members.append(member)
        return index

    return add


class WaitSet(Destroyable):
    """What an executor waits for."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__()
        *sizes, context = arguments
        if not context.is_up:
            raise RCLError("failed to initialize wait set: the given context is not valid")
        self._sizes = dict(zip(KINDS, sizes, strict=True))
        self._members: dict[str, list[Any]] = {}
        self._ready: dict[str, list[bool]] = {}
        self.clear_entities()

    def clear_entities(self) -> None:
        self._members = {kind: [] for kind in KINDS}
        self._ready = {}

    add_subscription = _adder("subscription")
    add_guard_condition = _adder("guard_condition")
    add_timer = _adder("timer")
    add_client = _adder("client")
    add_service = _adder("service")
    add_event = _adder("event")

    def wait(self, timeout: int) -> None:
        """Wait until something is ready, or for so many nanoseconds; for ever if negative."""
        if not any(self._members.values()):
            raise RCLError("failed to wait on wait set: wait set is empty")
        if timeout == 0:
            SCHEDULER.poll()
        self._look()
        if timeout and not SCHEDULER.is_preemptive:
            self._pass_over_what_is_known(sys._getframe(1))
        if timeout and not self._is_any_ready():
            self._park(None if timeout < 0 else SCHEDULER.now + timeout)
        elif timeout and SCHEDULER.is_preemptive:
            SCHEDULER.pause()
            self._look()
        if SCHEDULER.is_preemptive:
            self._keep_some()
        for guard in self._members["guard_condition"]:
            guard.reset()

    def _look(self) -> None:
        """Note which members are ready."""
        self._ready = {kind: [one.is_ready for one in members] for kind, members in self._members.items()}

    def _is_any_ready(self) -> bool:
        return any(map(any, self._ready.values()))

    def _pass_over_what_is_known(self, executor: FrameType) -> None:
        """Wait on if all that is ready is a guard condition that tells nothing new.

        Tasks that an executor has run just before this wait may have added nodes, or done what it waits for:
        it looks at that again only after the wait.
        """
        flags = self._ready["guard_condition"]
        if any(flags) and sum(map(sum, self._ready.values())) == 1:
            index = flags.index(True)
            guard = self._members["guard_condition"][index]
            if guard.tells_nothing_new and not executor.f_locals.get("yielded_work", True):
                guard.reset()
                flags[index] = False

    def _park(self, end: int | None) -> None:
        """Wait until one of the members is ready, which none is now, or until the end."""
        task = SCHEDULER.current
        members = [member for kind in KINDS for member in self._members[kind]]
        for member in members:
            member.watchers.append(task)
        try:
            while end is None or SCHEDULER.now < end:
                dues = [timer.deadline for timer in self._members["timer"]]
                deadlines = [due for due in (*dues, end) if due is not None]
                SCHEDULER.park(min(deadlines, default=None), "waits for ROS")
                self._look()
                if self._is_any_ready():
                    break
        finally:
            for member in members:
                member.watchers.remove(task)

    def _keep_some(self) -> None:
        """Report some of what is ready only, as the schedule says; the rest is ready at the next wait.

        All guard conditions are reported. An executor triggers again those whose callback it has not run yet,
        and runs it whether the wait reports them or not: if one stayed triggered, it would run twice.
        """
        places = [
            (kind, index)
            for kind in KINDS
            for index, is_ready in enumerate(self._ready[kind])
            if is_ready and kind != "guard_condition"
        ]
        if len(places) > 1:
            for (kind, index), is_kept in zip(places, SCHEDULER.schedule.keeps(len(places)), strict=True):
                self._ready[kind][index] = is_kept

    def is_ready(self, kind: str, index: int) -> bool:
        """Whether a member was ready after the wait; before one, whether there is a member."""
        flags = self._ready.get(kind)
        if flags is not None and index < len(flags):
            return flags[index]
        if kind not in self._sizes:
            raise RuntimeError(f"'{kind}' is not a known entity")
        if index >= self._sizes[kind]:
            raise IndexError("wait set index too big")
        return flags is None and index < len(self._members[kind])

    def get_ready_entities(self, kind: str) -> list[int]:
        if kind not in KINDS or kind == "event":
            raise RuntimeError(f"'{kind}' is not a known entity")
        flags = self._ready.get(kind, ())
        return [
            member.number for member, is_ready in zip(self._members[kind], flags, strict=False) if is_ready
        ]


for _kind in (GuardCondition, WaitSet):
    _kind.__module__ = MODULE
