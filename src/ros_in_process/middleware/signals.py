"""Handles signals for a process's contexts and executors, as rclpy's own handlers do."""

from __future__ import annotations

import signal
from typing import Any

from ros_in_process.machine.scheduler import SCHEDULER
from ros_in_process.middleware.records import SignalHandlerOptions
from ros_in_process.middleware.waiting import GuardCondition

_conditions: list[tuple[Any, GuardCondition]] = []
_options: dict[Any, Any] = {}
_replaced: set[tuple[Any, int]] = set()


def _process() -> Any:
    return SCHEDULER.current.process


def install_signal_handlers(options: Any) -> None:
    """Let signals shut the contexts of this process down."""
    _options[_process()] = options
    _replaced.difference_update([entry for entry in _replaced if entry[0] is _process()])


def get_current_signal_handlers_options() -> Any:
    """Return which signals shut contexts down."""
    return _options.get(_process(), SignalHandlerOptions.NO)


def uninstall_signal_handlers() -> None:
    """Restore what signals do without ROS."""
    _options.pop(_process(), None)


def register_sigint_guard_condition(condition: GuardCondition) -> None:
    """Trigger a guard condition when SIGINT arrives."""
    _conditions.append((_process(), condition))


def unregister_sigint_guard_condition(condition: GuardCondition) -> None:
    """Stop triggering a guard condition."""
    _conditions[:] = [entry for entry in _conditions if entry[1] is not condition]


def handles(process: Any, signum: int) -> bool:
    """Return whether a process has a ROS handler for a signal."""
    bit = {signal.SIGINT: 1, signal.SIGTERM: 2}.get(signal.Signals(signum), 0)
    return (
        bool(_options.get(process, SignalHandlerOptions.NO).value & bit)
        and (process, signum) not in _replaced
    )


def replaced(process: Any, signum: int) -> None:
    """Note that a program has replaced ROS's signal handler by its own."""
    _replaced.add((process, int(signum)))


def shut_down(process: Any) -> None:
    """Do what ROS's handlers do: shut the contexts down and wake the executors."""
    for context in process.contexts:
        context.close()
    for owner, condition in tuple(_conditions):
        if owner is process and not condition.is_destroyed:
            condition.trigger_guard_condition()


def forget(process: Any) -> None:
    """Remove what a process that has ended had registered."""
    _options.pop(process, None)
    _conditions[:] = [entry for entry in _conditions if entry[0] is not process]
