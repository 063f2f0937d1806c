"""The executor that runs tasks on a cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager

from mutabot.api.processes import Answer, RemoteExecutor, Request, Task, Workers

from .connection import ClusterConnection
from .dispatch import Dispatch
from .settings import ClusterSettings


class Cluster(RemoteExecutor):
    """The executor on a cluster; see ``RemoteExecutor``.

    Args:
        connection: the cluster.
        here: runs what stays here.
    """

    def __init__(self, connection: ClusterConnection, here: Workers) -> None:
        super().__init__(here)
        self._connection = connection

    @classmethod
    @contextmanager
    def opened(
        cls, request: Request, settings: ClusterSettings, notify: Callable[[str], None]
    ) -> Iterator[Cluster]:
        """Open a cluster for a campaign, with worker processes on this machine as well. Raises UsageError."""
        with (
            request.on_this_machine(notify) as here,
            closing(ClusterConnection(request, settings, notify)) as connection,
        ):
            yield cls(connection, here)

    @property
    def spread(self) -> int:
        """The number of workers; see ``Executor``."""
        return max(1, self._connection.size)

    @property
    def remarks(self) -> list[str]:
        """Messages about workers that differ or cannot be used; see ``Executor``."""
        return list(self._connection.roster.reported)

    def answers(self, tasks: Iterator[Task]) -> Iterator[Answer | Task]:
        """Yield the answers to tasks; see ``RemoteExecutor``."""
        if not self._connection.is_given_up:
            yield from Dispatch(self._connection, tasks).answers()
