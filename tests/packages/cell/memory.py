"""A memory as the processes of a campaign share it, in one process."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from mutabot.api.processes import SharedMemory


@contextmanager
def remembering() -> Iterator[None]:
    """Inside, cells that are made remember together."""
    SharedMemory.share()
    try:
        yield
    finally:
        SharedMemory.forget()
