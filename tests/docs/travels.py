"""Campaigns that tell which functions of ours are called, in all their processes, in the order of time."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from textwrap import dedent
from types import FrameType
from typing import Any

#: a process, and the name of a function that it called
Called = tuple[int, str]

TESTS = Path(__file__).parents[1]
_OVER = "over\n"


def telling(pipe: str) -> str:
    """A plug-in of pytest's with which a worker tells its calls, from before its session begins."""
    return dedent(f"""
        import sys
        sys.path.insert(0, {str(TESTS)!r})
        from docs.travels import tell_calls
        sys.path.pop(0)
        tell_calls({pipe!r})
    """)


def tell_calls(pipe: str) -> None:
    """From now on, write the name of each of our functions that is called into the pipe.

    A fork goes on telling. It is a pipe, since mutabot does not fork while a file is open for writing.
    """
    sys.setprofile(_hook_into(os.open(pipe, os.O_WRONLY)))


def _hook_into(descriptor: int) -> Callable[[FrameType, str, Any], None]:
    process = [os.getpid()]

    def begin() -> None:  # a fork has the process id of its parent
        process[0] = int.from_bytes(os.urandom(6))

    os.register_at_fork(after_in_child=begin)

    def hook(frame: FrameType, event: str, argument: Any) -> None:
        module = frame.f_globals.get("__name__", "")
        if event == "call" and module.startswith("mutabot."):
            name = f"{module.removeprefix('mutabot.')}.{frame.f_code.co_qualname}"
            os.write(descriptor, f"{process[0]} {name}\n".encode())

    return hook


@contextmanager
def calls_told() -> Iterator[tuple[list[Called], str]]:
    """All calls of ours in this process and in those that tell them, complete when this is over.

    They find the pipe as this process has it, since files in the folders that they see are their own.
    """
    reading, writing = os.pipe()
    told: list[Called] = []

    def read() -> None:
        with os.fdopen(reading, encoding="utf-8") as lines:
            for line in iter(lines.readline, _OVER):
                process, name = line.split()
                told.append((int(process), name))

    reader = threading.Thread(target=read)
    reader.start()
    sys.setprofile(_hook_into(writing))
    try:
        yield told, f"/proc/{os.getpid()}/fd/{writing}"
    finally:
        sys.setprofile(None)
        os.write(writing, _OVER.encode())
        os.close(writing)
        reader.join()
