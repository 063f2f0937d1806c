"""Watching goes on in the processes that the tests start; each writes what it saw when it ends."""

from __future__ import annotations

import atexit
import json
import os
import signal
import sys
from collections.abc import Mapping
from types import FrameType
from typing import Any

from mutabot import extensions
from mutabot.model.codec import to_data
from mutabot.model.event_file import FOLDER
from mutabot.runtime.processes.environment import carry, write_wake
from mutabot.runtime.program_text.loading import hook_script
from mutabot_init.watching.watch import Watch

_ORDER = "order.json"
_SEEN = ".seen.json"


def watch_elsewhere(path: str, order: Mapping[str, Any]) -> str:
    """Watch processes that are started from now on; ``path`` is that of the order.

    Returns the folder in which they write.
    """
    folder = os.path.join(os.path.dirname(path), FOLDER)
    os.mkdir(folder)
    write(os.path.join(folder, _ORDER), order)
    names = {name.rpartition("/")[2].removesuffix(".py") for name in order["program"].values()}
    folders = {part for name in order["program"].values() for part in name.split("/")[:-1]}
    write_wake(folder, __name__, "", names | folders, order["program"])
    carry(folder)
    return folder


def join(folder: str) -> None:
    """Watch this process, which turned out to be of interest."""
    order = read(os.path.join(folder, _ORDER))
    extensions.use(order["extensions"])
    watch = Watch.of(order)
    watch.install()
    hook_script()
    leave = os._exit

    def write_all() -> None:
        write(os.path.join(folder, f"{os.getpid()}{_SEEN}"), to_data(watch.data()))

    def leave_at_once(status: int) -> None:
        write_all()
        leave(status)

    def end(number: int, frame: FrameType | None) -> None:
        sys.exit(128 + number)

    atexit.register(write_all)
    os._exit = leave_at_once  # type: ignore[assignment]
    if signal.getsignal(signal.SIGTERM) is signal.SIG_DFL:
        signal.signal(signal.SIGTERM, end)  # else nothing would be written


def write(path: str, data: Mapping[str, Any]) -> None:
    """Write data as JSON, all of it or nothing."""
    with open(f"{path}.new", "w", encoding="utf-8", errors="surrogateescape") as file:
        json.dump(data, file, default=str)
    os.replace(f"{path}.new", path)


def read(path: str) -> dict[str, Any]:
    """Read data that ``write`` has written."""
    with open(path, encoding="utf-8", errors="surrogateescape") as file:
        data: dict[str, Any] = json.load(file)
    return data


def seen_elsewhere(folder: str) -> list[dict[str, Any]]:
    """Return what processes saw, each as the data of a ``WatchedCalls``."""
    names = sorted(name for name in os.listdir(folder) if name.endswith(_SEEN))
    return [read(os.path.join(folder, name)) for name in names]
