import csv

import mission
import pytest
from robot import Probe


def rows(path):
    with path.open() as file:
        return [(float(row["x"]), float(row["z"])) for row in csv.DictReader(file)]


def test_three_rows(tmp_path):
    mission.measure(Probe(), tmp_path / "out.csv")
    assert len(rows(tmp_path / "out.csv")) == 3


def test_last_row(tmp_path):
    mission.measure(Probe(), tmp_path / "out.csv")
    assert rows(tmp_path / "out.csv")[-1] == (1.5, 0.375)


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    path = tmp_path_factory.mktemp("tables") / "all.csv"
    mission.measure(Probe(), path)
    return path


def test_table_is_there(table):
    assert table.exists()


def test_table_rises(table):
    heights = [z for _, z in rows(table)]
    assert heights == sorted(heights)
