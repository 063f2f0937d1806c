"""The robot behind the line: a cell that listens at a port."""

from __future__ import annotations

import socketserver
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from cell import Cell, ProtectiveStop, Refused, World

_cell: Cell | None = None


def world() -> World:
    """What is true in the cell now: for people and tools, not for programs."""
    if _cell is None:
        raise RuntimeError("no cell is connected")
    return _cell.world


@contextmanager
def listening(cell: Cell) -> Iterator[int]:
    """A port at which this cell takes commands as long as the context lasts."""
    global _cell  # noqa: PLW0603  # one robot per process
    _cell = cell

    class Handler(socketserver.StreamRequestHandler):
        def handle(self) -> None:
            for line in self.rfile:
                self.wfile.write(f"{_answer(cell, line.decode('ascii').rstrip())}\n".encode("ascii"))

    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), Handler) as server:
        server.daemon_threads = True
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02})
        thread.start()
        try:
            yield server.server_address[1]
        finally:
            server.shutdown()
            thread.join()


def _answer(cell: Cell, line: str) -> str:
    word, _, text = line.partition(" ")
    try:
        if word == "do":
            cell.execute(text)
            return "done"
        return f"is {cell.reading(text)}"
    except Refused as error:
        return f"refused {error}"
    except ProtectiveStop as error:
        return f"stopped {error}"
