"""The table of outcomes: its columns are stable and documented, and every cell has its type."""

from __future__ import annotations

import math
import re
import sys
from pathlib import Path

import pytest

import mutabot
from mutabot.errors import UsageError
from mutabot.model import Outcome, Verdict
from mutabot.results.stored import COLUMNS, rows
from results import samples

pandas = pytest.importorskip("pandas", reason="requirements-reports.lock is not installed")

PAGE = Path(__file__).parents[3] / "docs" / "reports.md"


@pytest.fixture
def campaign(tmp_path: Path) -> mutabot.StoredCampaign:
    return mutabot.open(samples.write_journal(tmp_path / "journal.sqlite"))


def test_there_is_a_row_for_every_outcome(campaign: mutabot.StoredCampaign) -> None:
    frame = campaign.frame()
    assert len(frame) == len(samples.OUTCOMES)
    first = frame.iloc[0]
    assert (first.mutant, first["round"], first.verdict, first.by) == (
        samples.REVERSE.id,
        1,
        "killed",
        "check",
    )
    assert (first.line, first.column, first.before, first.after, first.unit) == (3, 5, "0.2", "-0.2", "m")
    assert (first.wall_s, first.killed, first.valid) == (1.5, True, True)
    assert set(frame[frame.killed].verdict) == {"killed", "timeout"}


def test_what_is_not_known_is_missing_and_every_column_has_a_type(campaign: mutabot.StoredCampaign) -> None:
    frame = campaign.frame()
    assert pandas.isna(frame.distance[0])
    types = {str: "string", int: "Int64", float: "Float64", bool: "boolean"}
    assert {name: str(kind) for name, kind in frame.dtypes.items()} == {
        name: types[kind] for name, kind in COLUMNS.items()
    }


def test_a_campaign_without_outcomes_is_a_table_without_rows(tmp_path: Path) -> None:
    campaign = mutabot.open(samples.write_journal(tmp_path / "journal.sqlite", outcomes=()))
    assert (len(campaign.frame()), len(campaign.frame().columns)) == (0, len(COLUMNS))


def test_a_number_that_is_none_is_missing(tmp_path: Path) -> None:
    odd = Outcome(
        samples.SKIP.id, 0, Verdict.SURVIVED, distance=math.inf, way=math.nan, example=(math.nan, [1])
    )
    campaign = mutabot.open(samples.write_journal(tmp_path / "journal.sqlite", outcomes=(odd,)))
    (row,) = rows(campaign)
    found = dict(zip(COLUMNS, row, strict=True))
    assert (found["distance"], found["way"], found["before"], found["after"]) == (None, None, None, "[1]")


def test_without_pandas_it_says_what_to_install(
    campaign: mutabot.StoredCampaign, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(UsageError, match=r"needs pandas, .*pip install 'path/to/mutabot\[notebook\]'"):
        campaign.frame()


def test_the_page_has_the_columns_in_their_order() -> None:
    text = PAGE.read_text(encoding="utf-8").partition("## The table")[2]
    names = {str: "text", int: "whole number", float: "number", bool: "truth value"}
    told = re.findall(r"^\| `(\w+)` \| ([\w ]+) \| .+ \|$", text, re.MULTILINE)
    assert told == [(name, names[kind]) for name, kind in COLUMNS.items()]
