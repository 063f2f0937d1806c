"""The journal: what is written is kept, and what is wrong with the file is said plainly."""

from __future__ import annotations

import re
import signal
import sqlite3
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import closing, suppress
from pathlib import Path

import pytest

from mutabot.errors import JournalError
from mutabot.journal.database import SCHEMA_VERSION, connect, guarded
from mutabot.journal.files import is_written, previous_of
from mutabot.journal.journal import Journal
from mutabot.journal.records import BaselineTest, ControlEnd, Kept
from mutabot.model import By, Outcome, Verdict
from mutabot.model.events import TestEnd
from results import samples

KILLED = Outcome("m", 0, Verdict.KILLED, By.CHECK, test="t", example=(1, -1), divergence=("a", "b"))


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / ".mutabot" / "journal.sqlite"


def test_everything_that_is_written_is_read_back_equal(path: Path) -> None:
    samples.write_journal(path)
    with Journal.open(path) as journal:
        assert tuple(journal.mutants()) == samples.MUTANTS
        assert tuple(journal.left_out()) == samples.LEFT_OUT
        assert tuple(journal.outcomes()) == samples.OUTCOMES
        assert journal.vocabulary == samples.VOCABULARY
        assert journal.meta()["seed"] == 7
        assert journal.finished == "complete"
        assert journal.source("mission.py") == samples.PROGRAM
        assert journal.source("other.py") is None
        assert [(test.round, test.test.test) for test in journal.tests()] == [
            (0, samples.TEST),
            (1, samples.TEST),
        ]
        assert {(control.control, control.ok) for control in journal.controls()} == {
            ("identity", True),
            ("fatal", True),
        }


def test_the_last_outcome_of_a_mutant_in_a_round_wins(path: Path) -> None:
    survived = Outcome("m", 0, Verdict.SURVIVED)
    other_round = Outcome("m", 1, Verdict.TIMEOUT)
    with Journal.create(path, meta={}) as journal:
        for outcome in (KILLED, other_round, survived):
            journal.add_outcome(outcome)
        assert journal.outcomes() == [other_round, survived]


def test_a_new_plan_replaces_the_old_one(path: Path) -> None:
    with Journal.create(path, meta={}) as journal:
        journal.set_plan(samples.MUTANTS, samples.LEFT_OUT, sources={"a.py": "1"})
        journal.set_plan(samples.MUTANTS[:1], ())
        assert tuple(journal.mutants()) == samples.MUTANTS[:1]
        assert journal.left_out() == []
        assert journal.source("a.py") is None


def test_a_plan_that_fails_halfway_leaves_the_old_one(path: Path) -> None:
    with Journal.create(path, meta={}) as journal:
        journal.set_plan(samples.MUTANTS, ())
        with pytest.raises(JournalError):  # the same id twice
            journal.set_plan((samples.REVERSE, samples.REVERSE), ())
        assert tuple(journal.mutants()) == samples.MUTANTS


def test_a_campaign_says_of_itself_what_it_was_and_how_it_ended(path: Path) -> None:
    with Journal.create(path, meta={"seed": 2}) as journal:
        assert journal.finished is None
        journal.set_meta("seed", 3)
        journal.finish("interrupted")
        assert journal.finished == "interrupted"
    with Journal.open(path) as journal:
        assert journal.finished == "interrupted"
        assert journal.meta() == {"seed": 3}


def test_a_new_campaign_keeps_the_journal_of_the_last_complete_one(path: Path) -> None:
    for seed, end in ((1, "complete"), (2, "complete"), (3, "interrupted"), (4, "interrupted")):
        with Journal.create(path, meta={"seed": seed}) as journal:
            journal.add_outcome(KILLED)
            journal.finish(end)
    assert {file.name for file in path.parent.iterdir()} == {
        path.name,
        f"{path.name}.lock",
        previous_of(path).name,
    }
    with Journal.open(path) as journal, Journal.open(previous_of(path)) as previous:
        assert (journal.meta()["seed"], previous.meta()["seed"]) == (4, 2)
        assert previous.outcomes() == [KILLED]


def begin(path: Path, *outcomes: Outcome, key: str = "a b c") -> None:
    """A campaign that finds these outcomes and is then lost."""
    with Journal.create(path, meta={}) as journal:
        for outcome in outcomes:
            journal.add_outcome(outcome, key=key)


def test_outcomes_are_kept_aside_with_their_keys_until_a_later_one_takes_their_place(path: Path) -> None:
    begin(path, KILLED, Outcome("m", 1, Verdict.SURVIVED), Outcome("n", 0, Verdict.ERROR))
    begin(path)
    begin(path, Outcome("m", 1, Verdict.KILLED), key="d e f")
    with Journal.create(path, meta={}) as journal:
        assert journal.outcomes() == []
        assert journal.kept() == {
            ("m", 0): Kept("m", 0, Verdict.KILLED, "a b c"),
            ("m", 1): Kept("m", 1, Verdict.KILLED, "d e f"),
            ("n", 0): Kept("n", 0, Verdict.ERROR, "a b c", is_sound=False),
        }
        journal.take_over([journal.row("m", 0)])
        journal.add_outcome(Outcome("m", 1, Verdict.SURVIVED))
        assert journal.outcomes() == [KILLED, Outcome("m", 1, Verdict.SURVIVED)]
        assert journal.reused() == {("m", 0)}


@pytest.mark.parametrize(
    "outcome",
    [
        Outcome("m", 0, Verdict.ERROR),
        Outcome("m", 0, Verdict.UNSTABLE),
        Outcome("m", 0, Verdict.KILLED, message="OSError: [Errno 28] No space left on device: 'x'"),
    ],
)
def test_an_outcome_that_shows_the_state_of_the_machine_is_not_sound(path: Path, outcome: Outcome) -> None:
    begin(path, outcome)
    with Journal.create(path, meta={}) as journal:
        assert not journal.kept()["m", 0].is_sound


def test_outcomes_without_a_key_keep_nothing(path: Path) -> None:
    begin(path, KILLED, key="")
    with Journal.create(path, meta={}) as journal:
        assert journal.kept() == {}


def test_a_campaign_can_give_up_the_keys_of_what_it_found_itself(path: Path) -> None:
    begin(path, KILLED)
    with Journal.create(path, meta={}) as journal:
        journal.take_over([journal.row("m", 0)])
        journal.add_outcome(Outcome("m", 1, Verdict.SURVIVED), key="d e f")
        journal.forget_keys()
    with Journal.create(path, meta={}) as journal:
        assert set(journal.kept()) == {("m", 0)}


def test_what_nothing_refers_to_is_tidied_away(path: Path) -> None:
    begin(path, KILLED, Outcome("gone", 0, Verdict.SURVIVED))
    with Journal.create(path, meta={}) as journal:
        journal.add_parts({"a": {"x.py": "#1"}, "z": {}})
        assert journal.parts("a") == {"x.py": "#1"}
        journal.tidy(["m"])
        assert set(journal.kept()) == {("m", 0)}
        assert (journal.parts("a"), journal.parts("z")) == ({"x.py": "#1"}, None)


def test_a_campaign_that_cannot_begin_leaves_the_one_before_as_it_was(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin(path, KILLED)

    def full(self: Journal, key: str, value: object) -> None:
        with guarded(path):
            raise sqlite3.OperationalError("database or disk is full")

    with monkeypatch.context() as patch:
        patch.setattr(Journal, "set_meta", full)
        with pytest.raises(JournalError, match="disk is full"):
            Journal.create(path, meta={"seed": 2})
    with Journal.open(path) as journal:
        assert journal.outcomes() == [KILLED]


def test_a_journal_of_a_campaign_killed_before_it_began_is_no_obstacle(path: Path) -> None:
    begin(path)
    with Journal.create(path, meta={"seed": 1}) as journal:
        journal.finish("complete")
    begin(path)
    path.unlink()
    connect(path).close()
    with Journal.create(path, meta={}) as journal, Journal.open(previous_of(path)) as previous:
        assert journal.outcomes() == []
        assert previous.meta() == {"seed": 1}


@pytest.mark.parametrize("content", ["version", "garbage"])
def test_what_is_no_journal_of_this_version_is_moved_aside(path: Path, content: str) -> None:
    begin(path, KILLED)
    if content == "version":
        with closing(sqlite3.connect(path)) as connection, connection:
            connection.execute("PRAGMA user_version = 1")
    else:
        path.write_bytes(path.read_bytes()[:4096] + b"?" * 8192)
    before = path.read_bytes()
    with Journal.create(path, meta={}) as journal:
        assert journal.kept() == {}
        moved = path.with_name("journal.version-1.sqlite") if content == "version" else previous_of(path)
        assert journal.moved == moved
    assert moved.read_bytes() == before


def test_readers_see_each_outcome_at_once_while_the_writer_is_active(path: Path) -> None:
    def found() -> int:
        with Journal.open(path) as reader:
            return len(reader.outcomes())

    with Journal.create(path, meta={}) as writer:
        assert is_written(path)
        for round in range(3):
            writer.add_outcome(Outcome("m", round, Verdict.SURVIVED))
            assert found() == round + 1
    assert not is_written(path)


def test_texts_that_are_no_utf_8_are_stored_and_found_again(path: Path) -> None:
    with Journal.create(path, meta={"root": "/tmp/\udcff"}) as journal:
        journal.add_outcome(
            Outcome("mission\udcff.py", 0, Verdict.KILLED, test="t\udcff", example=(1, "\udcfe"))
        )
        journal.add_control(ControlEnd("tests/t\udcff.py", "identity", ok=True, detail="\udcff"))
        journal.add_tests([BaselineTest(0, 0, TestEnd("t\udcff", "passed"))])
        journal.set_plan([], [], sources={"mission\udcff.py": "x = '\udcff'"})
    with Journal.open(path) as reader:
        assert [outcome.mutant for outcome in reader.outcomes()] == ["mission\\udcff.py"]
        assert reader.outcomes()[0].example == (1, "\\udcfe")
        assert reader.source("mission\udcff.py") == "x = '\\udcff'"
        assert reader.tests()[0].test.test == "t\\udcff"
        assert reader.meta()["root"] == "/tmp/\\udcff"


def test_a_journal_in_a_folder_whose_name_is_no_utf_8_is_written_read_and_succeeded(tmp_path: Path) -> None:
    path = tmp_path / "a\udcff b" / "journal.sqlite"
    for seed in (1, 2):
        with Journal.create(path, meta={"seed": seed}) as journal:
            journal.add_outcome(KILLED)
            journal.finish("complete")
    with Journal.open(path) as reader, Journal.open(previous_of(path)) as before:
        assert (reader.meta()["seed"], before.meta()["seed"]) == (2, 1)


def test_a_journal_that_is_closed_has_written_all(path: Path) -> None:
    with suppress(KeyboardInterrupt), Journal.create(path, meta={}) as writer:
        for round in range(50):
            writer.add_outcome(Outcome("m", round, Verdict.SURVIVED))
        raise KeyboardInterrupt
    with Journal.open(path) as reader:
        assert len(reader.outcomes()) == 50


def test_a_second_writer_is_refused(path: Path) -> None:
    with Journal.create(path, meta={"seed": 1}) as first:
        with pytest.raises(JournalError, match="another `mutabot run`"):
            Journal.create(path, meta={})
        assert first.meta() == {"seed": 1}


WRITER = """
import sys
import time
from pathlib import Path
from typing import Any
from mutabot.journal.journal import Journal
from mutabot.model import Outcome, Verdict
journal = Journal.create(Path(sys.argv[1]), meta={"rounds": 100000})
for round in range(100000):
    journal.add_outcome(Outcome("m", round, Verdict.SURVIVED))
    print(round, time.monotonic(), flush=True)
    time.sleep(0.001)
"""


def test_a_writer_ended_by_sigkill_loses_nothing(path: Path) -> None:
    writer = subprocess.Popen([sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE, text=True)
    assert writer.stdout is not None
    with writer, writer.stdout:
        reported = [writer.stdout.readline().split()]
        while float(reported[-1][1]) < float(reported[0][1]) + 3.0:
            reported.append(writer.stdout.readline().split())
        writer.send_signal(signal.SIGKILL)
        reported += [line.split() for line in writer.stdout.read().split("\n")[:-1]]
    with Journal.open(path) as journal:
        found = {outcome.round for outcome in journal.outcomes()}
        assert len(found) > 1
        assert found >= {int(round) for round, _ in reported}
        assert found == set(range(len(found)))
        assert journal.finished is None
    with Journal.create(path, meta={}) as journal:  # and its lock went with it
        journal.finish("interrupted")


def test_a_full_disk_is_a_clear_error_and_keeps_what_was_there(path: Path) -> None:
    with Journal.create(path, meta={}) as journal:
        journal.add_outcome(KILLED)
        journal._file.execute("PRAGMA max_page_count = 1")
        big = Outcome("n", 0, Verdict.ERROR, message="x" * 1_000_000)
        with pytest.raises(JournalError, match="disk is full") as error:
            journal.add_outcome(big)
        assert str(path) in str(error.value)
        with pytest.raises(JournalError, match="disk is full"):
            journal.set_plan(samples.MUTANTS, (), sources={"a.py": "x" * 1_000_000})
        assert journal.mutants() == []
    with Journal.open(path) as journal:
        assert journal.outcomes() == [KILLED]


def test_a_missing_journal_names_the_command_that_writes_it(path: Path) -> None:
    with pytest.raises(JournalError, match=re.escape(str(path)) + ".*mutabot run"):
        Journal.open(path)


def test_a_campaign_killed_before_it_began_has_no_journal_yet(path: Path) -> None:
    path.parent.mkdir()
    path.write_bytes(b"")
    with pytest.raises(JournalError, match="there is no journal yet; `mutabot run` writes it"):
        Journal.open(path)


def test_a_file_that_is_no_database_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "journal.sqlite"
    path.write_text("these are no tables, and long enough for a header of one hundred bytes " * 3)
    with pytest.raises(JournalError, match="not a journal of mutabot"):
        Journal.open(path)


def test_a_foreign_file_is_not_replaced_by_a_new_journal(tmp_path: Path) -> None:
    path = tmp_path / "journal.sqlite"
    path.write_text("somebody's notes")
    with pytest.raises(JournalError, match="in the way"):
        Journal.create(path, meta={})
    assert path.read_text() == "somebody's notes"


def test_a_database_of_somebody_else_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "journal.sqlite"
    connection = sqlite3.connect(path)
    connection.execute("CREATE TABLE music (title TEXT)")
    connection.close()
    with pytest.raises(JournalError, match="a database, but not a journal"):
        Journal.open(path)


def test_a_journal_of_another_schema_version_is_refused(path: Path) -> None:
    samples.write_journal(path)
    connection = sqlite3.connect(path)
    with connection:
        connection.execute("PRAGMA user_version = 99")
    connection.close()
    with pytest.raises(JournalError, match=f"version 99, this one reads {SCHEMA_VERSION}"):
        Journal.open(path)


def test_a_folder_that_cannot_be_made_is_a_clear_error() -> None:
    with pytest.raises(JournalError, match="/proc/mutabot"):
        Journal.create(Path("/proc/mutabot/journal.sqlite"), meta={})


@pytest.fixture
def readable_by_all() -> Iterator[Path]:
    """A folder that another user can enter, outside of pytest's own, which only we can."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        yield Path(folder)


ATTEMPT = """
import os, sys
from pathlib import Path
from typing import Any
from mutabot.journal.journal import Journal
from mutabot.errors import JournalError
path = Path(sys.argv[1])
if os.geteuid() == 0:  # root may write everywhere
    os.setuid(65534)
with Journal.open(path) as journal:
    print(len(journal.outcomes()))
try:
    Journal.create(path, meta={})
except JournalError as error:
    print(error)
"""


@pytest.mark.parametrize("killed", [False, True])
def test_a_read_only_folder_can_be_read_and_says_so_when_written(readable_by_all: Path, killed: bool) -> None:
    path = readable_by_all / "journal.sqlite"
    journal = Journal.create(path, meta={})
    journal.add_outcome(KILLED)
    kept = {entry.name: entry.read_bytes() for entry in readable_by_all.iterdir()}
    journal.close()
    if killed:  # as a writer leaves it that has no time to tidy up
        for name, content in kept.items():
            (readable_by_all / name).write_bytes(content)
    for file in readable_by_all.iterdir():
        file.chmod(0o444)
    readable_by_all.chmod(0o555)
    done = subprocess.run(
        [sys.executable, "-c", ATTEMPT, str(path)], capture_output=True, text=True, check=False
    )
    readable_by_all.chmod(0o755)
    lines = done.stdout.splitlines()
    assert done.returncode == 0, done.stderr
    assert lines[0] == "1"
    assert len(lines) == 2
    assert str(path) in lines[1]
    assert "Permission denied" in lines[1]
