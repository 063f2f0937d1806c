"""Guard conditions, and the wait sets in which executors wait."""

from __future__ import annotations

from typing import Any

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
        self._is_triggered = False

    def trigger_guard_condition(self) -> None:
        self._is_triggered = True
        self.changed()

    @property
    def is_ready(self) -> bool:
        return self._is_triggered

    def reset(self) -> None:
        self._is_triggered = False


KINDS = ("subscription", "guard_condition", "timer", "client", "service", "event")


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

    def _add(self, kind: str, member: Any) -> int:
        members = self._members[kind]
        index = len(members)
        if index >= self._sizes[kind]:
            raise RCLError(f"failed to add {kind} to wait set: {kind}s set is full")
        members.append(member)
        return index

    def add_subscription(self, member: Any) -> int:
        return self._add("subscription", member)

    def add_guard_condition(self, member: GuardCondition) -> int:
        return self._add("guard_condition", member)

    def add_timer(self, member: Any) -> int:
        return self._add("timer", member)

    def add_client(self, member: Any) -> int:
        return self._add("client", member)

    def add_service(self, member: Any) -> int:
        return self._add("service", member)

    def add_event(self, member: Any) -> int:
        return self._add("event", member)

    def wait(self, timeout: int) -> None:
        """Wait until something is ready, or for so many nanoseconds; for ever if negative."""
        members = [member for kind in KINDS for member in self._members[kind]]
        if not members:
            raise RCLError("failed to wait on wait set: wait set is empty")
        if timeout == 0:
            SCHEDULER.poll()
        elif not any(member.is_ready for member in members):
            self._park(members, None if timeout < 0 else SCHEDULER.now + timeout)
        elif SCHEDULER.is_preemptive:
            SCHEDULER.pause()
        self._ready = {kind: [member.is_ready for member in self._members[kind]] for kind in KINDS}
        if SCHEDULER.is_preemptive:
            self._keep_some()
        for guard, is_ready in zip(
            self._members["guard_condition"], self._ready["guard_condition"], strict=True
        ):
            if is_ready:
                guard.reset()

    def _park(self, members: list[Any], end: int | None) -> None:
        task = SCHEDULER.current
        for member in members:
            member.watchers.append(task)
        try:
            while not any(member.is_ready for member in members) and (end is None or SCHEDULER.now < end):
                dues = [timer.deadline for timer in self._members["timer"]]
                deadlines = [due for due in (*dues, end) if due is not None]
                SCHEDULER.park(min(deadlines, default=None), "waits for ROS")
        finally:
            for member in members:
                member.watchers.remove(task)

    def _keep_some(self) -> None:
        """Report some of what is ready only, as the schedule says; the rest is ready at the next wait."""
        places = [
            (kind, index) for kind in KINDS for index, is_ready in enumerate(self._ready[kind]) if is_ready
        ]
        if len(places) > 1:
            for (kind, index), is_kept in zip(places, SCHEDULER.schedule.keeps(len(places)), strict=True):
                self._ready[kind][index] = is_kept

    def is_ready(self, kind: str, index: int) -> bool:
        """Whether a member was ready after the wait; before one, whether there is a member."""
        size = self._sizes.get(kind)
        if size is None:
            raise RuntimeError(f"'{kind}' is not a known entity")
        if index >= size:
            raise IndexError("wait set index too big")
        flags = self._ready.get(kind)
        if flags is None:
            return index < len(self._members[kind])
        return index < len(flags) and flags[index]

    def get_ready_entities(self, kind: str) -> list[int]:
        if kind not in KINDS or kind == "event":
            raise RuntimeError(f"'{kind}' is not a known entity")
        flags = self._ready.get(kind, ())
        return [
            member.number for member, is_ready in zip(self._members[kind], flags, strict=False) if is_ready
        ]


for _kind in (GuardCondition, WaitSet):
    _kind.__module__ = MODULE
