"""The table of outcomes: its columns are stable and documented."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

import mutabot
from mutabot.model import Outcome, Verdict
from mutabot.results.stored import COLUMNS
from results import samples

PAGE = Path(__file__).parents[3] / "docs" / "reports.md"


@pytest.fixture
def campaign(tmp_path: Path) -> mutabot.StoredCampaign:
    return mutabot.open(samples.write_journal(tmp_path / "journal.sqlite"))


def test_there_is_a_row_for_every_outcome(campaign: mutabot.StoredCampaign) -> None:
    rows = campaign.rows()
    assert len(rows) == len(samples.OUTCOMES)
    first = rows[0]
    assert (first["mutant"], first["round"], first["verdict"], first["by"]) == (
        samples.REVERSE.id,
        1,
        "killed",
        "check",
    )
    assert [first[name] for name in ("line", "column", "before", "after", "unit")] == [
        3,
        5,
        "0.2",
        "-0.2",
        "m",
    ]
    assert (first["wall_s"], first["killed"], first["valid"]) == (1.5, True, True)
    assert {row["verdict"] for row in rows if row["killed"]} == {"killed", "timeout"}
    assert all(tuple(row) == COLUMNS for row in rows)


def test_pandas_takes_the_rows(campaign: mutabot.StoredCampaign) -> None:
    pandas = pytest.importorskip("pandas", reason="requirements-reports.lock is not installed")
    frame = pandas.DataFrame(campaign.rows())
    assert pandas.isna(frame.distance[0])
    assert set(frame[frame.killed].verdict) == {"killed", "timeout"}


def test_a_campaign_without_outcomes_is_a_table_without_rows(tmp_path: Path) -> None:
    campaign = mutabot.open(samples.write_journal(tmp_path / "journal.sqlite", outcomes=()))
    assert campaign.rows() == []


def test_a_number_that_is_none_is_missing(tmp_path: Path) -> None:
    odd = Outcome(
        samples.SKIP.id, 0, Verdict.SURVIVED, distance=math.inf, way=math.nan, example=(math.nan, [1])
    )
    campaign = mutabot.open(samples.write_journal(tmp_path / "journal.sqlite", outcomes=(odd,)))
    (row,) = campaign.rows()
    assert (row["distance"], row["way"], row["before"], row["after"]) == (None, None, "nan", "[1]")


def test_the_page_has_the_columns_in_their_order() -> None:
    text = PAGE.read_text(encoding="utf-8").partition("## The table")[2]
    cells = re.findall(r"^\| (`.+?`) \| ", text, re.MULTILINE)
    assert tuple(name for cell in cells for name in re.findall(r"`(\w+)`", cell)) == COLUMNS
