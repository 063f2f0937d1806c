"""What all controllers of these tests have: what reached them, and a program that drives them."""

from __future__ import annotations

import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from textwrap import dedent


@dataclass(frozen=True)
class Received:
    """A command that has reached a controller.

    Attributes:
        moment: when, ``time.monotonic``.
        name: which command it is, in the protocol's own terms.
        values: its numbers, as they were on the wire.
    """

    moment: float
    name: str
    values: tuple[float, ...]


@dataclass
class Controller:
    """A controller: where it listens, and what has reached it."""

    address: str = ""
    received: list[Received] = field(default_factory=list)

    def note(self, name: str, *values: float) -> None:
        self.received.append(Received(time.monotonic(), name, values))

    def of(self, name: str) -> list[tuple[float, ...]]:
        """The numbers of all commands of this name."""
        return [message.values for message in self.received if message.name == name]


@dataclass(frozen=True)
class Vendor:
    """A client library, a controller for it, and a project whose program uses it.

    Attributes:
        packages: the modules that have to be installed.
        serve: makes the controller.
        program, tests, vocabulary, guard: the project; the tests find the controller by CONTROLLER.
        moving: name of the command that the guard limits.
        least, greatest: the limits of each of its numbers, as they are on the wire.
        operation: the operation of the program that sends it.
        unreadable: a statement of the program that the guard cannot read.
        said: what hardware mode says of it.
        shipped: the vocabularies that come with mutabot and are used beside its own.
        prepare: text of the project's conftest.py.
    """

    packages: tuple[str, ...]
    serve: Callable[[], AbstractContextManager[Controller]]
    program: str
    tests: str
    vocabulary: str
    guard: str
    moving: str
    least: tuple[float, ...]
    greatest: tuple[float, ...]
    operation: str
    unreadable: str
    said: str
    shipped: tuple[str, ...] = ()
    prepare: str = ""

    @property
    def counted(self) -> str:
        """How the names of what its operation sends begin."""
        return self.moving.split()[0]

    def outside(self, controller: Controller) -> list[tuple[float, ...]]:
        """What the controller got that the guard does not allow."""
        return [values for values in controller.of(self.moving) if not self._is_within(values)]

    def _is_within(self, values: tuple[float, ...]) -> bool:
        sides = zip(values, self.least, self.greatest, strict=True)
        return all(least - 1e-6 <= value <= greatest + 1e-6 for value, least, greatest in sides)

    def write(self, folder: Path, *, guard: bool = True, program: str = "", more: str = "") -> Path:
        """The project on disk."""
        own = ("own.toml",) if self.vocabulary else ()
        files = ", ".join(f'"{file_name}"' for file_name in (*own, *self.shipped))
        texts = {
            "program.py": program or self.program, "tests/test_program.py": self.tests,
            "own.toml": self.vocabulary, "cell_io.py": CELL_IO, "conftest.py": self.prepare,
            "pytest.ini": "[pytest]\npythonpath = .\n",
            "mutabot.toml": f'program = ["program.py"]\nvocabulary = [{files}]\nrounds = 1\n'
            + dedent(self.guard if guard else "") + dedent(more),
        }  # fmt: skip
        for name, text in texts.items():
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_text(dedent(text), encoding="utf-8")
        return folder


#: whose controller answers is well
CELL_IO = """
    def retreat():
        pass

    def is_alive():
        pass
    """
HARDWARE = """
    [hardware]
    safe_state = "cell_io:retreat"
    heartbeat = "cell_io:is_alive"
    """


@contextmanager
def listening(*answers: Callable[[socket.socket], None], ports: tuple[int, ...] = ()) -> Iterator[list[int]]:
    """Answer connections, one thread each. Gives the ports, which are free ones unless they are given.

    Args:
        answers: for each port, what talks on a connection until it is closed.
        ports: the ports; protocols often have fixed ones.
    """
    doors = [socket.create_server((ADDRESS, port)) for port in ports or (0,) * len(answers)]
    open_connections: list[socket.socket] = []

    def talk(answer: Callable[[socket.socket], None], connection: socket.socket) -> None:
        with connection:
            try:
                answer(connection)
            except OSError:  # the client is gone, or killed
                return

    def listen(door: socket.socket, answer: Callable[[socket.socket], None]) -> None:
        while True:
            try:
                connection, _ = door.accept()
            except OSError:
                return
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            open_connections.append(connection)
            threading.Thread(target=talk, args=(answer, connection), daemon=True).start()

    threads = [
        threading.Thread(target=listen, args=pair, daemon=True) for pair in zip(doors, answers, strict=True)
    ]
    for thread in threads:
        thread.start()
    try:
        yield [door.getsockname()[1] for door in doors]
    finally:
        for door in doors:
            door.shutdown(socket.SHUT_RDWR)
            door.close()
        for connection in open_connections:
            connection.close()
        for thread in threads:
            thread.join()


#: of this process, so that several can listen at fixed ports
ADDRESS = socket.inet_ntoa(struct.pack("!I", 0x7F000000 | (threading.get_native_id() & 0x3FFFFF) << 2 | 2))


def exactly(connection: socket.socket, count: int) -> bytes:
    """So many bytes. Raises ConnectionError if the client is gone before."""
    data = b""
    while len(data) < count:
        part = connection.recv(count - len(data))
        if not part:
            raise ConnectionResetError
        data += part
    return data
