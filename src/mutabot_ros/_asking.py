"""Asking whether a master of ROS 1 is there; apart, since its imports take time that only ROS 1 is worth."""

from __future__ import annotations

from http.client import HTTPConnection, HTTPException
from typing import Any, cast
from xmlrpc.client import Error, ServerProxy, Transport

#: how long an answer may take, s
_PATIENCE = 2.0


def pid_of_master(uri: str) -> int | None:
    """The process of the master there; None if none answers."""
    try:
        with ServerProxy(uri, _Hasty()) as master:
            _, _, pid = cast(tuple[int, str, int], master.getPid("/mutabot"))
            return pid
    except (OSError, Error, HTTPException, ValueError):
        return None


class _Hasty(Transport):
    """A connection to who may not answer."""

    def make_connection(self, host: Any) -> HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = _PATIENCE
        return connection
