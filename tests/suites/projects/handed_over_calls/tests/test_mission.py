from concurrent.futures import ThreadPoolExecutor

import mission
import pytest
from robot import Cell


@pytest.fixture
def pool():
    with ThreadPoolExecutor(1) as made:
        yield made


def test_goes_through_all_places(pool):
    cell = Cell()
    mission.shift(cell, pool, [0.5, 0.75])
    assert [x for word, x in cell.done if word == "move"] == [0.25, 0.5, 0.75, 0.0]


def test_lights_up_first(pool):
    cell = Cell()
    mission.shift(cell, pool, [])
    assert cell.done[0] == ("light", True)


class Busy(Cell):
    def ready(self):
        return False


def test_asks_no_more_than_it_needs():
    cell = Busy()
    mission.shift(cell, None, [1.0])
    assert len(cell.done) == 5
