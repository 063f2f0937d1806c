"""Files of events: one for each process, one numbered and sealed event a line.

A file needs no listener, and its content stays when its process dies. The seal shows a reader that a
line is whole, ours, and of this process; the number shows that none is missing and none comes twice. The
tests' code can write into any file, by mistake or because of a mutant. Processes know the key of the seals,
so this guards against accidents and not against code that wants to deceive.
"""

from __future__ import annotations

import os
import signal
from _blake2 import blake2b  # as in source_units
from collections.abc import Callable
from json import loads
from typing import Any

from mutabot.model.codec import is_too_deep, sparse, to_json
from mutabot.model.events import Event, Untrusted, event_from_data
from mutabot.model.files import open_file

#: bytes of a line; the longest are recordings
MOST_BYTES = 1 << 27
_DIGITS = 16
#: bytes of what cannot be read that are shown
_SHOWN = 60


def sealed(event: Event, number: int, name: str, key: str, default: Callable[[Any], Any] = repr) -> bytes:
    """Return the sealed line of an event, given its number in the file of this name.

    ``default`` gives data for what JSON does not know.
    """
    text = to_json({"type": type(event).__name__, **sparse(event)}, default)
    return b"%s %d %s\n" % (seal(text, number, name, key), number, text)


def unsealed(line: bytes, name: str, key: str) -> tuple[int, Event]:
    """Return the number of an event and the event. Raises ValueError if it is no valid line of this file."""
    mark, _, rest = line.partition(b" ")
    digits, _, text = rest.partition(b" ")
    try:
        number = int(digits[:_DIGITS])
        if mark == seal(text, number, name, key) and not is_too_deep(text):
            return number, event_from_data(loads(text.decode()))
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError):
        pass
    more = len(line) - _SHOWN
    shown = f"{line[:_SHOWN]!r}{f' and {more} more bytes' if more > 0 else ''}"
    raise ValueError(f"the tests' process reported something unreadable: {shown}")


def seal(text: bytes, number: int, name: str, key: str) -> bytes:
    """Return the digest that is written before an event given as JSON."""
    sealing = blake2b(f"{name} {number} ".encode(), key=key.encode(), digest_size=_DIGITS // 2)
    sealing.update(text)
    return sealing.hexdigest().encode()


class EventReader:
    """A reader of the events that one process has written so far.

    Args:
        path: the file.
        key: of the seals.

    Attributes:
        damage: why these events cannot be relied on, reported once as ``Untrusted``; None as
            far as they can.
        is_torn: whether the last line has no end: it is being written, or its writer was killed meanwhile.
    """

    def __init__(self, path: str, key: str) -> None:
        self.damage: str | None = None
        self.is_torn = False
        self._path, self._key = path, key
        self._name = os.path.basename(path).rpartition(".")[0]
        self._offset = 0
        self._next = 1

    def read(self, *, is_last: bool = False) -> list[Event]:
        """Return the new events; ``is_last`` means that the process is gone, so incomplete lines are lost."""
        found: list[Event] = []
        try:
            file = open_file(self._path, os.O_RDONLY)
            try:
                self._read(file, found)
            finally:
                os.close(file)
        except OSError as error:
            self._doubt(f"{self._name} was deleted or closed while it ran ({error.strerror})", found)
        if is_last and self.is_torn:
            self._doubt(f"{self._name} ends in the midst of event {self._next}", found)
        return found

    def _read(self, file: int, found: list[Event]) -> None:
        while (left := os.fstat(file).st_size - self._offset) > 0:
            data = os.pread(file, min(left, MOST_BYTES), self._offset)
            size = data.rfind(b"\n") + 1
            self.is_torn = size < len(data) < MOST_BYTES
            if not size and not self.is_torn:
                self._take(data, found)  # no process writes such a line, nor whatever follows
                self._offset += left
                return
            if self.is_torn and not size:
                return
            self._offset += size
            for line in data[:size].split(b"\n")[:-1]:
                self._take(line, found)
        if left < 0:
            self._doubt(f"{self._name} is shorter than it was", found)

    def _take(self, line: bytes, found: list[Event]) -> None:
        try:
            number, event = unsealed(line, self._name, self._key)
        except ValueError as error:
            self._doubt(str(error), found)
            return
        if number < self._next:
            self._doubt(f"event {number} comes twice in {self._name}", found)
            return
        if number > self._next:
            last = f" to {number - 1}" if number - 1 > self._next else ""
            self._doubt(f"what is missing in {self._name}: event {self._next}{last}", found)
        self._next = number + 1
        found.append(event)

    def _doubt(self, damage: str, found: list[Event]) -> None:
        if self.damage is None:
            self.damage = damage
            found.append(Untrusted(damage))


#: this folder, in the home of the test process
FOLDER = "processes"
#: where forks of it have their homes, by their names: what is in ``FOLDER`` there, a fork finds in the home
FORKS = "forks"
#: environment variable that names this folder; Python processes that find it look for what they are to do
VARIABLE = "MUTABOT_PROCESSES"
#: file in it with what wakes a process: see ``runtime.processes.startup.sitecustomize``
WAKE = "wake"
#: file in it with the number of the running test in eight bytes, 0 before any; the next eight are not 0
#: once a process below the tests could not write its events
NOW = "now"
#: file in it with the tests' node ids, one a line as JSON, in the order of their numbers from 1
TESTS = "tests"
#: how the files of events end, one for each process, and the name of the test process's
SUFFIX, SESSION = ".jsonl", "session"
#: exit code of a test process, or of a fork of it, that could not write its events
UNWRITTEN = 117


#: a program dies of these by its own fault; others come from outside
OWN_FAULT = {signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL}
#: stands for any process, as in kill(2)
ANY_PROCESS = -1
