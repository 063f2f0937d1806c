"""Journals as Mutabot might have written them: edited, and marked so."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from mutabot.journal.database import connect, mark_rows


@contextmanager
def edited(path: Path) -> Iterator[sqlite3.Connection]:
    """A connection whose changes count as the journal's own."""
    with closing(connect(path)) as connection:
        mark_rows(connection)
        yield connection
