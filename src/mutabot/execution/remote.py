"""Executors that run tasks on other machines, and the tasks that stay on this one.

On this machine stay runs of the original: limits, which files were opened, and how equal runs differ are
measured on one machine. So do films, tasks that nothing may run beside, and the second run of a control.
A task that a limit of wall clock ended elsewhere runs again here, where it may be quicker: a time-out is a
verdict.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from itertools import chain
from typing import TYPE_CHECKING

from mutabot.execution.task import Executor, Result, Task

if TYPE_CHECKING:
    from mutabot.execution.answer import Answer
    from mutabot.model.events import Event


class RemoteExecutor(ABC):
    """The base class of executors that run tasks on other machines.

    Args:
        here: runs what stays on this machine.
    """

    def __init__(self, here: Executor) -> None:
        self._here = here

    @property
    @abstractmethod
    def spread(self) -> int:
        """The number of machines or workers that share nothing; at least 1."""

    @property
    @abstractmethod
    def remarks(self) -> Sequence[str]:
        """Remarks for the journal's readers on where tasks ran."""

    @abstractmethod
    def answers(self, tasks: Iterator[Task]) -> Iterator[Answer | Task]:
        """Run tasks, taken when a place is free; yield their answers in the order in which they end.

        Each task that is taken is answered, or yielded itself to be run on this machine. Those that are not
        taken are run here, too.
        """

    def run(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """See ``Executor``."""
        return (event for event in self.events(tasks) if isinstance(event, Result))

    def events(self, tasks: Iterable[Task]) -> Iterator[Result | tuple[Task, Event]]:
        """Yield results and events; those of a task come when it has ended, and local tasks run last."""
        waiting = iter(tasks)
        first = next(waiting, None)
        if first is None:
            return
        waiting = chain([first], waiting)
        staying: list[Task] = []
        for found in () if _stays(first) else self.answers(_leaving(waiting, staying)):
            if isinstance(found, Task):
                staying.append(found)
                continue
            decided, rest = found.undecided()
            yield from ((decided.result.task, event) for event in decided.events)
            if rest is None:
                yield decided.result
            else:
                staying.append(rest)
        yield from self._here.events(chain(staying, waiting))

    def rest(self, is_awaited: Callable[[], bool], seconds: float) -> Iterator[Result | tuple[Task, Event]]:
        """Yield nothing, since tasks on other machines report only when they have ended."""
        return self._here.rest(is_awaited, seconds)

    def apart(self) -> AbstractContextManager[Executor]:
        """Return an executor on this machine for one task at a time."""
        return self._here.apart()


def _leaving(tasks: Iterable[Task], staying: list[Task]) -> Iterator[Task]:
    """Yield the tasks that may run on other machines; put the others aside."""
    for task in tasks:
        if _stays(task):
            staying.append(task)
        else:
            yield task


def _stays(task: Task) -> bool:
    """Return whether a task must run on this machine: the original, and tasks that use its own files."""
    job = task.job
    return (job.mutant is None and job.forking is None) or job.pictures is not None or task.alone
