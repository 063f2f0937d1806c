"""Where tasks of a campaign run, and what lives beside a program in its processes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.execution.task import Executor, Result, Task
    from mutabot.model.job import Job

__all__ = [
    "Executor",
    "Job",
    "Result",
    "Task",
]
_HOMES = {
    "mutabot.execution.task": (
        "Executor",
        "Result",
        "Task",
    ),
    "mutabot.model.job": ("Job",),
}
__getattr__, __dir__ = lazily(__name__, _HOMES)
