"""A journal with anything in its rows: reading it never fails, and no other mutant's outcome is touched."""

from __future__ import annotations

import json
import random
import shutil
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from mutabot.cli.app import main
from mutabot.errors import ExitCode
from mutabot.journal.database import columns, decode
from mutabot.journal.journal import Journal
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import REACHING, BaselineTest, ControlEnd, KeptBaseline, OriginalRun
from mutabot.model.events import TestEnd
from mutabot.report.format import Material, format_of, names
from mutabot.report.terminal.campaign import print_results
from mutabot.report.terminal.console import make_console
from mutabot.report.terminal.mutant import print_mutant
from mutabot.report.texts import portable
from mutabot.results.gate import decide
from mutabot.results.results import read_results
from mutabot.results.stored import open as open_campaign
from mutabot.thresholds.thresholds import thresholds_of
from results import samples

TIMES, SEED = 1000, 24
OTHER = replace(samples.SKIP, number=9, site=replace(samples.SKIP.site, occurrence=2))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A journal with rows in every table."""
    path = tmp_path_factory.mktemp("journal") / "journal.sqlite"
    samples.write_journal(path)
    reached = {"tests": [samples.TEST], "sites": {samples.MOVE.id: [0]}}
    with Journal.create(path, meta=samples.meta(**{REACHING: reached})) as journal:
        passed = TestEnd(samples.TEST, "passed", wall=0.5)
        journal.add_tests(BaselineTest(round, 0, passed) for round in range(2))
        journal.set_plan(samples.MUTANTS, samples.LEFT_OUT, sources={"mission.py": samples.PROGRAM})
        journal.set_known([(OTHER, True)])
        journal.add_control(ControlEnd("tests/test_mission.py", "identity", True, "as it must"))
        journal.add_parts({"digest": {"mission.py": "text"}})
        journal.add_texts({"text": b"import robot"})
        journal.set_original(KeptBaseline("digest", 1.0, ("a.txt",), (OriginalRun("task", 0, 0.5, b"told"),)))
        for outcome in samples.OUTCOMES:
            journal.add_outcome(outcome, key="a digest c digest")
        journal.finish("complete")
    return path


def texts(chance: random.Random) -> Iterator[Any]:
    """Things that a column may hold."""
    yield chance.randbytes(chance.choice((0, 1, 7, 300)))
    yield chance.choice((None, -1, 0, 1, 2**63 - 1, -(2**63), 1e300, float("inf"), 0.5, "", "9" * 5000))
    yield chance.choice(
        ("[" * 100_000, "{}", "[]", "null", "NaN", "-Infinity", "1e999", "1", "2", '"\\ud800"', "1" * 9999)
    )


def bent(data: Any, chance: random.Random) -> Any:
    """JSON-like data with something else somewhere."""
    if isinstance(data, dict) and data and chance.random() < 0.9:
        name = chance.choice([*data])
        return {**data, name: bent(data[name], chance)}
    if isinstance(data, list) and data and chance.random() < 0.9:
        index = chance.randrange(len(data))
        return [*data[:index], bent(data[index], chance), *data[index + 1 :]]
    return chance.choice(
        (None, True, -1, 0, 10**9, 10**18, 10**400, -0.5, 1e308, float("nan"), float("inf"), "", "x" * 1000,
         "\x1b[2J\0", "../../etc/passwd", [], {}, [[]], {"a": [1]}, [None] * 50, [{}], "survived", "killed")
    )  # fmt: skip


def damage(connection: sqlite3.Connection, chance: random.Random) -> set[tuple[str, Any, Any]]:
    """Put anything into one row; returns which it was and is: table, and its first two columns."""
    table = chance.choice(["outcome", "outcome", "mutant", "kept", "meta", *columns()])
    names_of = columns()[table]
    names = ", ".join(f'"{name}"' for name in names_of)
    rows = connection.execute(f"SELECT rowid, {names} FROM {table}").fetchall()
    row, *values = chance.choice(rows)
    index = chance.randrange(len(names_of))
    try:
        data = json.loads(values[index])
    except (ValueError, TypeError, RecursionError):
        data = None
    if data is not None and chance.random() < 0.8:
        value: Any = json.dumps(bent(data, chance), ensure_ascii=chance.random() < 0.5)
        if chance.random() < 0.2:
            cut = chance.randrange(len(value))
            value = value[:cut] + chance.choice(("", "}", "\\", '"', "\0")) + value[cut + 1 :]
    else:
        value = chance.choice(list(texts(chance)))
    is_text = isinstance(value, bytes) and chance.random() < 0.5  # text that is no UTF-8
    with closing(connection.cursor()) as cursor:
        try:
            place = "CAST(? AS TEXT)" if is_text else "?"
            cursor.execute(f'UPDATE {table} SET "{names_of[index]}" = {place} WHERE rowid = ?', (value, row))
        except sqlite3.IntegrityError:  # a NULL, or a name that is taken
            return set()
    values_now = [*values[:index], value, *values[index + 1 :]]
    return {(table, *some[:2]) for some in (values, values_now)}


def damaged(whole: Path, path: Path, chance: random.Random) -> set[tuple[str, Any, Any]]:
    """A copy of the journal with something wrong."""
    shutil.copy(whole, path)
    with closing(sqlite3.connect(path, isolation_level=None)) as connection:
        connection.text_factory = decode
        connection.execute("BEGIN")
        found = set().union(*(damage(connection, chance) for _ in range(chance.choice((1, 1, 3)))))
        connection.execute("COMMIT")
    return found


def use(path: Path, number: int, sample: list[Callable[[Path], None]]) -> None:
    sample[number % len(sample)](path)


def read_all(path: Path) -> None:
    with JournalReader.open(path) as journal:
        found = read_results(journal, earlier=True)
        assert (found.state == "complete") <= (not found.set_aside)
        for row in journal.found():
            journal.row(*row)
        journal.original()
        for name in ("digest", "text"):
            journal.parts(name)
            journal.text(name)
    decide(found, min_score=0.5, max_errors=0.5)
    thresholds_of(found)
    console = make_console()
    print_results(console, found)
    for result in found.everything:
        print_mutant(console, found.mutant(result.mutant.id), lambda _: samples.PROGRAM)


def written_as(name: str) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        format_of(name)(Material(portable(open_campaign(path))))

    return write


@pytest.mark.whole
def test_rows_may_hold_anything(whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    chance = random.Random(SEED)
    ways = [read_all, read_all, *(written_as(name) for name in names())]
    expected = {(end.mutant, end.round): end for end in samples.OUTCOMES}
    path = tmp_path / "journal.sqlite"
    for number in range(TIMES):
        touched = damaged(whole, path, chance)
        try:
            with JournalReader.open(path) as journal:
                found = {(end.mutant, end.round): end for end in journal.outcomes()}
                rows = {
                    row for table, *row in map(list, touched) if table == "outcome" for row in [tuple(row)]
                }
                for pair, outcome in expected.items():
                    assert pair in rows or found.get(pair) == outcome
                plan = {row[1] for row in touched if row[0] == "mutant"}
                ids = {mutant.id for mutant in journal.mutants()}
                assert {mutant.id for mutant in samples.MUTANTS} - ids <= plan
            use(path, number, ways)
        except Exception as error:
            error.add_note(f"{number}: {touched}")
            raise
        capsys.readouterr()


def edit(path: Path, statement: str, *values: Any) -> None:
    with closing(sqlite3.connect(path, isolation_level=None)) as connection:
        connection.text_factory = decode
        connection.execute(statement, values)


BAD = {
    "no JSON": ("UPDATE outcome SET data = '{' WHERE rowid = 1", 1),
    "deep": (f"UPDATE outcome SET data = '{'[' * 100_000}' WHERE rowid = 1", 1),
    "no text": ("UPDATE outcome SET data = CAST(x'ff' AS TEXT) WHERE rowid = 1", 1),
    "no verdict": ("UPDATE outcome SET verdict = 'fine' WHERE rowid = 1", 1),
    "another verdict": ("UPDATE outcome SET verdict = 'timeout' WHERE rowid = 1", 1),
    "huge": (f"UPDATE outcome SET data = json_set(data, '$.hits', json('1{'0' * 400}')) WHERE rowid = 1", 1),
    "not a number": ("UPDATE outcome SET data = replace(data, '\"wall\": 1.5', '\"wall\": NaN')", 1),
    "round": ("UPDATE outcome SET round = 4000000000 WHERE rowid = 1", 1),
    "rounds": ("UPDATE meta SET value = '1000000000' WHERE key = 'rounds'", 0),
    "mutant": ("UPDATE mutant SET data = '[]' WHERE rowid = 1", 2),
    "test": ('UPDATE test SET data = \'{"round": 0, "test": []}\' WHERE rowid = 1', 0),
    "fact": ("UPDATE meta SET value = '[1, 2' WHERE key = 'started'", 0),
    "key": ("UPDATE outcome SET key = x'00ff' WHERE rowid = 1", 0),
}


@pytest.mark.parametrize(("statement", "lost"), BAD.values(), ids=BAD)
def test_a_bad_row_is_named_and_the_rest_is_used(
    whole: Path, tmp_path: Path, statement: str, lost: int
) -> None:
    path = tmp_path / "journal.sqlite"
    shutil.copy(whole, path)
    edit(path, statement)
    with JournalReader.open(path) as journal:
        found = read_results(journal)
        journal.found()
        named = journal.set_aside
    assert len(named) == 1, named
    assert found.done == len(samples.OUTCOMES) - lost
    if named == list(found.set_aside):
        assert found.state == "incomplete"
        assert decide(found).exit_code == ExitCode.UNRELIABLE


@pytest.mark.parametrize("attack", ["bytes", "row", "view"])
@pytest.mark.parametrize("command", ["results", "show", "report"])
def test_commands_work_with_what_is_left(
    whole: Path, tmp_path: Path, attack: str, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / ".mutabot" / "journal.sqlite"
    path.parent.mkdir()
    shutil.copy(whole, path)
    match attack:
        case "bytes":
            with closing(sqlite3.connect(path)) as connection, connection:
                connection.execute(
                    "UPDATE outcome SET data = ? WHERE rowid = 3", (random.Random(1).randbytes(99),)
                )
        case "row":
            edit(path, "UPDATE meta SET value = '1000000000' WHERE key = 'rounds'")
        case "view":
            with closing(sqlite3.connect(path)) as connection, connection:
                connection.execute("ALTER TABLE outcome RENAME TO other")
                connection.execute(
                    "CREATE VIEW outcome AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
                    "SELECT i AS mutant, i AS round, i AS data, i AS key, i AS reused FROM n"
                )
    arguments = {"show": ["2"], "report": ["--format", "markdown"]}.get(command, [])
    code = main(["-C", str(tmp_path), command, *arguments])
    printed = capsys.readouterr()
    if attack == "view":
        assert code == ExitCode.USAGE
        assert "something else than mutabot has changed it" in printed.err or "not a journal" in printed.err
    else:
        assert code == ExitCode.FINE
        assert "gripper.command" in printed.out
