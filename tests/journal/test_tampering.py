"""A journal that something else than Mutabot writes to: what is known is written again, or not believed."""

from __future__ import annotations

import json
import os
import shutil
import sqlite3
import stat
from collections.abc import Callable
from contextlib import closing, suppress
from pathlib import Path

import pytest

from mutabot.errors import JournalError
from mutabot.journal.files import is_written
from mutabot.journal.journal import Journal
from mutabot.journal.reader import JournalReader
from mutabot.journal.recordings import Rank, Recordings
from mutabot.model import By, Outcome, Verdict
from results import samples

KILLED = Outcome("m", 0, Verdict.KILLED, By.CHECK, test="t")
SURVIVED = Outcome("m", 1, Verdict.SURVIVED)
LATER = Outcome("n", 0, Verdict.SURVIVED)
#: what a program under test may write into the file
FORGED = json.dumps({"mutant": "m", "round": 1, "verdict": "killed", "by": "check"})


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / ".mutabot" / "journal.sqlite"


def sql(*statements: str) -> Callable[[Path], None]:
    def attack(path: Path) -> None:
        with closing(sqlite3.connect(path)) as connection, connection:
            for statement in statements:
                connection.execute(statement)

    return attack


def remove_folder(path: Path) -> None:
    shutil.rmtree(path.parent)


def replace_by_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()
    (path / "file").write_text("x")


def replace_by_other(path: Path) -> None:
    with closing(sqlite3.connect(path.with_name("other"))) as connection, connection:
        connection.execute("CREATE TABLE music (title TEXT)")
    path.with_name("other").replace(path)


def replace_by_link(path: Path) -> None:
    path.unlink()
    (path.parent.parent / "precious").write_text("precious")
    path.symlink_to(path.parent.parent / "precious")


def overwrite(path: Path) -> None:
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("PRAGMA wal_checkpoint(PASSIVE)")  # else all that counts is in another file
    with path.open("r+b") as file:
        file.write(b"?" * 8192)


def empty(path: Path) -> None:
    path.write_bytes(b"")


CHANGES = {
    "changed": sql(f"UPDATE outcome SET verdict = 'killed', data = '{FORGED}' WHERE round = 1"),
    "removed": sql("DELETE FROM outcome WHERE round = 1"),
    "added": sql(f"INSERT INTO outcome VALUES ('n', 0, 'killed', '{FORGED}', 'a', 0)"),
    "plan": sql("DELETE FROM mutant", "DELETE FROM meta"),
    "trigger": sql("CREATE TRIGGER t AFTER INSERT ON outcome BEGIN DELETE FROM outcome; END"),
    "view": sql("DROP TABLE meta", "CREATE VIEW meta AS SELECT 'rounds' AS key, '1000000000' AS value"),
    "no tables": sql("DROP TABLE outcome"),
    "garbage": overwrite,
    "empty": empty,
}
LOSSES = {
    "folder": remove_folder,
    "file": Path.unlink,
    "replaced": replace_by_other,
    "a folder": replace_by_folder,
    "a link": replace_by_link,
}


@pytest.mark.parametrize("attack", CHANGES.values(), ids=CHANGES)
@pytest.mark.parametrize("at_once", [True, False])
def test_what_others_change_while_a_campaign_runs_is_written_again_and_named(
    path: Path, attack: Callable[[Path], None], at_once: bool
) -> None:
    with Journal.create(path, meta={"rounds": 2}) as journal:
        journal.set_plan(samples.MUTANTS, ())
        journal.add_outcome(KILLED)
        journal.add_outcome(SURVIVED)
        journal.outcomes()  # all is in the file
        attack(path)
        if at_once:
            journal.add_outcome(LATER)
            assert journal.outcomes() == [KILLED, SURVIVED, LATER]
        journal.finish("complete")
        assert journal.altered
    with JournalReader.open(path) as reader:
        assert reader.outcomes() == [KILLED, SURVIVED, *([LATER] if at_once else [])]
        assert tuple(reader.mutants()) == samples.MUTANTS
        assert reader.finished == "complete"
        assert reader.meta()["rounds"] == 2
        assert list(reader.meta()["altered"]) == journal.altered
        assert not reader.set_aside


def test_what_was_changed_is_named(path: Path) -> None:
    with Journal.create(path, meta={}) as journal:
        journal.add_outcome(SURVIVED)
        journal.outcomes()
        CHANGES["changed"](path)
        journal.finish("complete")
        assert journal.altered == ["outcome m in round 2 was changed"]


@pytest.mark.parametrize("attack", LOSSES.values(), ids=LOSSES)
def test_a_journal_that_is_deleted_or_replaced_is_written_again(
    path: Path, attack: Callable[[Path], None]
) -> None:
    with Journal.create(path, meta={}) as journal:
        journal.add_outcome(KILLED)
        journal.outcomes()
        attack(path)
        journal.add_outcome(SURVIVED)
        journal.outcomes()
        assert is_written(path)
        with pytest.raises(JournalError, match="being written by another"):
            Journal.create(path, meta={})
        attack(path)
        journal.finish("complete")
        assert (len(journal.lost), journal.altered) == (2, [])
    with JournalReader.open(path) as reader:
        assert reader.outcomes() == [KILLED, SURVIVED]
        assert reader.finished == "complete"
    if attack is replace_by_link:
        assert (path.parent.parent / "precious").read_text() == "precious"


def test_a_journal_that_another_program_holds_locked_is_written_nevertheless(path: Path) -> None:
    with Journal.create(path, meta={}) as journal:
        journal.add_outcome(KILLED)
        with closing(sqlite3.connect(path)) as other:
            other.execute("BEGIN IMMEDIATE")
            journal.add_outcome(SURVIVED)
            assert journal.outcomes() == [KILLED, SURVIVED]
            with JournalReader.open(path) as reader:
                assert reader.outcomes() == [KILLED, SURVIVED]
        journal.finish("complete")
    with JournalReader.open(path) as reader:
        assert reader.outcomes() == [KILLED, SURVIVED]


#: what a program under test can do to any file that it finds
DEEDS: dict[str, Callable[[Path], object]] = {
    "emptied": lambda file: os.truncate(file, 0),
    "shortened": lambda file: os.truncate(file, 100),
    "huge": lambda file: os.truncate(file, 1 << 40),
    "deleted": Path.unlink,
    "moved": lambda file: file.rename(file.with_name("elsewhere")),
    "closed": lambda file: file.chmod(0),
    "a pipe": lambda file: (file.unlink(), os.mkfifo(file)),
    "a folder": lambda file: (file.unlink(), file.mkdir(), (file / "more").touch()),
    "a link": lambda file: (file.unlink(), file.symlink_to("/dev/zero")),
    "a socket": lambda file: (file.unlink(), os.mknod(file, 0o600 | stat.S_IFSOCK)),
}


@pytest.mark.parametrize("deed", DEEDS.values(), ids=DEEDS)
@pytest.mark.parametrize("suffix", ["", "-wal", ".lock", None])
def test_whatever_becomes_of_its_files_ends_no_campaign_and_costs_no_outcome(
    path: Path, deed: Callable[[Path], object], suffix: str | None
) -> None:
    with Journal.create(path, meta={}) as journal:
        journal.add_outcome(KILLED)
        files = sorted(path.parent.iterdir())
        for file in files if suffix is None else [path.with_name(path.name + suffix)]:
            deed(file)
        with suppress(JournalError), JournalReader.open(path) as reader:
            assert reader.outcomes() in ([], [KILLED])
        is_written(path)
        journal.add_outcome(SURVIVED)
        assert is_written(path)
        with JournalReader.open(path) as reader:
            assert reader.outcomes() == [KILLED, SURVIVED]
        for file in files:
            if file.is_file():
                deed(file)
        journal.finish("complete")
        assert is_written(path)
    with JournalReader.open(path) as reader:
        assert reader.outcomes() == [KILLED, SURVIVED]
        assert reader.finished == "complete"


def test_no_file_of_a_journal_is_mapped_into_memory(path: Path) -> None:
    with Journal.create(path, meta={}) as journal, Recordings.to_write(path, 1 << 20) as recordings:
        journal.add_outcome(KILLED)
        recordings.add("m", 0, "t", Rank.OTHER, b"data")
        with JournalReader.open(path) as reader:
            assert reader.outcomes() == [KILLED]
        mapped = Path("/proc/self/maps").read_text("utf-8")
        assert str(path.parent) not in mapped
        assert sorted(file.name for file in path.parent.iterdir() if "-shm" in file.name) == []


def test_readers_change_nothing(path: Path) -> None:
    with Journal.create(path, meta={}) as journal:
        for round in range(20):
            journal.add_outcome(Outcome("m", round, Verdict.SURVIVED))
            with JournalReader.open(path) as reader:
                reader.outcomes()
            with closing(sqlite3.connect(path)) as other:
                other.execute("PRAGMA wal_checkpoint(PASSIVE)")
        journal.finish("complete")
        assert (journal.lost, journal.altered) == ([], [])


def test_a_process_that_is_killed_leaves_rows_that_are_believed(path: Path) -> None:
    pid = os.fork()
    if not pid:
        try:
            journal = Journal.create(path, meta={})
            for round in range(100):
                journal.add_outcome(Outcome("m", round, Verdict.SURVIVED))
            journal.outcomes()
        finally:
            os._exit(0)
    os.waitpid(pid, 0)
    with JournalReader.open(path) as reader:
        assert (len(reader.outcomes()), reader.set_aside) == (100, [])
