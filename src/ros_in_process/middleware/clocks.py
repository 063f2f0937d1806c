"""Clocks, waiting until a clock reaches a time, and timers."""

from __future__ import annotations

from typing import Any

from ros_in_process.machine.scheduler import SCHEDULER
from ros_in_process.middleware.graph import Destroyable, Participant, Waitable
from ros_in_process.middleware.records import (
    MODULE,
    ClockChange,
    ClockType,
    RCLError,
    TimerCancelledError,
    rcl_time_point_t,
)


class RosClock(Destroyable):
    """System, steady or ROS time; the last follows `/clock` while it is overridden."""

    def __init__(self, kind: int) -> None:
        super().__init__()
        try:
            self.kind = ClockType(int(kind))
        except ValueError:
            raise RCLError("failed to initialize clock: error not set") from None
        self.is_overridden = False
        self._override = 0
        self._callbacks: list[tuple[Any, bool, int, int]] = []
        self.timers: list[Timer] = []
        self.events: list[ClockEvent] = []

    def now(self) -> int:
        """Return the clock's time in nanoseconds; reading it takes no time."""
        if self.is_overridden:
            return self._override
        return SCHEDULER.now if self.kind is ClockType.STEADY_TIME else SCHEDULER.system_time

    def steady_time_of(self, time: int) -> int | None:
        """Return the steady time at which it will show a time; None if that depends on `/clock`."""
        return None if self.is_overridden else SCHEDULER.now + time - self.now()

    def get_now(self) -> rcl_time_point_t:
        SCHEDULER.poll()
        return rcl_time_point_t(self.now(), self.kind)

    def get_ros_time_override_is_enabled(self) -> bool:
        return self.is_overridden

    def set_ros_time_override_is_enabled(self, enabled: bool) -> None:
        if self.kind is not ClockType.ROS_TIME:
            raise RCLError("failed to set ROS time override: clock is not of type ROS_TIME")
        if enabled == self.is_overridden:
            return
        change = ClockChange.ROS_TIME_ACTIVATED if enabled else ClockChange.ROS_TIME_DEACTIVATED
        concerned = [entry for entry in self._callbacks if entry[1]]
        credits = [(timer, timer.next_call - self.now()) for timer in self.timers if self.now()]
        self._before(concerned)
        self.is_overridden = enabled
        for timer, credit in credits:
            timer.change_epoch(credit)
        self._after(concerned, change, 0)

    def set_ros_time_override(self, time: rcl_time_point_t) -> None:
        delta = time.nanoseconds - self._override
        if not self.is_overridden:
            self._override = time.nanoseconds
            return
        concerned = [
            entry
            for entry in self._callbacks
            if (entry[2] and delta >= entry[2]) or (entry[3] and delta <= entry[3])
        ]
        self._before(concerned)
        self._override = time.nanoseconds
        for timer in self.timers:
            timer.follow_jump()
        self._after(concerned, ClockChange.ROS_TIME_NO_CHANGE, delta)

    @staticmethod
    def _before(concerned: list[tuple[Any, bool, int, int]]) -> None:
        for handle, *_ in concerned:
            if handle._pre_callback:
                handle._pre_callback()

    def _after(self, concerned: list[tuple[Any, bool, int, int]], change: Any, delta: int) -> None:
        for handle, *_ in concerned:
            if handle._post_callback:
                handle._post_callback({"clock_change": change, "delta": delta})
        for waiting in (*self.timers, *self.events):
            waiting.changed()

    def add_clock_callback(self, handle: Any, on_clock_change: bool, forward: int, backward: int) -> None:
        self._callbacks.append((handle, on_clock_change, forward, backward))

    def remove_clock_callback(self, handle: Any) -> None:
        self._callbacks = [entry for entry in self._callbacks if entry[0] is not handle]


class ClockEvent(Waitable):
    """An event on which a thread waits until a clock reaches a time, or until it is set."""

    def __init__(self) -> None:
        super().__init__()
        self.is_ready = False

    def set(self) -> None:
        self.is_ready = True
        self.changed()

    def clear(self) -> None:
        self.is_ready = False

    def is_set(self) -> bool:
        return self.is_ready

    def _wait_until(self, clock: RosClock, until: rcl_time_point_t) -> None:
        task = SCHEDULER.current
        clock.events.append(self)
        self.watchers.append(task)
        try:
            while not self.is_ready and clock.now() < until.nanoseconds:
                SCHEDULER.park(clock.steady_time_of(until.nanoseconds), "sleeps until a clock shows a time")
        finally:
            self.watchers.remove(task)
            clock.events.remove(self)

    wait_until_steady = wait_until_system = wait_until_ros = _wait_until


class Timer(Waitable):
    """A timer that is due once in each period of a clock."""

    def __init__(self, clock: RosClock, context: Participant, period: int, autostart: bool = True) -> None:
        super().__init__()
        if period < 0:
            raise RCLError("failed to create timer: timer period must be non-negative")
        self.clock = clock
        self._period = int(period)
        self._is_cancelled = not autostart
        self._last_call = clock.now()
        self.next_call = self._last_call + self._period
        clock.timers.append(self)

    def _release(self) -> None:
        self.clock.timers.remove(self)

    @property
    def is_ready(self) -> bool:
        return not self._is_cancelled and self.clock.now() >= self.next_call

    @property
    def deadline(self) -> int | None:
        """The steady time at which it will be due; None if never, or if that depends on `/clock`."""
        return None if self._is_cancelled else self.clock.steady_time_of(self.next_call)

    def is_timer_ready(self) -> bool:
        return self.is_ready

    def call_timer_with_info(self) -> dict[str, int]:
        if self._is_cancelled:
            raise TimerCancelledError("failed to call timer: timer is canceled")
        now = self.clock.now()
        expected, self._last_call = self.next_call, now
        self.next_call += self._period
        if self.next_call < now:  # late by more than a period: those that were missed are left out
            missed = 1 + (now - self.next_call - 1) // self._period if self._period else 0
            self.next_call = self.next_call + missed * self._period if self._period else now
        return {"expected_call_time": expected, "actual_call_time": now}

    def call_timer(self) -> None:
        if self._is_cancelled:
            raise RCLError("failed to call timer: timer is canceled")
        self.call_timer_with_info()

    def cancel_timer(self) -> None:
        self._is_cancelled = True

    def is_timer_canceled(self) -> bool:
        return self._is_cancelled

    def reset_timer(self) -> None:
        self._is_cancelled = False
        self.next_call = self.clock.now() + self._period
        self.changed()

    def change_timer_period(self, period: int) -> None:
        self._period = int(period)

    def get_timer_period(self) -> int:
        return self._period

    def time_since_last_call(self) -> int:
        return self.clock.now() - self._last_call

    def time_until_next_call(self) -> int | None:
        return None if self._is_cancelled else self.next_call - self.clock.now()

    def change_epoch(self, credit: int) -> None:
        """Continue with the rest of the period after the clock's source has changed."""
        now = self.clock.now()
        if now:
            self.next_call = now + credit
            self._last_call = self.next_call - self._period

    def follow_jump(self) -> None:
        """Restart the period after the clock has jumped back behind the last call."""
        now = self.clock.now()
        if now < self._last_call:
            self._last_call, self.next_call = now, now + self._period


RosClock.__name__ = "Clock"
for _kind in (RosClock, ClockEvent, Timer):
    _kind.__module__ = MODULE
