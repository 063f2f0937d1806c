"""ROS 2 in one process: simulated time, deterministic, forkable.

`start` puts a middleware in Python in the place of rclpy's C extension. For modules of the project and of
rclpy, it puts simulated time in the place of `time`, `threading` and so on. rclpy's own Python, the project
and its tests stay as they are, but for what executors do around each wait (`middleware/executors.py`).
What cannot be simulated raises `NeedsRealRos`; `reasons()` gives all that was found.
"""

from __future__ import annotations

from collections.abc import Callable

from ros_in_process.errors import REASONS, Deadlock, NeedsRealRos

__all__ = ["Deadlock", "NeedsRealRos", "end_of_process", "is_running", "reasons", "start"]

_is_running = False


def start(roots: list[str], schedule: str = "first-in", seed: int = 0) -> None:
    """Simulate ROS 2 in this process from now on.

    Args:
        roots: folders of the project: its modules below them see simulated time. Later calls add to them.
        schedule: the order in which callbacks and threads that are ready run: ``first-in`` or ``random``.
        seed: what a random order is drawn from.

    Raises NeedsRealRos if this process cannot be simulated, for instance if rclpy is imported already.
    """
    global _is_running  # noqa: PLW0603  (there is one simulation in a process)
    # greenlet and rclpy are needed only where the simulation runs
    from ros_in_process.machine import event_loops, imports, standard_library  # noqa: PLC0415
    from ros_in_process.machine.scheduler import SCHEDULER  # noqa: PLC0415
    from ros_in_process.machine.schedules import schedule_named  # noqa: PLC0415
    from ros_in_process.middleware import extension  # noqa: PLC0415
    from ros_in_process.processes import multiprocess, process, programs, system  # noqa: PLC0415

    SCHEDULER.follow(schedule_named(schedule, seed))
    for root in roots:
        imports.add_root(root)
    if not _is_running:
        programs.install()
        system.install()
        event_loops.install()
        multiprocess.install()
        standard_library.install()
        process.install()
        extension.install()
        imports.catch_up()
        _is_running = True


def is_running() -> bool:
    """Return whether ROS is simulated in this process."""
    return _is_running


def reasons() -> list[str]:
    """Return why what has run so far cannot be trusted without real ROS; empty if it can."""
    return list(REASONS)


def end_of_process() -> Callable[[bool], object] | None:
    """Return a function that ends or restarts the current simulated process; None outside of one."""
    if not _is_running:
        return None
    from ros_in_process.processes import process  # noqa: PLC0415

    return process.end_of_current()
