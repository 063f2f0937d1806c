"""The folder of a report: what is in it, and what of a user's it never touches."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from hatchling.builders.wheel import WheelBuilder

import mutabot
from mutabot.errors import UsageError
from mutabot.journal.files import REPORT_MARK
from mutabot.report.html import folder as folders
from mutabot.report.html.folder import check_folder
from mutabot.results.films import KeptFilm
from mutabot.results.suggested import Suggestion
from report.html import reports
from results import samples

ROOT = Path(__file__).parents[3]


def data(page: Path) -> str:
    """All data of a report."""
    return "".join(file.read_text(encoding="utf-8") for file in sorted(page.parent.rglob("*.js")))


def test_every_mutant_has_its_data_and_every_asset_that_the_page_names_is_there(tmp_path: Path) -> None:
    page = reports.plain(tmp_path)
    numbers = {int(file.stem) for file in (page.parent / "data" / "mutants").iterdir()}
    assert numbers == {mutant.number for mutant in samples.MUTANTS}
    named = re.findall(r'(?:src|href)="([^"#]+)"', page.read_text())
    assert len(named) > 10
    assert all((page.parent / name).is_file() for name in named)
    assert {f"assets/{file.name}" for file in (page.parent / "assets").iterdir()} <= set(named)


def test_nothing_in_it_names_a_folder_of_the_machine(tmp_path: Path) -> None:
    text = data(reports.plain(tmp_path, root=str(tmp_path)))
    assert str(tmp_path) not in text
    assert "/home/" not in text


def test_a_folder_with_other_files_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(UsageError, match="holds other files, such as notes"):
        check_folder(tmp_path)
    with pytest.raises(UsageError, match="it is a file"):
        check_folder(tmp_path / "notes.txt")
    assert (tmp_path / "notes.txt").read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_an_older_report_is_replaced(tmp_path: Path) -> None:
    journal, stored = reports.campaign(tmp_path)
    report = tmp_path / "report"
    reports.write(report, journal, stored)
    (report / "data" / "mutants" / "99.js").write_text("old")
    (report / "clip.mp4").write_bytes(b"mine")
    reports.write(report, journal, stored)
    assert not (report / "data" / "mutants" / "99.js").exists()
    assert (report / REPORT_MARK).is_file()
    assert (report / "clip.mp4").read_bytes() == b"mine"


def test_links_in_an_older_report_are_replaced_and_not_followed(tmp_path: Path) -> None:
    journal, stored = reports.campaign(tmp_path)
    report, mine = tmp_path / "report", tmp_path / "mine"
    reports.write(report, journal, stored)
    mine.mkdir()
    (mine / "notes.txt").write_text("mine")
    for name in ("index.html", REPORT_MARK):
        (report / name).unlink()
        (report / name).symlink_to(mine / "notes.txt")
    for name in ("data", "assets"):
        shutil.rmtree(report / name)
        (report / name).symlink_to(mine)
    reports.write(report, journal, stored)
    assert [(path.name, path.read_text()) for path in mine.iterdir()] == [("notes.txt", "mine")]
    assert not any(path.is_symlink() for path in report.rglob("*"))


def test_recordings_that_have_no_room_are_counted_and_pages_say_so(tmp_path: Path) -> None:
    journal, stored = reports.campaign(tmp_path)
    written = reports.write(tmp_path / "report", journal, stored, limit=0)
    assert written.without == 1
    assert '"recordings":[],"without":1' in (tmp_path / "report" / "data" / "mutants" / "2.js").read_text()


def test_a_check_is_suggested_where_there_is_one(tmp_path: Path) -> None:
    journal, stored = reports.campaign(tmp_path)
    (second,) = (result.mutant.id for result in stored.mutants if result.mutant.number == 2)
    found = {second: Suggestion(samples.TEST, "assert box.x < 0.5")}
    reports.write(tmp_path / "report", journal, stored, lambda made: replace(made, suggestions=found))
    assert "box.x \\u003c 0.5" in (tmp_path / "report" / "data" / "mutants" / "2.js").read_text()
    assert '"suggestion":null' in (tmp_path / "report" / "data" / "mutants" / "1.js").read_text()


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    journal, stored = reports.campaign(tmp_path)
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match="file/report cannot be written"):
        reports.write(tmp_path / "file" / "report", journal, stored)


def test_campaigns_without_mutants_and_without_recordings_have_reports(tmp_path: Path) -> None:
    journal = samples.write_journal(tmp_path / "journal.sqlite", mutants=(), outcomes=(), finish=None)
    written = reports.write(tmp_path / "report", journal, mutabot.open(journal))
    assert written.page.is_file()
    assert written.size < 1_000_000


def test_the_wheel_holds_what_shows_the_pages() -> None:
    packed = {file.distribution_path for file in WheelBuilder(str(ROOT)).recurse_included_files()}
    assets = Path(folders.__file__).parent / "assets"
    wanted = {f"mutabot/report/html/assets/{file.name}" for file in assets.iterdir()}
    assert len(wanted) > 10
    assert wanted <= packed


def test_a_film_lies_beside_the_page_and_one_that_finds_no_room_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    journal, stored = reports.campaign(tmp_path)
    film = tmp_path / "a.mp4"
    film.write_bytes(b"a film")
    films = {samples.SKIP.id: KeptFilm(film, 0, samples.TEST)}
    made = reports.write(
        tmp_path / "report", journal, stored, lambda stored_campaign: replace(stored_campaign, films=films)
    )
    name = f"data/films/{samples.SKIP.number}.mp4"
    assert (made.page.parent / name).read_bytes() == b"a film"
    assert name in data(made.page)
    monkeypatch.setattr(folders, "FILMS_LIMIT", 3)
    made = reports.write(
        tmp_path / "report", journal, stored, lambda stored_campaign: replace(stored_campaign, films=films)
    )
    assert not [*made.page.parent.rglob("*.mp4")]
    assert '"size":6' in data(made.page)
