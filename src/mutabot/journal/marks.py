"""Marks: a digest of each row, written with the row, by which rows that somebody else wrote are found.

There is no secret in it: whoever knows how a journal is made can make a mark as well. What a mark shows is
that a row is as some Mutabot wrote it: not damaged, edited, added or taken away by anything else.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import blake2b
from typing import Any

from .database import Connection, decode
from .fitting import is_round
from .schema import COLUMNS

_FUNCTION = "mutabot_mark"
_SIZE = 12
#: characters of a name that are shown
_LONGEST = 150
#: by which column people know a row
_NAMES = {"meta": "key", "test": "test", "mutant": "id", "left_out": "id", "source": "file", "known": "id"}
#: what people call rows of a table
_WORDS = {
    "meta": "fact",
    "test": "test of the baseline",
    "left_out": "mutant that was left out",
    "outcome": "outcome",
    "kept": "earlier outcome",
    "known": "earlier mutant",
}


def mark_of(*values: Any) -> bytes:
    """The mark of a row: its table and all its values."""
    text = "\0".join([decode(one) if isinstance(one, bytes) else str(one) for one in values])
    return blake2b(text.encode("utf-8", "surrogateescape"), digest_size=_SIZE).digest()


def mark_rows(connection: sqlite3.Connection) -> None:
    """Have every row that this connection writes marked, and no mark stay of a row that it removes."""
    connection.create_function(_FUNCTION, -1, mark_of, deterministic=True)
    # Without this, a row that is replaced goes without a trigger.
    connection.execute("PRAGMA recursive_triggers = ON")
    for table, columns in COLUMNS.items():
        # as bytes: a text from elsewhere may be no UTF-8
        new = ", ".join(f'CAST(new."{column}" AS BLOB)' for column in columns)
        remove = f"DELETE FROM mark WHERE \"table\" = '{table}' AND row = "
        add = f"INSERT INTO mark VALUES ('{table}', new.rowid, {_FUNCTION}('{table}', {new}));"
        for event, actions in (
            ("INSERT", f"{remove} new.rowid; {add}"),  # there may be one of a row that is gone
            ("DELETE", f"{remove} old.rowid;"),
            ("UPDATE", f"{remove} old.rowid; {add}"),
        ):
            # Temporary: in the file there is nothing but tables.
            connection.execute(
                f"CREATE TEMP TRIGGER mark_{table}_{event} AFTER {event} ON main.{table} BEGIN {actions} END"
            )


class Unmarked(dict[str, dict[int, str]]):
    """Rows that are not as Mutabot wrote them: by table and row id, what people know them by.

    Attributes:
        gone: number of rows that are gone, by table.
    """

    def __init__(self, connection: Connection) -> None:
        super().__init__()
        self.gone: dict[str, int] = {}
        for table in COLUMNS:
            self._look(connection, table)

    def _look(self, connection: Connection, table: str) -> None:
        marked = 0
        for row, mark, values in _rows(connection, table):
            marked += mark is not None
            if mark != mark_of(table, *values):
                self.setdefault(table, {})[row] = name_of(table, values)
        (marks,) = connection.execute('SELECT count(*) FROM mark WHERE "table" = ?', (table,)).fetchone()
        if marks > marked:
            self.gone[table] = marks - marked

    def lines(self) -> Iterator[str]:
        """Each of them in words."""
        for table, rows in self.items():
            yield from (f"{word_for(table)} {name}" for name in rows.values())
        for table, count in self.gone.items():
            yield f"{count} × {word_for(table)} that {'is' if count == 1 else 'are'} gone"


def leave_out(connection: sqlite3.Connection) -> list[str]:
    """Have questions of a connection that reads see marked rows alone; returns the others in words."""
    with _as_of_now(connection):
        found = Unmarked(connection)
        for table, rows in found.items():
            # a temporary table goes before the journal's own of that name
            connection.execute("CREATE TEMP TABLE IF NOT EXISTS unmarked (row INTEGER PRIMARY KEY)")
            connection.execute("DELETE FROM temp.unmarked")
            connection.executemany("INSERT INTO temp.unmarked VALUES (?)", [(row,) for row in rows])
            connection.execute(
                f"CREATE TEMP TABLE {table} AS SELECT * FROM main.{table} "
                "WHERE rowid NOT IN (SELECT row FROM temp.unmarked) ORDER BY rowid"
            )
    return list(found.lines())


@contextmanager
def _as_of_now(connection: sqlite3.Connection) -> Iterator[None]:
    """All questions see the same rows, also of a journal that is being written."""
    connection.execute("BEGIN")
    try:
        yield
    finally:
        connection.execute("COMMIT")


def remove(connection: Connection, found: Unmarked) -> None:
    """Remove rows that are not marked, and marks of rows that are gone."""
    for table, rows in found.items():
        for row in rows:
            connection.execute(f"DELETE FROM {table} WHERE rowid = ?", (row,))
    for table in found.gone:
        connection.execute(
            f'DELETE FROM mark WHERE "table" = ? AND row NOT IN (SELECT rowid FROM {table})', (table,)
        )


def _rows(connection: Connection, table: str) -> Iterator[tuple[int, Any, tuple[Any, ...]]]:
    columns = ", ".join(f't."{column}"' for column in COLUMNS[table])
    question = (
        f"SELECT t.rowid, m.digest, {columns} FROM main.{table} AS t "
        f"LEFT JOIN main.mark AS m ON m.\"table\" = '{table}' AND m.row = t.rowid"
    )
    for row, mark, *values in connection.execute(question):
        yield row, mark, tuple(values)


def word_for(table: str) -> str:
    """What people call a row of a table."""
    return _WORDS.get(table, table)


def name_of(table: str, values: tuple[Any, ...]) -> str:
    """What people know a row by, not longer than a line."""
    known = dict(zip(COLUMNS[table], values, strict=True))
    if "round" in known and "mutant" in known:
        round = known["round"]
        where = f" in round {round + 1}" if is_round(round) else ""
        return f"{named(known['mutant'])}{where}"
    return named(known[_NAMES.get(table, COLUMNS[table][0])])


def named(value: Any) -> str:
    """A name from a journal as it can be printed, not longer than a line."""
    text = value if isinstance(value, str) else repr(value)
    return repr(text[:_LONGEST].encode("utf-8", "replace").decode())[1:-1]
