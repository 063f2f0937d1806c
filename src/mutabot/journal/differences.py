"""How the file of a journal differs from what was written into it."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from typing import Any

from .marks import name_of, word_for
from .schema import COLUMNS

#: rows that are named before it is said how many more there are
_SHOWN = 5
_Row = tuple[Any, ...]


def differences(file: sqlite3.Connection, known: sqlite3.Connection) -> list[str]:
    """Rows that were changed, added or removed, and whatever else is in the file, in words."""
    question = "SELECT type, name, sql FROM main.sqlite_master ORDER BY name, type"
    theirs, ours = (one.execute(question).fetchall() for one in (file, known))
    if theirs != ours:
        strange = [f"{kind} {name}" for kind, name, _ in theirs if name not in {row[1] for row in ours}]
        return [f"the tables are others than were made ({', '.join(strange[:_SHOWN]) or 'some are gone'})"]
    found: list[str] = []
    count = 0
    for line in _all(file, known):
        count += 1
        if count <= _SHOWN:
            found.append(line)
    return [*found, f"and {count - _SHOWN} more"] if count > _SHOWN else found


def _all(file: sqlite3.Connection, known: sqlite3.Connection) -> Iterator[str]:
    for table, columns in COLUMNS.items():
        yield from _in_table(table, columns, file, known)
    question = 'SELECT * FROM main.mark ORDER BY "table", row'
    if any(one != other for one, other in _side_by_side(file.execute(question), known.execute(question))):
        yield "the marks of rows"


def _in_table(
    table: str, columns: tuple[str, ...], file: sqlite3.Connection, known: sqlite3.Connection
) -> Iterator[str]:
    names = ", ".join(f'"{column}"' for column in columns)
    question = f"SELECT rowid, {names} FROM main.{table} ORDER BY rowid"
    theirs, ours = file.execute(question), known.execute(question)
    there, here = next(theirs, None), next(ours, None)
    while there is not None or here is not None:
        if here is None or (there is not None and there[0] < here[0]):
            yield _said(table, there, "added")
            there = next(theirs, None)
        elif there is None or here[0] < there[0]:
            yield _said(table, here, "removed")
            here = next(ours, None)
        else:
            if there != here:
                yield _said(table, here, "changed")
            there, here = next(theirs, None), next(ours, None)


def _side_by_side(theirs: Iterator[_Row], ours: Iterator[_Row]) -> Iterator[tuple[_Row | None, _Row | None]]:
    while True:
        pair = next(theirs, None), next(ours, None)
        if pair == (None, None):
            return
        yield pair


def _said(table: str, row: _Row | None, what: str) -> str:
    assert row is not None
    return f"{word_for(table)} {name_of(table, row[1:])} was {what}"
