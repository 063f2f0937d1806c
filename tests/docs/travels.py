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

TESTS = Path(__file__).parents[1]


def telling(pipe: Path) -> str:
    """A plug-in of pytest's with which a worker tells its calls, from before its session begins."""
    return dedent(f"""
        import sys
        sys.path.insert(0, {str(TESTS)!r})
        from docs.travels import hook_into
        sys.path.pop(0)
        sys.setprofile(hook_into({str(pipe)!r}))
    """)


def hook_into(pipe: Path | str) -> Callable[[FrameType, str, Any], None]:
    """A profiler that writes the name of each of our functions that is called into the pipe.

    A fork goes on telling. A pipe, as no file that is open for writing lets mutabot fork.
    """
    descriptor = os.open(pipe, os.O_WRONLY)

    def hook(frame: FrameType, event: str, argument: Any) -> None:
        module = frame.f_globals.get("__name__", "")
        if event == "call" and module.startswith("mutabot."):
            os.write(descriptor, f"{module.removeprefix('mutabot.')}.{frame.f_code.co_qualname}\n".encode())

    return hook


@contextmanager
def calls_told(pipe: Path) -> Iterator[list[str]]:
    """All calls of ours in this process and in those that tell them, complete when this is over."""
    os.mkfifo(pipe)
    reading = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    hook = hook_into(pipe)
    os.set_blocking(reading, True)
    told: list[str] = []

    def read() -> None:
        with open(reading, encoding="utf-8") as lines:
            for line in lines:
                if line == "over\n":
                    return
                told.append(line.rstrip("\n"))

    reader = threading.Thread(target=read)
    reader.start()
    sys.setprofile(hook)
    try:
        yield told
    finally:
        sys.setprofile(None)
        pipe_end = os.open(pipe, os.O_WRONLY)
        os.write(pipe_end, b"over\n")
        os.close(pipe_end)
        reader.join()
