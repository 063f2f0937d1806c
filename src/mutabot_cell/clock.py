"""`time.sleep` in simulated time."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .cell import Cell


@contextmanager
def simulated_time(cell: Cell) -> Iterator[None]:
    """Let `time.sleep(s)` in this context advance the cell by `s` seconds, at no wall time.

    A program that wrote `from time import sleep` before keeps the real one; let it call `time.sleep`.
    """
    real_sleep = time.sleep
    time.sleep = cell.wait  # type: ignore[assignment]  # float() is all that sleep needs of its argument
    try:
        yield
    finally:
        time.sleep = real_sleep
