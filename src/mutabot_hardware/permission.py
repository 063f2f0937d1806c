"""Gives test processes permission to send commands: the controller's side."""

from __future__ import annotations

import json
import os
import secrets
import socket
import struct
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Self

from .command_guard import PASS, SOCKET_VARIABLE
from .log import HardwareLog

_CREDENTIALS = struct.Struct("3i")
_MOST = 1 << 16


class Permissions:
    """Gives test processes permission to send commands, each after it has been logged.

    Use as a context manager: inside, new processes know where to ask.

    Args:
        log: where each command is written before it goes out.
    """

    def __init__(self, log: HardwareLog) -> None:
        self._log = log
        self._stopped = ""
        self._is_given = False
        self._turn = threading.Lock()
        self._name = f"mutabot-hardware-{secrets.token_hex(16)}"
        self._listening = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._listening.bind(b"\0" + self._name.encode())
        self._listening.listen()

    def __enter__(self) -> Self:
        os.environ[SOCKET_VARIABLE] = self._name
        threading.Thread(target=self._listen, daemon=True).start()
        return self

    def __exit__(self, *error: object) -> None:
        self.stop("the campaign is over")
        os.environ.pop(SOCKET_VARIABLE, None)
        with suppress(OSError):
            self._listening.shutdown(socket.SHUT_RDWR)
        self._listening.close()

    @contextmanager
    def given(self) -> Iterator[None]:
        """Allow commands in this context, unless there has been a stop."""
        with self._turn:
            self._is_given = True
        try:
            yield
        finally:
            with self._turn:
                self._is_given = False

    def stop(self, why: str) -> None:
        """Block all commands once this returns. Only the first reason is kept."""
        with self._turn:
            self._stopped = self._stopped or why

    def _listen(self) -> None:
        while True:
            try:
                connection, _ = self._listening.accept()
            except OSError:
                return
            threading.Thread(target=self._answer, args=(connection,), daemon=True).start()

    def _answer(self, connection: socket.socket) -> None:
        with connection, suppress(OSError):
            if not _is_ours(connection):
                return
            while asked := connection.recv(_MOST):
                connection.send(self._answer_to(asked))

    def _answer_to(self, asked: bytes) -> bytes:
        with self._turn:
            why = self._stopped or ("" if self._is_given else "no run has begun")
            if why:
                return why.encode()
            try:
                command = json.loads(asked)
                sent = {"sent": str(command["sent"]), "values": command["values"]}
                self._log.write(to_disk=False, **sent, process=command["process"])
            except (ValueError, KeyError, TypeError, OSError) as error:
                return f"the log does not have it: {error!r}".encode()
            return PASS


def _is_ours(connection: socket.socket) -> bool:
    """Return whether the other end belongs to the same user."""
    found = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    return bool(_CREDENTIALS.unpack(found)[1] == os.getuid())
