"""Addresses at which the tests wait: two processes cannot have the same one at the same time."""

from __future__ import annotations

import sys
from typing import Any


class FixedAddresses:
    """Those of one process, seen by an audit event before the system is asked for an address.

    Attributes:
        taken: what the running test waits at, in words; None if the system chooses what nobody else has.
    """

    def __init__(self) -> None:
        self.taken: str | None = None
        self._is_on = False

    def start_test(self) -> None:
        """A test begins."""
        self.taken = None
        if not self._is_on:
            self._is_on = True
            sys.addaudithook(self._hear)

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event != "socket.bind":
            return
        address = arguments[1]
        if not (isinstance(address, tuple) and len(address) > 1 and address[1] == 0):
            self.taken = self.taken or f"waits at the address {address!r}"
