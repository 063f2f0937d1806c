"""Rows of other journals, taken over into one that is written."""

from __future__ import annotations

from collections.abc import Iterable

from .recordings import Recordings
from .schema import LAST
from .store import Store

#: what all shards have alike: plan, baseline and sources
_OF_PLAN = {
    "test": "SELECT * FROM test ORDER BY rowid",
    "mutant": "SELECT * FROM mutant ORDER BY rowid",
    "left_out": "SELECT * FROM left_out ORDER BY rowid",
    "source": "SELECT * FROM source",
}
_OUTCOMES = f'SELECT mutant, round, verdict, "by", data, key, reused FROM outcome WHERE rowid IN ({LAST})'
#: the first that comes counts
_OF_EACH = (
    (
        f"{_OUTCOMES} ORDER BY rowid",
        "INSERT INTO outcome SELECT ?1, ?2, ?3, ?4, ?5, ?6, ?7 "
        "WHERE NOT EXISTS (SELECT 1 FROM outcome WHERE mutant = ?1 AND round = ?2)",
    ),
    (
        "SELECT test_file, control, ok, detail FROM control ORDER BY rowid",
        "INSERT INTO control SELECT ?1, ?2, ?3, ?4 WHERE NOT EXISTS "
        "(SELECT 1 FROM control WHERE test_file = ?1 AND control = ?2 AND ok = ?3)",
    ),
    ("SELECT digest, data FROM parts", "INSERT OR IGNORE INTO parts VALUES (?, ?)"),
    ("SELECT digest, data FROM text", "INSERT OR IGNORE INTO text VALUES (?, ?)"),
    (
        'SELECT mutant, round, verdict, "by", data, key FROM kept',
        "INSERT OR IGNORE INTO kept VALUES (?, ?, ?, ?, ?, ?)",
    ),
)


def take_plan(store: Store, other: Store) -> None:
    """The plan of another journal, its baseline and the texts, in the place of what is there."""
    with store.transaction() as execute:
        for table, question in _OF_PLAN.items():
            execute(f"DELETE FROM {table}")
            for row in other.rows(question):
                execute(f"INSERT INTO {table} VALUES ({', '.join('?' * len(row))})", *row)


def take_outcomes(store: Store, other: Store) -> None:
    """What another journal has found, and knows of earlier campaigns, as far as that is not there already."""
    with store.transaction() as execute:
        for question, statement in _OF_EACH:
            for row in other.rows(question):
                execute(statement, *row)


def take_recordings(target: Recordings, others: Iterable[Recordings], mutants: Iterable[str]) -> None:
    """The recordings of several journals; of equal ones the first counts.

    Args:
        mutants: those that the campaign knows; what was recorded of others makes way.
    """
    target.keep_only(set(mutants))
    done: set[tuple[str, int]] = set()
    for other in others:
        own = [pair for pair in other.pairs() if pair not in done]
        for mutant, round in own:
            target.forget(mutant, round)
            for test, rank, data in other.of(mutant, round):
                target.add(mutant, round, test, rank, data)
        done.update(own)
