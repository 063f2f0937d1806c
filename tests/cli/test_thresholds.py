"""``mutabot thresholds`` as a user calls it, and the end of a campaign with ladders."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from mutabot.cli.app import main
from mutabot.errors import ExitCode
from mutabot.report.terminal.campaign import print_summary
from mutabot.report.terminal.console import make_console
from mutabot.results.gate import decide
from results.thresholds import journals
from results.thresholds.journals import Rungs

LADDERS = (Rungs(["SSSSCCC"] * 5), Rungs(["SSSCCCC"] * 5, direction="-"))


@pytest.fixture
def project(tmp_path: Path) -> Path:
    journals.write(tmp_path / ".mutabot" / "journal.sqlite", *LADDERS)
    return tmp_path


def call(project: Path, *words: str) -> int:
    return main(["-C", str(project), *words])


def test_it_prints_one_row_per_ladder(
    project: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    assert call(project, "thresholds") == 0
    out = capsys.readouterr().out
    assert re.search(r"mission.py:3 arm.move_by dx \+ +10 mm +····███ +20 mm +check", out)
    assert out.index("dx +") < out.index("dx −")


def test_it_prints_json(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(project, "thresholds", "--json") == 0
    assert len(json.loads(capsys.readouterr().out)["ladders"]) == 2


def test_without_ladders_it_says_what_plants_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(tmp_path, "thresholds") == ExitCode.USAGE
    assert "there is no journal yet" in capsys.readouterr().err
    journals.write(tmp_path / ".mutabot" / "journal.sqlite", with_others=True)
    assert call(tmp_path, "thresholds") == ExitCode.USAGE
    assert "`mutabot run --family graded`" in capsys.readouterr().err


# The end of a campaign


def test_ladders_are_in_no_score_and_their_magnitudes_need_not_be_run(tmp_path: Path) -> None:
    alone = journals.results(tmp_path / "alone", with_others=True, rounds=2)
    both = journals.results(tmp_path / "both", Rungs(["SSS.C..", "..SSCC."]), with_others=True, rounds=2)
    assert both.groups == alone.groups
    assert both.all == alone.all
    assert (both.planned, both.done) == (alone.planned, alone.done)
    assert [survivor.mutant.id for survivor in both.survivors] == [
        survivor.mutant.id for survivor in alone.survivors
    ]
    assert (both.ladders, len(both.graded), len(both.everything)) == (1, 7, 12)


def test_a_campaign_of_ladders_alone_is_held_to_no_score(tmp_path: Path) -> None:
    found = journals.results(tmp_path, Rungs(["SSSSSSS"] * 2))
    assert decide(found, min_score=1.0, max_timeouts=0.0).exit_code is ExitCode.FINE


@pytest.mark.parametrize(
    ("letters", "words"), [("RRRRRRR", "the robot refused every mutant"), (".......", "no mutant was run")]
)
def test_a_campaign_of_which_nothing_is_known_is_still_a_failure(
    tmp_path: Path, letters: str, words: str
) -> None:
    decision = decide(journals.results(tmp_path, Rungs([letters])))
    assert decision.exit_code is ExitCode.NOTHING_KNOWN
    assert words in decision.lines[0]


def test_errors_of_graded_mutants_count(tmp_path: Path) -> None:
    decision = decide(journals.results(tmp_path, Rungs(["SSECCCC"])), max_errors=0.0)
    assert decision.exit_code is ExitCode.UNRELIABLE
    assert "1 of 7 outcomes are errors" in decision.lines[0]
    assert "mutants 3" in decision.lines[0]


def test_results_name_the_ladders_and_where_to_look(
    project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(project, "results") == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "2 ladders × 5 rounds: complete" in out
    assert "2 ladders of graded mutants (70 runs), in no score: `mutabot thresholds` shows them" in out
    assert "no mutant" not in out.lower()


def test_the_end_of_a_run_names_them_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    print_summary(make_console(), journals.results(tmp_path, *LADDERS, with_others=True))
    out = " ".join(capsys.readouterr().out.split())
    assert "5 mutants and 2 ladders × 5 rounds" in out
    assert "`mutabot thresholds` shows them" in out


def test_one_magnitude_is_shown_like_any_mutant(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    journals.write(tmp_path / ".mutabot" / "journal.sqlite", Rungs(["SSSCCCC"]))
    assert call(tmp_path, "show", "2") == 0
    out = capsys.readouterr().out
    assert "arm.move_by: dx +2mm" in out
    assert "mutabot suggest" not in out


@pytest.mark.parametrize("name", ["markdown", "junit", "sarif", "github", "csv", "mutation-testing"])
def test_every_format_takes_a_campaign_of_ladders_alone(
    project: Path, name: str, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    assert call(project, "report", "--format", name) == 0
    out = capfdbinary.readouterr().out
    if name == "markdown":
        assert b"noticed from 20 mm, not at 10 mm" in out
