"""Where tasks of a campaign run, and what lives beside a program in its processes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.campaign.request import ExecutorChoice, Request
    from mutabot.campaign.simulation import SimulatedMiddleware
    from mutabot.config.table import ProjectFiles, Table
    from mutabot.evidence import Feed
    from mutabot.execution.answer import Answer
    from mutabot.execution.interruption import interruptible
    from mutabot.execution.observation import Observed, observe
    from mutabot.execution.remote import RemoteExecutor
    from mutabot.execution.task import Result, Task
    from mutabot.execution.workers import Workers
    from mutabot.runtime.observer import CallOrigin, Observer
    from mutabot.runtime.pytest_plugin import seed_of
    from mutabot.shared_memory import SharedMemory

__all__ = [
    "Answer",
    "CallOrigin",
    "ExecutorChoice",
    "Feed",
    "Observed",
    "Observer",
    "ProjectFiles",
    "RemoteExecutor",
    "Request",
    "Result",
    "SharedMemory",
    "SimulatedMiddleware",
    "Table",
    "Task",
    "Workers",
    "interruptible",
    "observe",
    "seed_of",
]
_HOMES = {
    "mutabot.campaign.request": (
        "ExecutorChoice",
        "Request",
    ),
    "mutabot.campaign.simulation": ("SimulatedMiddleware",),
    "mutabot.config.table": (
        "ProjectFiles",
        "Table",
    ),
    "mutabot.evidence": ("Feed",),
    "mutabot.execution.answer": ("Answer",),
    "mutabot.execution.interruption": ("interruptible",),
    "mutabot.execution.observation": (
        "Observed",
        "observe",
    ),
    "mutabot.execution.remote": ("RemoteExecutor",),
    "mutabot.execution.task": (
        "Result",
        "Task",
    ),
    "mutabot.execution.workers": ("Workers",),
    "mutabot.runtime.observer": (
        "CallOrigin",
        "Observer",
    ),
    "mutabot.runtime.pytest_plugin": ("seed_of",),
    "mutabot.shared_memory": ("SharedMemory",),
}
__getattr__, __dir__ = lazily(__name__, _HOMES)
