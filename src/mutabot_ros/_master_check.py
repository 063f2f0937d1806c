"""Checks whether a ROS 1 master answers; separate, since only ROS 1 is worth the time of its imports."""

from __future__ import annotations

from http.client import HTTPConnection, HTTPException
from typing import Any, cast
from xmlrpc.client import Error, ServerProxy, Transport

#: how long an answer may take, s
_PATIENCE = 2.0


def pid_of_master(uri: str) -> int | None:
    """Return the process id of the master at a URI; None if none answers."""
    try:
        with ServerProxy(uri, _ImpatientTransport()) as master:
            _, _, pid = cast(tuple[int, str, int], master.getPid("/mutabot"))
            return pid
    except (OSError, Error, HTTPException, ValueError):
        return None


class _ImpatientTransport(Transport):
    """A transport with a short timeout, for a master that may not answer."""

    def make_connection(self, host: Any) -> HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = _PATIENCE
        return connection
