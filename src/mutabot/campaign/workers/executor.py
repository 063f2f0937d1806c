"""The contract of whatever runs tasks: worker processes on this machine, or on others.

It only runs what it is given: which tasks there are, and what their results mean, is the engines' business.
A package brings another executor by a ``campaign.request.ExecutorChoice``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from typing import Protocol

from mutabot.border.events import Event

from .task import Result, Task


class Executor(Protocol):
    """Runs tasks, as many at a time as it may. Leaving its context ends whatever still runs.

    Attributes:
        spread: how many places share nothing, neither trunks nor fork servers: work is worth cutting into
            parts for them, and to begin with its longest. 1 on one machine.
        remarks: what is to be known of where tasks ran, for whoever reads the journal.
    """

    @property
    def spread(self) -> int: ...

    @property
    def remarks(self) -> Sequence[str]: ...

    def run(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Results in the order in which tasks end. Tasks are taken from the iterable as places free up."""

    def events(self, tasks: Iterable[Task]) -> Iterator[Result | tuple[Task, Event]]:
        """The same, with each event as it comes.

        A task whose job branches is a trunk: the executor gives it and its branches the tokens by which they
        share its places with the other tasks. A task that is ``alone`` has nothing beside it.
        """

    def apart(self) -> AbstractContextManager[Executor]:
        """An executor for one task at a time, which shares nothing with what runs here meanwhile."""
