"""The file of recordings: room is limited, and the original's goes last."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from mutabot.errors import JournalError
from mutabot.journal.recordings import ORIGINAL, Rank, Recordings, recordings_path

TEN = bytes(10)


def test_what_is_added_is_read_back(tmp_path: Path) -> None:
    journal = tmp_path / "journal.sqlite"
    assert Recordings.to_read(journal) is None
    with Recordings.to_write(journal, 100) as writer:
        assert writer.add("a", 0, "test_it", Rank.SURVIVOR, b"data")
        with Recordings.to_read(journal) or pytest.fail("it is there") as reader:
            assert reader.data("a", 0, "test_it") == b"data"
            assert reader.data("a", 1, "test_it") is None
            assert reader.tests("a", 0) == ("test_it",)


def test_lower_ranks_make_room_for_higher_ones(tmp_path: Path) -> None:
    with Recordings.to_write(tmp_path / "journal.sqlite", 30) as recordings:
        assert recordings.add("killed", 0, "t", Rank.OTHER, TEN)
        assert recordings.add("survivor", 0, "t", Rank.SURVIVOR, TEN)
        assert recordings.add(ORIGINAL, 0, "t", Rank.ORIGINAL, TEN)
        assert not recordings.add("other", 0, "t", Rank.OTHER, TEN)
        assert recordings.add("second", 0, "t", Rank.SURVIVOR, TEN)
        assert recordings.tests("killed", 0) == ()
        assert not recordings.add("third", 0, "t", Rank.SURVIVOR, TEN)
        assert recordings.tests("survivor", 0) == recordings.tests(ORIGINAL, 0) == ("t",)
        assert recordings.used == 30


def test_what_is_replaced_or_forgotten_takes_no_room(tmp_path: Path) -> None:
    with Recordings.to_write(tmp_path / "journal.sqlite", 25) as recordings:
        for _ in range(3):
            recordings.forget("a", 0)
            assert recordings.add("a", 0, "t", Rank.OTHER, TEN)
        recordings.keep_only({"b"})
        assert recordings.used == 0


def test_a_file_that_holds_something_else_is_named(tmp_path: Path) -> None:
    path = recordings_path(tmp_path / "journal.sqlite")
    path.write_text("no database, but more than a hundred bytes of something else" * 5)
    with pytest.raises(JournalError, match=path.name):
        Recordings.to_write(tmp_path / "journal.sqlite", 25)


def _link(path: Path) -> None:
    path.symlink_to(path.parent.parent / "notes.txt")


def _loop(path: Path) -> None:
    path.symlink_to(path)


def _pipe(path: Path) -> None:
    os.mkfifo(path)


def _folder(path: Path) -> None:
    (path / "below").mkdir(parents=True)


def _garbage(path: Path) -> None:
    path.write_text("no database" * 1000)


def _beside(path: Path) -> None:
    path.with_name(path.name + "-wal").symlink_to(path.parent.parent / "notes.txt")


@pytest.mark.parametrize(
    ("spoil", "what"),
    [
        (_link, "a link"),
        (_loop, "a link"),
        (_pipe, "a pipe"),
        (_folder, "a folder"),
        (_garbage, "not a database"),
        (_beside, "a link"),
    ],
)
def test_what_stands_in_its_place_is_named_and_the_next_campaign_replaces_it(
    tmp_path: Path, spoil: Callable[[Path], None], what: str
) -> None:
    notes, home = tmp_path / "notes.txt", tmp_path / ".mutabot"
    notes.write_text("mine")
    home.mkdir()
    journal = home / "journal.sqlite"
    if spoil is _beside:
        Recordings.to_write(journal, 30).close()
    spoil(recordings_path(journal))
    with pytest.raises(JournalError, match=rf"{what}.*remove it"):
        Recordings.to_read(journal)
    with Recordings.to_write(journal, 30) as recordings:
        assert recordings.removed
        assert recordings.add("a", 0, "t", Rank.OTHER, TEN)
    with Recordings.to_write(journal, 30) as recordings:
        assert (recordings.removed, recordings.used) == ("", 10)
    assert notes.read_text() == "mine"


def test_beside_a_journal_elsewhere_nothing_is_removed(tmp_path: Path) -> None:
    journal = tmp_path / "merged.sqlite"
    _link(recordings_path(journal))
    with pytest.raises(JournalError, match="remove it"):
        Recordings.to_write(journal, 30)
    assert recordings_path(journal).is_symlink()
