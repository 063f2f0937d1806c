"""The tables of a journal, and the statements that make them and lead from one campaign to the next."""

from __future__ import annotations

SCHEMA_VERSION = 5

TABLES = """
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE test (
    round INTEGER NOT NULL, repetition INTEGER NOT NULL, test TEXT NOT NULL, outcome TEXT NOT NULL,
    data TEXT NOT NULL, PRIMARY KEY (round, repetition, test));
CREATE TABLE mutant (number INTEGER NOT NULL, id TEXT PRIMARY KEY, data TEXT NOT NULL);
CREATE TABLE left_out (id TEXT NOT NULL, reason TEXT NOT NULL, data TEXT NOT NULL);
CREATE TABLE source (file TEXT PRIMARY KEY, text TEXT NOT NULL);
CREATE TABLE outcome (
    mutant TEXT NOT NULL, round INTEGER NOT NULL, verdict TEXT NOT NULL, "by" TEXT, data TEXT NOT NULL,
    key TEXT NOT NULL, reused INTEGER NOT NULL);
CREATE INDEX outcome_of ON outcome (mutant, round);
CREATE TABLE control (
    test_file TEXT NOT NULL, control TEXT NOT NULL, ok INTEGER NOT NULL, detail TEXT NOT NULL);
CREATE TABLE kept (
    mutant TEXT NOT NULL, round INTEGER NOT NULL, verdict TEXT NOT NULL, "by" TEXT, data TEXT NOT NULL,
    key TEXT NOT NULL, PRIMARY KEY (mutant, round));
CREATE TABLE parts (digest TEXT PRIMARY KEY, data TEXT NOT NULL);
CREATE TABLE known (id TEXT PRIMARY KEY, data TEXT NOT NULL, outdated INTEGER NOT NULL);
CREATE TABLE text (digest TEXT PRIMARY KEY, data BLOB NOT NULL);
CREATE TABLE mark (
    "table" TEXT NOT NULL, row INTEGER NOT NULL, digest BLOB NOT NULL, PRIMARY KEY ("table", row)
) WITHOUT ROWID;
"""
#: the tables with rows of their own, and their columns; ``mark`` holds a digest of each row
COLUMNS = {
    "meta": ("key", "value"),
    "test": ("round", "repetition", "test", "outcome", "data"),
    "mutant": ("number", "id", "data"),
    "left_out": ("id", "reason", "data"),
    "source": ("file", "text"),
    "outcome": ("mutant", "round", "verdict", "by", "data", "key", "reused"),
    "control": ("test_file", "control", "ok", "detail"),
    "kept": ("mutant", "round", "verdict", "by", "data", "key"),
    "parts": ("digest", "data"),
    "known": ("id", "data", "outdated"),
    "text": ("digest", "data"),
}
#: the rows that hold the last outcome of each mutant and round
LAST = "SELECT max(rowid) FROM outcome GROUP BY mutant, round"
#: what ``reused`` says of an outcome: found by this campaign, or known from another
FOUND, KNOWN_BEFORE = 0, 1
#: from one campaign to the next
ADOPT = f"""
INSERT OR REPLACE INTO known SELECT id, data, 1 FROM mutant;
INSERT OR REPLACE INTO kept
    SELECT mutant, round, verdict, "by", data, key FROM outcome
    WHERE rowid IN ({LAST});
DELETE FROM meta;
DELETE FROM test;
DELETE FROM mutant;
DELETE FROM left_out;
DELETE FROM source;
DELETE FROM outcome;
DELETE FROM control
"""
_OUTCOMES = f'SELECT mutant, round, verdict, "by", data, key, reused FROM outcome WHERE rowid IN ({LAST})'
#: from one journal to another: what is asked there, and what is done with each row here; the first counts
TAKE = {
    f"{_OUTCOMES} ORDER BY rowid":
        "INSERT INTO outcome SELECT ?1, ?2, ?3, ?4, ?5, ?6, ?7 "
        "WHERE NOT EXISTS (SELECT 1 FROM outcome WHERE mutant = ?1 AND round = ?2)",
    "SELECT test_file, control, ok, detail FROM control ORDER BY rowid":
        "INSERT INTO control SELECT ?1, ?2, ?3, ?4 WHERE NOT EXISTS "
        "(SELECT 1 FROM control WHERE test_file = ?1 AND control = ?2 AND ok = ?3)",
    "SELECT * FROM parts": "INSERT OR IGNORE INTO parts VALUES (?, ?)",
    "SELECT * FROM text": "INSERT OR IGNORE INTO text VALUES (?, ?)",
    "SELECT * FROM kept": "INSERT OR IGNORE INTO kept VALUES (?, ?, ?, ?, ?, ?)",
}  # fmt: skip
# Keys of meta that are the journal's own; the others are the campaign's.
VERSION_KEY, FINISHED_KEY = "journal:version", "journal:finished"
#: of a campaign that has not begun yet: why it ended, null as long as it has not
ATTEMPT_KEY = "journal:attempt"
