"""CSV holds the table, whatever its texts are."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest

from mutabot.report.texts import portable
from mutabot.results.stored import COLUMNS, rows
from report.material import HOSTILE, made, stored, with_text
from results import samples


def read_csv(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text, newline="")))


@pytest.mark.parametrize("text", HOSTILE)
def test_every_cell_comes_back(tmp_path: Path, text: str) -> None:
    campaign = with_text(stored(tmp_path), text)
    wanted = [list(row.values()) for row in rows(portable(campaign))]
    lines = read_csv(made("csv", campaign))
    assert [list(line.values()) for line in lines] == [
        ["" if cell is None else str(cell) for cell in row] for row in wanted
    ]


def test_there_is_a_row_per_outcome_under_the_names_of_the_columns(tmp_path: Path) -> None:
    lines = read_csv(made("csv", stored(tmp_path)))
    assert len(lines) == len(samples.OUTCOMES)
    assert list(lines[0]) == [*COLUMNS]


def test_a_campaign_without_outcomes_has_the_columns(tmp_path: Path) -> None:
    campaign = stored(tmp_path, outcomes=())
    assert made("csv", campaign).splitlines() == [",".join(COLUMNS)]
