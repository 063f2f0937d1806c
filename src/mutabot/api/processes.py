"""The interface for packages about processes: executors, guards, simulations, observed runs of a suite."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.campaign.request import ExecutorChoice as ExecutorChoice
    from mutabot.campaign.request import Request as Request
    from mutabot.campaign.simulation import SimulatedMiddleware as SimulatedMiddleware
    from mutabot.config.table import ProjectFiles as ProjectFiles
    from mutabot.config.table import Table as Table
    from mutabot.evidence import Feed as Feed
    from mutabot.execution.answer import Answer as Answer
    from mutabot.execution.interruption import interruptible as interruptible
    from mutabot.execution.observation import Observed as Observed
    from mutabot.execution.observation import observe as observe
    from mutabot.execution.remote import RemoteExecutor as RemoteExecutor
    from mutabot.execution.task import Result as Result
    from mutabot.execution.task import Task as Task
    from mutabot.execution.workers import Workers as Workers
    from mutabot.runtime.interception.guarding import CallGuard as CallGuard
    from mutabot.runtime.observer import CallOrigin as CallOrigin
    from mutabot.runtime.observer import Observer as Observer
    from mutabot.runtime.pytest_plugin import seed_of as seed_of
    from mutabot.shared_memory import SharedMemory as SharedMemory

_HOMES = {
    "mutabot.campaign.request": ("ExecutorChoice", "Request"),
    "mutabot.campaign.simulation": ("SimulatedMiddleware",),
    "mutabot.config.table": ("ProjectFiles", "Table"),
    "mutabot.evidence": ("Feed",),
    "mutabot.execution.answer": ("Answer",),
    "mutabot.execution.interruption": ("interruptible",),
    "mutabot.execution.observation": ("Observed", "observe"),
    "mutabot.execution.remote": ("RemoteExecutor",),
    "mutabot.execution.task": ("Result", "Task"),
    "mutabot.execution.workers": ("Workers",),
    "mutabot.runtime.interception.guarding": ("CallGuard",),
    "mutabot.runtime.observer": ("CallOrigin", "Observer"),
    "mutabot.runtime.pytest_plugin": ("seed_of",),
    "mutabot.shared_memory": ("SharedMemory",),
}
__getattr__ = lazily(__name__, _HOMES)
