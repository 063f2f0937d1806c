"""Write the events of this process into its own file."""

from __future__ import annotations

import os
import threading
from array import array
from collections.abc import Callable
from typing import Any, Protocol

from mutabot.model.data import UNKNOWN, data_of, is_of_numpy, items_of
from mutabot.model.event_file import FOLDER, SESSION, SUFFIX, UNWRITTEN, sealed
from mutabot.model.events import Event, ForkEnded, Serving, TestEnd, TestStart
from mutabot.model.files import open_file
from mutabot.model.path import class_name

#: bound before a test can replace them, as tests of programs do that write to a device
_write, _fstat = os.write, os.fstat
#: what the controller is to hear of at once; it finds all else when it looks
_PROMPT = (TestStart, TestEnd, ForkEnded, Serving)


class EventWriter(Protocol):
    """The interface of a receiver of the events of a process."""

    def send(self, event: Event) -> None:
        """Send one event."""


def _die() -> None:
    os._exit(UNWRITTEN)


class EventFile:
    """The event file of this process.

    Every event is written whole and at once, so that a process that dies loses only what it had not reported
    yet.

    Args:
        folder: where the file is.
        name: its name, without its ending; it is made if it is not there.
        key: of the seals.
        fail: called if something could not be written; by default it ends the process, of which nothing could
            know anything any more.
        bell: descriptor of the pipe by which the controller learns that there is something to read. It is
            replaced by the lowest one that is free: tests may expect theirs to follow one upon another.
    """

    def __init__(
        self, folder: str, name: str, key: str, fail: Callable[[], None] = _die, bell: int | None = None
    ) -> None:
        self._folder, self.name, self._key, self._fail = folder, name, key, fail
        self._bell = None if bell is None else _lowest(bell)
        self._lock = threading.RLock()
        self._last = self.forks = 0
        self._file = -1
        self._status: os.stat_result
        self._open()
        if self._bell is not None:
            os.set_blocking(self._bell, False)

    @classmethod
    def of_session(cls, home: str, key: str, bell: int) -> EventFile:
        """Return the event file of the test process with this home."""
        return cls(os.path.join(home, FOLDER), SESSION, key, bell=bell)

    def send(self, event: Event) -> None:
        """Write one event."""
        with self._lock:
            if not self._is_open():  # daemons close all that they find open
                self._open()
            number = 0
            while number != self._last + 1:  # handlers of signals may write, too
                number = self._last + 1
                line = sealed(event, number, self.name, self._key, json_stand_in)
            self._last = number
            try:
                is_written = _write(self._file, line) == len(line)
            except OSError:
                is_written = False
        if not is_written:
            self._fail()
        elif self._bell is not None and isinstance(event, _PROMPT):
            self._ring(self._bell)

    def continue_separately(self) -> None:
        """Write into a separate file from now on, in a process that was just forked.

        Its name is the ``ForkEnded.fork`` of its parent, which has counted it in ``forks``.
        """
        nowhere = os.open(os.devnull, os.O_WRONLY | os.O_CLOEXEC)
        os.dup2(nowhere, self._file, inheritable=False)
        os.close(nowhere)
        self._bell = None  # what a fork reports is read once its parent reports its end
        self.name = f"{self.name}.{self.forks}"
        self._last = self.forks = 0

    def keep_number(self) -> None:
        """Open the file at the parent's path, which is in a private folder, after ``continue_separately``."""
        number = self._file
        self._open()
        os.dup2(self._file, number, inheritable=False)
        os.close(self._file)
        self._file = number

    def close(self) -> None:
        """Close the file and the pipe."""
        os.close(self._file)
        if self._bell is not None:
            os.close(self._bell)

    @staticmethod
    def _ring(bell: int) -> None:
        """Signal that there are new events; the bytes in the pipe carry no meaning."""
        try:
            _write(bell, b"\n")
        except BlockingIOError:
            pass  # it will be heard
        except BrokenPipeError:
            os._exit(70)  # there is no reader left

    def _open(self) -> None:
        path = os.path.join(self._folder, self.name + SUFFIX)
        try:
            self._file = open_file(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
            self._status = _fstat(self._file)
        except OSError:
            self._fail()

    def _is_open(self) -> bool:
        """Return whether the descriptor still belongs to the file, and not to one opened later."""
        try:
            return os.path.samestat(_fstat(self._file), self._status)
        except OSError:
            return False


def _lowest(descriptor: int) -> int:
    """Return the descriptor under the lowest number that is free; no program that is started inherits it."""
    os.set_inheritable(descriptor, False)
    copy = os.dup(descriptor)
    os.close(max(copy, descriptor))
    return min(copy, descriptor)


class Held:
    """Stores events in the place of the file, for a process that does not know its job yet."""

    def __init__(self) -> None:
        self.events: list[Event] = []

    def send(self, event: Event) -> None:
        """Store one event."""
        self.events.append(event)


def json_stand_in(value: Any) -> Any:
    """Return JSON-like stand-in for a value that JSON cannot represent."""
    data = data_of(value)
    if type(data) is array or is_of_numpy(data):
        return data.tolist()
    if type(data) is bytes:
        return data.decode("utf-8", "backslashreplace")
    items = items_of(data)
    if items is not None:
        return items
    return f"<{class_name(type(value))}>" if data is UNKNOWN else repr(data)
