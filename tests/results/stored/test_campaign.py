"""Campaigns as programs read them: ``mutabot.open``."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import mutabot
from mutabot.errors import JournalError, SelectionError
from mutabot.journal.records import Reaching
from mutabot.model.codec import to_data
from mutabot.results.stored import StoredCampaign
from results import samples


@pytest.fixture
def project(tmp_path: Path) -> Path:
    reaching = Reaching((samples.TEST, "tests/test_b.py::test_b"), {samples.MOVE.id: (0, 1)})
    samples.write_journal(
        tmp_path / ".mutabot" / "journal.sqlite",
        operators={"reverse": "The other way."},
        reaching=to_data(reaching),
    )
    return tmp_path


@pytest.mark.parametrize("place", ["", "tests", ".mutabot/journal.sqlite"])
def test_a_project_a_folder_in_it_and_a_journal_give_the_same_campaign(project: Path, place: str) -> None:
    (project / "tests").mkdir()
    assert mutabot.open(project / place).outcomes == mutabot.open(str(project)).outcomes


def test_a_campaign_has_its_mutants_outcomes_and_scores(project: Path) -> None:
    campaign = mutabot.open(project)
    assert isinstance(campaign, StoredCampaign)
    assert [result.mutant for result in campaign.mutants] == list(samples.MUTANTS)
    assert campaign.outcomes == samples.OUTCOMES
    assert [(score.family, score.role) for score in campaign.scores] == [
        ("robot", "program"),
        ("robot", "oracle"),
    ]
    assert (campaign.state, campaign.is_complete, campaign.rounds) == ("complete", True, 2)
    assert campaign.meta["seed"] == 7
    assert [survivor.mutant.number for survivor in campaign.survivors] == [2, 5, 4]


def test_one_mutant_is_found_by_number_or_a_part_of_its_id(project: Path) -> None:
    campaign = mutabot.open(project)
    assert campaign.mutant("2") == campaign.mutant("gripper.command") == campaign.mutants[1]
    with pytest.raises(SelectionError, match="mutants are between 1 and 5"):
        campaign.mutant("6")


def test_sources_operators_and_reaching_tests_are_those_of_the_campaign(project: Path) -> None:
    campaign = mutabot.open(project)
    assert campaign.source("mission.py") == samples.PROGRAM
    assert campaign.source("other.py") is None
    assert campaign.operators == {"reverse": "The other way."}
    assert campaign.reached_by(samples.REVERSE) == (samples.TEST, "tests/test_b.py::test_b")
    assert campaign.reached_by(samples.SKIP) == ()


def test_a_journal_of_before_there_were_such_facts_can_be_read(tmp_path: Path) -> None:
    campaign = mutabot.open(samples.write_journal(tmp_path / "journal.sqlite"))
    assert (campaign.operators, campaign.reached_by(samples.REVERSE)) == ({}, ())


def test_an_interrupted_campaign_says_so(tmp_path: Path) -> None:
    path = samples.write_journal(tmp_path / "j.sqlite", outcomes=samples.OUTCOMES[:3], finish="interrupted")
    campaign = mutabot.open(path)
    assert (campaign.state, campaign.is_complete, len(campaign.outcomes)) == ("interrupted", False, 3)


def test_a_folder_without_a_journal_is_an_error_that_names_the_file(tmp_path: Path) -> None:
    with pytest.raises(JournalError, match=r"journal\.sqlite: there is no journal yet"):
        mutabot.open(tmp_path)


def test_importing_the_package_loads_only_what_loads_its_names_later() -> None:
    code = "import sys, mutabot; print(sorted(name for name in sys.modules if name.startswith('mutabot.')))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "['mutabot.lazy']"


def test_opening_a_campaign_loads_neither_pandas_nor_what_runs_one(project: Path) -> None:
    code = "import sys, mutabot; mutabot.open(sys.argv[1]); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code, project], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.split())
    assert "mutabot.results.results" in loaded
    assert not loaded & {"pandas", "pyarrow", "numpy", "libcst", "mutabot.campaign", "mutabot.operators"}


def test_a_notebook_shows_scores_and_survivors_and_no_more(tmp_path: Path) -> None:
    accepted = {"mutants": {samples.NEGATE.id: {"why": "x", "source": "a.toml:1"}}}
    campaign = mutabot.open(samples.write_journal(tmp_path / "journal.sqlite", accepted=accepted))
    text = campaign._repr_html_()
    assert len(text) < 5_000
    assert "robot · program" in text
    assert "gripper.command: do nothing" in text
    assert samples.NEGATE.description not in text
    counts = "1 killed, 1 survived, 1 timeout, 1 accepted, 1 not covered"
    assert repr(campaign) == f"<campaign, complete: 5 mutants × 2 rounds: {counts}>"
    assert repr(campaign.mutant("2")) == "<mutant 2, survived: mission.py:2 gripper.command: do nothing>"


def test_texts_of_programs_are_texts_in_a_notebook(tmp_path: Path) -> None:
    hostile = replace(samples.SKIP, description="<script>alert(1)</script>")
    mutants = tuple(hostile if mutant is samples.SKIP else mutant for mutant in samples.MUTANTS)
    text = mutabot.open(samples.write_journal(tmp_path / "j.sqlite", mutants=mutants))._repr_html_()
    assert "<script>" not in text
    assert "&lt;script&gt;" in text
