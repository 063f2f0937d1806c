"""Workers of a Dask cluster, and worker processes on this machine for what stays here."""

from __future__ import annotations

from collections.abc import Callable

from mutabot.campaign.executors import local
from mutabot.campaign.request import Request


def executor(request: Request, tell: Callable[[str], None]) -> object:
    """Connects to the request's cluster. Raises ClusterError where that fails."""
    from mutabot_dask.cluster import Cluster  # noqa: PLC0415  # it needs Dask

    assert request.cluster is not None
    home = local.executor(request, tell)
    try:
        return Cluster(request, request.cluster, home, tell)
    except BaseException:
        home.__exit__(None, None, None)
        raise
