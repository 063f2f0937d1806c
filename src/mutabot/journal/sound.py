"""What the file of a journal may hold: the tables that this version makes, and nothing else.

A file may come from anybody. A view or a trigger in it would be evaluated with each question, for as long as
whoever wrote it liked, so there may be none.
"""

from __future__ import annotations

import sqlite3
from contextlib import closing, suppress
from functools import cache
from pathlib import Path

from mutabot.errors import JournalError

from .fitting import UNFIT, load
from .schema import SCHEMA_VERSION, TABLES, VERSION_KEY

#: things in a file that are looked at: a journal has fewer
_MOST = 100
_MOST_VERSIONS = 1_000_000
_Thing = tuple[str, str, str | None]


@cache
def _made() -> frozenset[_Thing]:
    """What this version makes."""
    with closing(sqlite3.connect(":memory:")) as connection:
        connection.executescript(TABLES)
        return frozenset(connection.execute("SELECT type, name, sql FROM sqlite_master"))


def check_schema(path: Path, connection: sqlite3.Connection) -> None:
    """Raise JournalError if this is no journal of this version."""
    question = "SELECT type, name, sql FROM main.sqlite_master LIMIT ?"
    found: set[_Thing] = set(connection.execute(question, (_MOST,)))
    if not found:  # of a campaign that was killed before it had begun
        raise no_journal(path)
    tables = {name for kind, name, _ in found if kind == "table"}
    if not {"meta", "outcome"} <= tables:
        raise JournalError(f"{path} is a database, but not a journal of mutabot", path=str(path))
    strange = sorted(f"{kind} {name}" for kind, name, _ in found - _made())
    if "table meta" not in strange:
        version = _version(connection)
        # a version that cannot be read is one row that is damaged, if all tables are ours
        if version != SCHEMA_VERSION and (version is not None or strange):
            raise JournalError(
                f"{path} was written by another version of mutabot (journal version {version or '?'}, "
                f"this one reads {SCHEMA_VERSION}); run the campaign again",
                path=str(path),
                version=version,
            )
    if strange or _made() - found:
        what = f"holds what no journal has ({', '.join(strange[:3])})" if strange else "lacks a table"
        raise JournalError(
            f"{path} {what}, so something else than mutabot has changed it; run the campaign again",
            path=str(path),
        )


def _version(connection: sqlite3.Connection) -> int | None:
    row = connection.execute("SELECT value FROM main.meta WHERE key = ?", (VERSION_KEY,)).fetchone()
    with suppress(*UNFIT):
        found = load(row[0]) if row is not None else None
        return found if isinstance(found, int) and abs(found) < _MOST_VERSIONS else None
    return None


def no_journal(path: Path) -> JournalError:
    """There is nothing there."""
    return JournalError(f"{path}: there is no journal yet; `mutabot run` writes it", path=str(path))
