import sqlite3

import mission
import pytest
from robot import Arm


@pytest.fixture
def journal(tmp_path):
    return tmp_path / "moves.db"


def read(journal):
    database = sqlite3.connect(journal)
    try:
        return list(database.execute("select name, x from moves order by rowid"))
    finally:
        database.close()


def test_both_moves_are_noted(journal):
    mission.palletize(Arm(), journal)
    assert [name for name, _ in read(journal)] == ["pick", "place"]


def test_pick_position(journal):
    mission.palletize(Arm(), journal)
    assert read(journal)[0] == ("pick", 0.2)
