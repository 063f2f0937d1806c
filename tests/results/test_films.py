"""Films beside a journal belong to its last campaign."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.errors import UsageError
from mutabot.results.films import KeptFilm, keep_film, kept_films

META = {"started": 5.0}


@pytest.fixture
def journal(tmp_path: Path) -> Path:
    return tmp_path / "journal.sqlite"


def film(folder: Path, text: str) -> KeptFilm:
    file = folder / "film.mp4"
    file.write_text(text)
    return KeptFilm(file, 1, "test_a.py::test_it")


def test_films_are_kept_by_mutant_and_a_later_one_takes_the_place_of_an_earlier(
    journal: Path, tmp_path: Path
) -> None:
    for mutant, text in (("a:1#../x", "first"), ("b", "other"), ("a:1#../x", "second")):
        keep_film(journal, META, mutant, film(tmp_path, text))
    found = kept_films(journal, META)
    assert {mutant: value.file.read_text() for mutant, value in found.items()} == {
        "a:1#../x": "second", "b": "other",
    }  # fmt: skip
    assert {(kept_film.round, kept_film.test) for kept_film in found.values()} == {(1, "test_a.py::test_it")}
    assert {kept_film.file.parent.parent for kept_film in found.values()} == {tmp_path}


def test_films_of_an_earlier_campaign_are_not_shown_and_go_with_the_next_film(
    journal: Path, tmp_path: Path
) -> None:
    keep_film(journal, META, "a", film(tmp_path, "old"))
    later = {"started": 6.0}
    assert kept_films(journal, later) == {}
    keep_film(journal, later, "b", film(tmp_path, "new"))
    assert [*kept_films(journal, later)] == ["b"]
    assert len([*tmp_path.glob("*/*.mp4")]) == 1


@pytest.mark.parametrize("text", ["", "[]", '{"started": 5.0, "films": {"a": 3}}'])
def test_a_list_that_cannot_be_read_names_no_film(journal: Path, tmp_path: Path, text: str) -> None:
    keep_film(journal, META, "a", film(tmp_path, "old"))
    next(tmp_path.glob("*/films.json")).write_text(text)
    assert kept_films(journal, META) == {}


def test_a_link_is_no_film(journal: Path, tmp_path: Path) -> None:
    keep_film(journal, META, "a", film(tmp_path, "old"))
    kept = kept_films(journal, META)["a"].file
    kept.unlink()
    kept.symlink_to(tmp_path / "film.mp4")
    assert kept_films(journal, META) == {}


def test_a_film_that_cannot_be_kept_says_where(journal: Path, tmp_path: Path) -> None:
    (tmp_path / "film.mp4").unlink(missing_ok=True)
    with pytest.raises(UsageError, match=r"cannot be kept in .*journal-films: No such file"):
        keep_film(journal, META, "a", KeptFilm(tmp_path / "film.mp4", 0, "test"))
