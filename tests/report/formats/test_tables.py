"""CSV and Parquet hold the same table, whatever its texts are."""

from __future__ import annotations

import csv
import io
import sys
from pathlib import Path

import pytest

import mutabot
from analysis import samples
from mutabot.analysis.stored.table import COLUMNS, rows
from mutabot.errors import UsageError
from mutabot.report.choice import format_of
from mutabot.report.format import Material
from mutabot.report.shaping.portable import portable
from report.material import HOSTILE, made, stored, with_text

parquet = pytest.importorskip("pyarrow.parquet", reason="requirements-reports.lock is not installed")


def read_csv(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text, newline="")))


def packed(campaign: mutabot.StoredCampaign) -> bytes:
    data = format_of("parquet").make(Material(portable(campaign)))
    assert isinstance(data, bytes)
    return data


@pytest.mark.parametrize("text", HOSTILE)
def test_every_cell_comes_back_from_both(tmp_path: Path, text: str) -> None:
    campaign = with_text(stored(tmp_path), text)
    wanted = [list(row) for row in rows(portable(campaign).results)]
    found = parquet.read_table(io.BytesIO(packed(campaign))).to_pylist()
    assert [list(row.values()) for row in found] == wanted
    lines = read_csv(made("csv", campaign))
    assert [list(line.values()) for line in lines] == [
        ["" if cell is None else str(cell) for cell in row] for row in wanted
    ]


def test_there_is_a_row_per_outcome_under_the_names_of_the_columns(tmp_path: Path) -> None:
    lines = read_csv(made("csv", stored(tmp_path)))
    assert len(lines) == len(samples.OUTCOMES)
    assert list(lines[0]) == [column.name for column in COLUMNS]


def test_parquet_has_types_meanings_and_how_the_campaign_ended(tmp_path: Path) -> None:
    table = parquet.read_table(io.BytesIO(packed(stored(tmp_path, finish="interrupted"))))
    types = {str: "string", int: "int64", float: "double", bool: "bool"}
    assert [str(field.type) for field in table.schema] == [types[column.kind] for column in COLUMNS]
    assert table.schema.field("wall_s").metadata[b"meaning"].startswith(b"seconds")
    assert table.schema.metadata[b"mutabot.state"] == b"interrupted"


def test_a_campaign_without_outcomes_has_the_columns(tmp_path: Path) -> None:
    campaign = stored(tmp_path, outcomes=())
    table = parquet.read_table(io.BytesIO(packed(campaign)))
    assert (table.num_rows, table.num_columns) == (0, len(COLUMNS))
    assert made("csv", campaign).splitlines() == [",".join(column.name for column in COLUMNS)]


def test_without_pyarrow_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(UsageError, match=r"parquet needs pyarrow, .*pip install 'mutabot\[notebook\]'"):
        packed(stored(tmp_path))
