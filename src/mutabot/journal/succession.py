"""What lies where a journal is to be written: taken over, kept beside it, or refused."""

from __future__ import annotations

import sqlite3
from contextlib import closing, suppress
from pathlib import Path

from mutabot.errors import JournalError

from .database import SUFFIXES, connect, guarded, write_anew
from .files import previous_of
from .sound import check_schema
from .store import Store


def make_way(path: Path) -> Path | None:
    """Move aside what lies there and is no journal of this version; returns where to.

    A journal of another version gets that as part of its name, so that no later campaign overwrites it;
    a damaged one takes the place of the previous one.

    Raises JournalError for a file that is not ours.
    """
    for half in (path, previous_of(path)):  # of a campaign that was killed meanwhile
        half.with_name(f"{half.name}.new").unlink(missing_ok=True)
    if not path.exists():
        return None
    with path.open("rb") as file:
        start = file.read(16)
    if start and not start.startswith(b"SQLite format 3"):
        raise JournalError(f"{path} is in the way: it is not a journal of mutabot", path=str(path))
    kept = previous_of(path)
    try:
        if _is_journal(path):
            return None
    except JournalError as error:
        if error.version is None:
            raise
        kept = path.with_name(f"{path.stem}.version-{error.version}{path.suffix}")
    if _is_empty(path):  # of a campaign that was killed before it had begun
        return None
    for suffix in SUFFIXES:
        old, new = path.with_name(path.name + suffix), kept.with_name(kept.name + suffix)
        new.unlink(missing_ok=True)
        if old.exists():
            old.replace(new)
    return kept


def keep_copy(store: Store) -> None:
    """Keep the campaign of an opened journal as it is, as ``previous_of`` its path."""
    with guarded(store.path):
        write_anew(store.connection, previous_of(store.path))


def _is_empty(path: Path) -> bool:
    with suppress(sqlite3.DatabaseError), closing(connect(path)) as connection:
        return connection.execute("SELECT 1 FROM sqlite_master").fetchone() is None
    return False


def _is_journal(path: Path) -> bool:
    """Whether it is a sound journal of this version. Raises JournalError for one of another version."""
    try:
        with closing(connect(path)) as connection:
            check_schema(path, connection)
            (sound,) = connection.execute("PRAGMA quick_check(1)").fetchone()
    except (JournalError, sqlite3.DatabaseError) as error:
        cause = error.__cause__ if isinstance(error, JournalError) else error
        if isinstance(cause, sqlite3.OperationalError):
            raise  # it is not the content that is wrong: a full disk, a folder that cannot be written
        if isinstance(error, JournalError) and error.version is not None:
            raise
        return False
    return bool(sound == "ok")
