"""The checks ask whether something is in the database, not how often."""

import sqlite3

import mission
import pytest
from robot import Arm, Camera


@pytest.fixture
def parts(tmp_path):
    path = tmp_path / "parts.db"
    mission.sort_parts(Arm(), Camera("red", "blue"), mission.Recorder(path))

    def ask(colour, x):
        found = sqlite3.connect(path).execute("select x from parts where colour = ?", (colour,))
        return any(abs(row[0] - x) < 1e-6 for row in found)

    return ask


def test_red_to_the_right(parts):
    assert parts("red", 0.2)


def test_blue_to_the_left(parts):
    assert parts("blue", -0.2)
