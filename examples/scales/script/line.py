"""The line to the robot: a socket, over which commands go out as text and readings come back as text."""

from __future__ import annotations

import socket


class Refused(Exception):  # noqa: N818  # the word the robot itself uses
    """The robot does not take the command; nothing has moved."""


class Stopped(Exception):  # noqa: N818  # likewise
    """The arm hit something and stopped."""


class Line:
    """A line to the robot that listens at a port of this machine."""

    def __init__(self, port: int) -> None:
        self._socket = socket.create_connection(("127.0.0.1", port))
        self._file = self._socket.makefile("rw", encoding="ascii", newline="\n")

    def send(self, text: str) -> None:
        """Send a command, such as ``lift/5``, and wait until the robot has done it.

        Raises Refused if the robot does not take the command, Stopped if it hits something.
        """
        self._ask(f"do {text}")

    def read(self, name: str) -> str:
        """A reading as text: ``color``, ``height`` in cm, ``heading`` in deg, ``weight/left`` in g …"""
        return self._ask(f"tell {name}")

    def close(self) -> None:
        """Hang up."""
        self._file.close()
        self._socket.close()

    def _ask(self, text: str) -> str:
        self._file.write(f"{text}\n")
        self._file.flush()
        word, _, rest = self._file.readline().rstrip("\n").partition(" ")
        if word == "refused":
            raise Refused(rest)
        if word == "stopped":
            raise Stopped(rest)
        return rest
