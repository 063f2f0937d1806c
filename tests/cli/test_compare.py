"""``mutabot compare``: what it runs, where it writes, and what it prints."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from analysis import campaigns, samples
from mutabot.campaign import run as campaign
from mutabot.campaign.request import Request
from mutabot.cli.app import main
from mutabot.model import Outcome, Verdict


class Campaigns:
    """Takes the place of the campaign: notes what it is asked, and writes a made-up journal."""

    def __init__(self) -> None:
        self.requests: list[Request] = []
        self.error: BaseException | None = None
        self.facts: dict[str, Any] = {}

    def run(self, request: Request, progress: Any) -> Path:
        self.requests.append(request)
        if self.error is not None:
            raise self.error
        return campaigns.write(
            request.journal_path, luck=len(self.requests), no_oracle=request.no_oracle, **self.facts
        )


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "mission.py").write_text(samples.PROGRAM)
    (tmp_path / "chosen.txt").write_text("")
    (tmp_path / "tests").mkdir()
    (tmp_path / "mutabot.toml").write_text(
        'program = ["mission.py"]\nvocabulary = ["robot.toml"]\nseed = 7\nselection = "chosen.txt"\n'
        "error_limit = 1\n"
    )
    (tmp_path / "robot.toml").write_text('[[operation]]\ncall = "robot:Arm.home"\n')
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def fake(project: Path, monkeypatch: pytest.MonkeyPatch) -> Campaigns:
    fake = Campaigns()
    monkeypatch.setattr(campaign, "run_campaign", fake.run)
    return fake


def test_all_families_run_against_every_test_into_a_journal_of_their_own(
    fake: Campaigns, project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare"]) == 0
    (request,) = fake.requests
    assert request.families == ("robot", "catalogue", "middleware", "classical", "text")
    assert (request.every_test, request.no_oracle) == (True, False)
    assert request.journal_path == project / ".mutabot" / "compare.sqlite"
    out = capsys.readouterr().out
    assert "Families side by side, 222 mutants × 3 rounds: complete" in out
    assert "without an oracle" not in out


def test_without_an_oracle_the_same_runs_once_more_elsewhere(
    fake: Campaigns, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", "--no-oracle", "--sample", "50%"]) == 0
    first, second = fake.requests
    assert (first.no_oracle, second.no_oracle) == (False, True)
    assert (first.every_test, second.every_test) == (True, False)
    assert second.journal_path.name == "compare-no-oracle.sqlite"
    same = ("families", "sample", "rounds", "seed", "engine", "only", "skip", "selection")
    assert [getattr(first, name) for name in same] == [getattr(second, name) for name in same]
    assert "without an oracle" in capsys.readouterr().out


def test_options_reach_the_campaign(fake: Campaigns, project: Path) -> None:
    words = "--family text --family robot --family text --rounds 5 --seed 3 -j 1 --engine replay --fresh"
    assert main(["compare", *words.split(), "--one-per-site", "--only", "AOR", "--skip", "3"]) == 0
    (request,) = fake.requests
    assert request.families == ("robot", "text")
    assert (request.rounds, request.seed, request.jobs) == (5, 3, 1)
    assert (request.engine, request.fresh, request.one_per_site) == ("replay", True, True)
    assert (request.only, request.skip) == (("AOR",), ("3",))


def test_the_configured_selection_names_mutants_of_one_family_and_is_ignored(
    fake: Campaigns, project: Path
) -> None:
    assert main(["compare"]) == 0
    assert main(["compare", "--selection", "chosen.txt"]) == 0
    assert main(["run", "--selection", "chosen.txt"]) == 0
    assert [one.selection for one in fake.requests] == [None, Path("chosen.txt"), Path("chosen.txt")]


def test_a_run_has_the_robot_family_alone_and_the_usual_journal(fake: Campaigns) -> None:
    main(["run"])
    (request,) = fake.requests
    assert (request.families, request.every_test, request.no_oracle) == (("robot",), False, False)
    assert request.journal_path.name == "journal.sqlite"


@pytest.mark.parametrize(
    "arguments",
    [
        ["--family", "robots"],
        ["--family", "robot,all"],
        ["--sample", "0"],
        ["--sample", "abc"],
        ["--picture", "ends.jpg"],
        ["--picture", "nowhere/ends.svg"],
        ["--engine", "warp"],
        ["--rounds", "0"],
        ["--selection", "nowhere.txt"],
        ["--nonsense"],
    ],
)
def test_a_wrong_command_line_is_2_before_anything_runs(
    fake: Campaigns, project: Path, arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", *arguments]) == 2
    err = capsys.readouterr().err
    assert err.strip()
    assert "Traceback" not in err
    assert fake.requests == []
    assert not (project / ".mutabot").exists()


def test_an_unknown_family_names_the_nearest(fake: Campaigns, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", "--family", "clasical"]) == 2
    assert "did you mean 'classical'" in capsys.readouterr().err


def test_results_shows_the_last_comparison_and_runs_nothing(
    fake: Campaigns, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["compare", "--no-oracle"])
    shown = capsys.readouterr().out
    assert main(["compare", "--results"]) == 0
    assert capsys.readouterr().out == shown
    assert len(fake.requests) == 2


def test_results_of_an_older_campaign_without_an_oracle_are_not_shown(
    fake: Campaigns, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["compare", "--no-oracle"])
    main(["compare"])
    capsys.readouterr()
    assert main(["compare", "--results"]) == 0
    assert "without an oracle" not in capsys.readouterr().out


def test_results_without_a_comparison_are_2_and_name_the_command(
    fake: Campaigns, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["run"])
    assert main(["compare", "--results"]) == 2
    assert "`mutabot compare`" in capsys.readouterr().err


def test_results_of_compare_and_of_run_do_not_replace_each_other(
    fake: Campaigns, project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    samples.write_journal(project / ".mutabot" / "journal.sqlite")
    main(["compare"])
    capsys.readouterr()
    assert main(["results"]) == 0
    assert "5 mutants × 2 rounds" in capsys.readouterr().out


def test_json_goes_alone_to_standard_output(fake: Campaigns, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", "--json", "--no-oracle"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert [one["family"] for one in data["families"]] == ["robot", "robot", "classical", "text"]
    assert data["families"][0]["without_oracle"] is not None


def test_a_picture_is_written_beside_the_table(fake: Campaigns, project: Path) -> None:
    assert main(["compare", "--picture", "ends.svg"]) == 0
    assert (project / "ends.svg").read_text(encoding="utf-8").startswith("<svg")
    (project / "ends.svg").unlink()
    assert main(["compare", "--results", "--picture", "ends.SVG"]) == 0
    assert (project / "ends.SVG").exists()


def test_an_interrupted_comparison_says_where_to_look(
    fake: Campaigns, capsys: pytest.CaptureFixture[str]
) -> None:
    fake.error = KeyboardInterrupt()
    assert main(["compare"]) == 130
    assert "mutabot compare --results" in capsys.readouterr().err


def test_a_comparison_in_which_nothing_is_valid_is_3(
    fake: Campaigns, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    refused = tuple(Outcome(one.id, 0, Verdict.REFUSED) for one in campaigns.mutants())
    monkeypatch.setattr(campaigns, "outcomes", lambda **details: refused)
    assert main(["compare"]) == 3
    assert "refused every mutant" in capsys.readouterr().err


def test_help_names_the_families(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", "--help"]) == 0
    text = capsys.readouterr().out
    assert "--no-oracle" in text
    assert "classical" in text
