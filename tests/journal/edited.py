"""Journals that were edited, as Mutabot might have written them."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from mutabot.journal.database import connect


@contextmanager
def edited(path: Path) -> Iterator[sqlite3.Connection]:
    """A connection whose changes count as the journal's own."""
    with closing(connect(path)) as connection:
        yield connection
