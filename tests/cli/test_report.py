"""``mutabot report``: where formats go, what is refused, and that nothing but the journal is read."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.cli.app import main
from mutabot.report.format import names
from results import samples

JOURNAL = Path(".mutabot", "journal.sqlite")


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project with the results of a campaign, and nothing else."""
    samples.write_journal(tmp_path / JOURNAL)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_help_names_every_format(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", "--help"]) == 0
    text = "".join(capsys.readouterr().out.split())  # which is broken into lines at hyphens, too
    assert all(name in text for name in names())


@pytest.mark.parametrize("name", names())
def test_a_format_goes_to_standard_output_and_the_same_to_a_file(
    name: str, project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", "--format", name]) == 0
    out, err = capsys.readouterr()
    assert (out[-1:], err) == ("\n", "")
    assert main(["report", "--format", name, "--output", "report.txt"]) == 0
    assert (project / "report.txt").read_bytes().decode() == out
    assert capsys.readouterr() == ("", "")


def test_several_formats_go_to_their_files(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = "--format sarif -o a.sarif --format junit -o - --format csv -o c.csv"
    assert main(["report", *words.split()]) == 0
    assert json.loads((project / "a.sarif").read_text())["version"] == "2.1.0"
    assert capsys.readouterr().out.startswith("<?xml")
    assert (project / "c.csv").read_text().startswith("mutant,number,")


def test_pages_go_to_a_folder_that_is_named_and_may_be_written_again(
    project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for _ in range(2):
        assert main(["report", "--html", "pages", "--format", "csv", "-o", "a.csv"]) == 0
        out, err = capsys.readouterr()
        assert out == ""
        assert err.startswith("mutabot: open pages/index.html in a browser (0.")
        assert (project / "pages" / "index.html").is_file()
        assert (project / "a.csv").is_file()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("--html .", "the folder holds other files, such as .mutabot"),
        ("--html .mutabot/journal.sqlite", "it is a file; --html takes a folder"),
        ("", "say which --format to write: csv, github"),
        ("--format sarf", "unknown format 'sarf'; did you mean 'sarif'?"),
        ("--format sarif --format junit", "2 formats and 0 files"),
        ("--format sarif --format junit -o a", "2 formats and 1 files"),
        ("--format sarif -o a -o b", "1 formats and 2 files"),
        ("-o a", "0 formats and 1 files"),
        ("--format sarif -o nowhere/a", "there is no folder nowhere"),
        ("--format sarif -o .mutabot", "it is a folder"),
        ("--format csv --prefix /abs", "must be a folder inside the repository"),
        ("--format csv --prefix ../up", "must be a folder inside the repository"),
    ],
)
def test_what_cannot_be_done_is_2_and_says_what_can(
    words: str, told: str, project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", *words.split()]) == 2
    out, err = capsys.readouterr()
    assert told in err
    assert out == ""
    written = [file for file in project.iterdir() if not file.name.startswith(".mutabot")]
    assert written == []


def test_without_a_journal_it_is_2_and_names_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["-C", str(tmp_path), "report", "--format", "csv"]) == 2
    assert "mutabot run" in capsys.readouterr().err


def test_a_report_of_an_interrupted_campaign_names_how_many_outcomes_are_known(
    project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (project / JOURNAL).unlink()
    samples.write_journal(project / JOURNAL, outcomes=samples.OUTCOMES[:3], finish="interrupted")
    assert main(["report", "--format", "csv"]) == 0
    out, err = capsys.readouterr()
    assert len(out.splitlines()) > 3
    assert err == "mutabot: the campaign is not complete (interrupted): 3 of 10 outcomes are known\n"


def test_the_folder_in_the_repository_stands_before_files(
    project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", "--format", "github", "--prefix", "./cells/one/"]) == 0
    assert "file=cells/one/mission.py,line=2" in capsys.readouterr().out


@pytest.mark.parametrize("encoding", ["ascii", "utf-8"])
def test_a_report_is_utf_8_whatever_the_terminal_is(project: Path, encoding: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "mutabot", "report", "--format", "junit"],
        capture_output=True, check=True, env={**os.environ, "PYTHONIOENCODING": encoding},
    )  # fmt: skip
    assert "→" in done.stdout.decode()


def test_a_reader_that_leaves_early_is_no_error(project: Path) -> None:
    pipe = f"{sys.executable} -m mutabot report --format csv | head -1; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", pipe], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
