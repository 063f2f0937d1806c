"""Guard conditions, and the wait sets in which executors wait."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ros_in_process.machine.scheduler import SCHEDULER
from ros_in_process.middleware.graph import Destroyable, Participant, Waitable
from ros_in_process.middleware.records import (
    MODULE,
    RCLError,
)


class GuardCondition(Waitable):
    """A condition that wakes a wait set when it is triggered."""

    def __init__(self, context: Participant) -> None:
        super().__init__()
        self.is_ready = False

    def trigger_guard_condition(self) -> None:
        self.is_ready = True
        self.changed()

    def reset(self) -> None:
        self.is_ready = False


KINDS = ("subscription", "guard_condition", "timer", "client", "service", "event")


def _adder(kind: str) -> Callable[[WaitSet, Any], int]:
    """Return a method that adds a member of a kind to a wait set; executors call it for each entity."""

    def add(self: WaitSet, member: Any) -> int:
        members = self._members[kind]
        index = len(members)
        if index >= self._sizes[kind]:
            raise RCLError(f"failed to add {kind} to wait set: {kind}s set is full")
        members.append(member)
        return index

    return add


class WaitSet(Destroyable):
    """The set of entities for which an executor waits.

    Attributes:
        is_over: whether the time for the wait had passed when it ended.
    """

    def __init__(self, *arguments: Any) -> None:
        super().__init__()
        *sizes, context = arguments
        if not context.is_up:
            raise RCLError("failed to initialize wait set: the given context is not valid")
        self.is_over = False
        self._sizes = dict(zip(KINDS, sizes, strict=True))
        self._members: dict[str, list[Any]] = {}
        self._ready: dict[str, list[bool]] = {}
        self.clear_entities()

    @classmethod
    def of(cls, members: Sequence[list[Any]], context: Participant) -> WaitSet:
        """Return a wait set of these members, by kind."""
        wait_set = cls(*map(len, members), context)
        wait_set._members = {kind: [*of_kind] for kind, of_kind in zip(KINDS, members, strict=True)}
        return wait_set

    def make_room(self, counts: Any) -> None:
        """Make room for more entities, as counted by rclpy's `NumberOfEntities`."""
        for kind in KINDS:
            self._sizes[kind] += getattr(counts, f"num_{kind}s")

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
        """Wait until something is ready, or for a number of nanoseconds; for ever if negative."""
        self._require_members()
        self.wait_until(None if timeout < 0 else SCHEDULER.now + timeout, polls=timeout == 0)

    def wait_until(
        self, end: int | None, *, polls: bool = False, known: GuardCondition | None = None
    ) -> None:
        """Wait until something is ready, or until the end; with ``polls``, only look.

        ``known``: a guard condition that means nothing new now: alone it is no reason to end the wait.
        """
        if polls or end is None:  # rclpy's executors have a timer among the members for any other time
            self._require_members()
        if polls:
            SCHEDULER.poll()
        self._look(end)
        is_preemptive = SCHEDULER.is_preemptive
        if not polls and not is_preemptive and known is not None and known.is_ready and not self.is_over:
            self._reset_guard(known)
        if not polls and not self.is_over and not self._is_any_ready():
            self._park(end)
        elif not polls and is_preemptive:
            SCHEDULER.pause()
            self._look(end)
        if is_preemptive:
            self._keep_some()
        for guard in self._members["guard_condition"]:
            guard.is_ready = False

    def _require_members(self) -> None:
        if not any(self._members.values()):
            raise RCLError("failed to wait on wait set: wait set is empty")

    def _look(self, end: int | None) -> None:
        """Record which members are ready, and whether the time is up."""
        self._ready = {
            kind: [member.is_ready for member in members] for kind, members in self._members.items()
        }
        self.is_over = end is not None and SCHEDULER.now >= end

    def _is_any_ready(self) -> bool:
        return any(map(any, self._ready.values()))

    def _reset_guard(self, known: GuardCondition) -> None:
        """Reset a guard condition if nothing else is ready."""
        if sum(map(sum, self._ready.values())) == 1:
            known.is_ready = False
            self._ready["guard_condition"] = [False] * len(self._members["guard_condition"])

    def _park(self, end: int | None) -> None:
        """Wait until a member is ready, as none is now, or until the end."""
        task = SCHEDULER.current
        watched = [member.watchers for members in self._members.values() for member in members]
        for watchers in watched:
            watchers.append(task)
        try:
            while end is None or SCHEDULER.now < end:
                dues = [timer.deadline for timer in self._members["timer"]]
                deadlines = [due for due in (*dues, end) if due is not None]
                SCHEDULER.park(min(deadlines, default=None), "waits for ROS")
                self._look(end)
                if self._is_any_ready():
                    break
        finally:
            for watchers in watched:
                watchers.remove(task)

    def _keep_some(self) -> None:
        """Report only some ready members, as the schedule chooses; the others are ready at the next wait.

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
        """Return whether a member was ready after the wait; before a wait, whether it exists."""
        flags = self._ready.get(kind)
        if flags is not None and index < len(flags):
            return flags[index]
        if kind not in self._sizes:
            raise RuntimeError(f"'{kind}' is not a known entity")
        if index >= self._sizes[kind]:
            raise IndexError("wait set index too big")
        return flags is None and index < len(self._members[kind])

    def has_ready(self, kind: str) -> bool:
        """Return whether a member of a kind was ready after the wait."""
        return any(self._ready[kind])

    def ready_numbers(self) -> set[int]:
        """Return the numbers of all members that were ready after the wait."""
        return {
            member.number
            for kind, flags in self._ready.items()
            if any(flags)
            for member, is_ready in zip(self._members[kind], flags, strict=True)
            if is_ready
        }

    def get_ready_entities(self, kind: str) -> list[int]:
        if kind not in KINDS or kind == "event":
            raise RuntimeError(f"'{kind}' is not a known entity")
        flags = self._ready.get(kind, ())
        return [
            member.number for member, is_ready in zip(self._members[kind], flags, strict=False) if is_ready
        ]


for _kind in (GuardCondition, WaitSet):
    _kind.__module__ = MODULE
