"""Checks every command in hardware mode, in the test processes.

Each command asks the controller: it goes out once the controller has written it to the log and says so. So
nothing goes out after a stop, nor when the controller is gone, hangs or answers late.
"""

from __future__ import annotations

import json
import os
import socket
import struct
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

from mutabot.api.processes import CallGuard
from mutabot.api.values import Call

#: environment variable with the name of the socket at which the controller answers; it lies in no folder, so
#: that processes whose files are their own find it
SOCKET_VARIABLE = "MUTABOT_HARDWARE_SOCKET"
#: the answer that lets a command pass; any other one says why it must not
PASS = b"pass"
#: characters of an argument that a message shows
_SHOWN = 60
#: seconds that an answer may take
_PATIENCE = 10
_MOST = 1 << 16


class HardwareGuard(CallGuard):
    """Lets a command pass only if it can be read and the controller allows it."""

    def __init__(self, table: Mapping[str, Any]) -> None:
        super().__init__(table)
        self._is_on = bool(table["enabled"])
        self._connection: _PermissionConnection | None = None
        self._owner = 0
        self._turn = threading.Lock()

    def why_not(self, call: Call, unread: Mapping[str, str]) -> str | None:
        """Return why a command must not go out, or None; see ``CallGuard``."""
        if not self._is_on:
            return None
        is_unknown = call.pattern is None and bool(call.operation.patterns)
        if not (call.is_command or is_unknown):
            return None
        if SOCKET_VARIABLE not in os.environ:
            return "in hardware mode commands go out from campaigns with --hardware only"
        if why := unreadable(call, unread):
            return why
        return self._ask_controller(
            {"sent": call.operation.target, "values": dict(call.values), "process": os.getpid()}
        )

    def _ask_controller(self, command: Mapping[str, Any]) -> str | None:
        """Ask the controller; return why the command must not go out, None if it may."""
        if self._owner != os.getpid():  # of a copy of a process, the connection and the turn are the other's
            self._connection, self._turn, self._owner = None, threading.Lock(), os.getpid()
        with self._turn:
            try:
                if self._connection is None or not self._connection.is_there:
                    self._connection = _PermissionConnection.open(os.environ[SOCKET_VARIABLE])
                answer = self._connection.ask(json.dumps(command, default=repr).encode()[:_MOST])
            except OSError as error:
                self._connection = None
                return f"the controller does not answer: {error}"
        if answer == PASS:
            return None
        return answer.decode(errors="replace") or "the controller is gone"


def unreadable(call: Call, unread: Mapping[str, str]) -> str | None:
    """Return why no guard can read a command, as ``CallGuard.why_not`` defines it; None if guards can.

    Of a command of which the vocabulary describes no argument, guards know nothing but its name. Flags such
    as ``wait=True`` say how a command is made, and not what it does.
    """
    if call.pattern is None and call.operation.patterns:
        return "it is none of the commands that the vocabulary describes, so that no guard can read it"
    if unread:
        return f"it cannot be read: {'; '.join(unread.values())}"
    if call.pattern is not None or call.operation.arguments or call.payload is None:
        return None
    given = (*call.payload.args, *call.payload.kwargs.values())
    texts = [_short(value) for value in given if value is not None and not isinstance(value, bool)]
    if not texts:
        return None
    return (
        f"it cannot be read: the vocabulary describes none of its arguments, and it gets {', '.join(texts)}"
    )


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…"


@dataclass(frozen=True, slots=True)
class _PermissionConnection:
    """A connection to the controller, kept as a descriptor: Python warns of sockets that are not closed.

    Attributes:
        descriptor: its number, which a test may close and use for something else.
        node: by which the socket itself is known.
    """

    descriptor: int
    node: int

    @classmethod
    def open(cls, name: str) -> Self:
        """Open a new connection. Raises OSError."""
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as made:
            made.setblocking(True)  # libraries of robots set a default timeout for all sockets
            for option in (socket.SO_RCVTIMEO, socket.SO_SNDTIMEO):
                made.setsockopt(socket.SOL_SOCKET, option, struct.pack("@ll", _PATIENCE, 0))
            made.connect(b"\0" + name.encode())
            node = os.fstat(made.fileno()).st_ino
            return cls(made.detach(), node)

    @property
    def is_there(self) -> bool:
        """Whether the descriptor still refers to this connection."""
        try:
            return os.fstat(self.descriptor).st_ino == self.node
        except OSError:
            return False

    def ask(self, question: bytes) -> bytes:
        """Return the answer; empty if the controller is gone. Raises OSError."""
        os.write(self.descriptor, question)
        return os.read(self.descriptor, _MOST)
