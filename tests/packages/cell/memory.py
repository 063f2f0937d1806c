"""A memory as the processes of a campaign share it, in one process."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from mutabot import shared_memory


@contextmanager
def remembering() -> Iterator[None]:
    """Inside, cells that are made remember together."""
    shared_memory.share()
    try:
        yield
    finally:
        shared_memory.forget()
