"""CSV holds the table, whatever its texts are."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest

from mutabot.model import By, Outcome, Verdict
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
    assert [[cell.removeprefix("'") for cell in line.values()] for line in lines] == [
        ["" if cell is None else str(cell) for cell in row] for row in wanted
    ]


FORMULAS = ["=1+1", "+cmd", "-2+3", "@SUM(A1)", "\t=1", "\r=1", "-0.25 m", "\uff1d1"]


@pytest.mark.parametrize("text", FORMULAS)
def test_no_text_is_a_formula_to_a_spreadsheet(tmp_path: Path, text: str) -> None:
    told = Outcome(samples.SKIP.id, 0, Verdict.KILLED, By.CHECK, message=text)
    (line,) = read_csv(made("csv", stored(tmp_path, outcomes=(told,))))
    assert line["message"] == f"'{text}".replace("\r", "\n")


@pytest.mark.parametrize("number", [-0.25, -3, 1e-9, -1e-9])
def test_numbers_stay_numbers(tmp_path: Path, number: float) -> None:
    told = Outcome(
        samples.REVERSE.id, 0, Verdict.KILLED, By.CHECK, message=str(number), example=(number, -number)
    )
    (line,) = read_csv(made("csv", stored(tmp_path, outcomes=(told,))))
    assert [float(line[name]) for name in ("message", "before", "after")] == [number, number, -number]


def test_there_is_a_row_per_outcome_under_the_names_of_the_columns(tmp_path: Path) -> None:
    lines = read_csv(made("csv", stored(tmp_path)))
    assert len(lines) == len(samples.OUTCOMES)
    assert list(lines[0]) == [*COLUMNS]


def test_a_campaign_without_outcomes_has_the_columns(tmp_path: Path) -> None:
    campaign = stored(tmp_path, outcomes=())
    assert made("csv", campaign).splitlines() == [",".join(COLUMNS)]
