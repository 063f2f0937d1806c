"""A robot at the other end of a connection: it writes down what reaches it, and when."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from textwrap import dedent


@dataclass
class RobotServer:
    """Takes lines from any number of connections. ``received``: the time of each, ``monotonic``, and it."""

    received: list[tuple[float, str]] = field(default_factory=list)
    port: int = 0
    connections: list[threading.Thread] = field(default_factory=list)

    def lines(self) -> list[str]:
        return [line for _, line in self.received]

    def settle(self) -> None:
        """Wait until all that clients have sent is here: their connections are closed."""
        for thread in self.connections:
            thread.join(10.0)


@contextmanager
def robot_server() -> Iterator[RobotServer]:
    server = RobotServer()
    listening = socket.create_server(("127.0.0.1", 0))
    server.port = listening.getsockname()[1]

    def listen() -> None:
        while True:
            try:
                connection, _ = listening.accept()
            except OSError:
                return
            thread = threading.Thread(target=read, args=(connection,), daemon=True)
            server.connections.append(thread)
            thread.start()

    def read(connection: socket.socket) -> None:
        with connection, connection.makefile("rb") as lines:
            try:
                for line in lines:
                    server.received.append((time.monotonic(), line.decode().strip()))
            except ConnectionError:
                return

    thread = threading.Thread(target=listen, daemon=True)
    thread.start()
    try:
        yield server
    finally:
        listening.shutdown(socket.SHUT_RDWR)
        listening.close()
        thread.join()


#: the client library: a method, a property that is set, a text command, and a move by an amount
ROBOT = """
    import os
    import socket

    class Arm:
        def __init__(self):
            port = int(os.environ["ROBOT_PORT"])
            self.connection = socket.create_connection(("127.0.0.1", port))
            self.place = {"x": 0.4, "z": 0.5}

        def _go(self, **axes):
            self.place |= axes
            self.tell("at {x!r} {z!r}".format(**self.place))

        def tell(self, line):
            self.connection.sendall(line.encode() + b"\\n")

        def move_to(self, x, z, speed=0.1):
            self.tell(f"speed {speed!r}")
            self._go(x=x, z=z)

        def move_by(self, dx=0.0, dz=0.0):
            self._go(x=self.place["x"] + dx, z=self.place["z"] + dz)

        def send(self, text):
            word, _, value = text.partition(" ")
            if word == "height":
                self._go(z=float(value))
            else:
                self.tell(text)

        @property
        def lift(self):
            return self.place["z"]

        @lift.setter
        def lift(self, z):
            self._go(z=z)

        def pose(self):
            return dict(self.place)

        def grip(self, closed):
            self.tell("closed" if closed else "open")
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Arm.move_to"
    current = "robot:Arm.pose"
    arguments.x = { kind = "translation", axis = "x", unit = "m", mode = "to" }
    arguments.z = { kind = "translation", axis = "z", unit = "m", mode = "to" }
    arguments.speed = { kind = "speed", unit = "m/s" }

    [[operation]]
    call = "robot:Arm.move_by"
    current = "robot:Arm.pose"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
    arguments.dz = { kind = "translation", axis = "z", unit = "m", mode = "by" }

    [[operation]]
    call = "robot:Arm.lift"
    arguments.z = { kind = "translation", axis = "z", unit = "m", mode = "to" }

    [[operation]]
    call = "robot:Arm.send"
    message = "text"
    patterns = [
      { text = "height {z:g}", kind = "translation", axis = "z", unit = "m", mode = "to" },
    ]

    [[operation]]
    call = "robot:Arm.pose"
    result."['x']" = { kind = "position", axis = "x", unit = "m" }
    result."['z']" = { kind = "position", axis = "z", unit = "m" }

    [[operation]]
    call = "robot:Arm.grip"
    arguments.closed = { kind = "opening", values = [true, false] }
"""
GUARD = """
    [guard]
    box = [{ x = [0.2, 0.7], z = [0.1, 0.9] }]
    limit = [{ kind = "speed", max = 0.25, unit = "m/s" }]
"""


def write_project(folder: Path, program: str, tests: str, guard: str = GUARD, more: str = "") -> Path:
    """A project whose robot is at the other end of a connection."""
    texts = {
        "robot.py": ROBOT, "robot.toml": VOCABULARY, "program.py": program, "tests/test_program.py": tests,
        "mutabot.toml": 'program = ["program.py"]\nvocabulary = ["robot.toml"]\nrounds = 1\n' + dedent(guard),
        "pytest.ini": "[pytest]\npythonpath = .\n", "cell_io.py": more,
    }  # fmt: skip
    for name, text in texts.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(dedent(text), encoding="utf-8")
    return folder
