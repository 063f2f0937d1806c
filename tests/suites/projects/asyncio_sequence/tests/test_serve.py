import mission
import pytest
from robot import Waiter


@pytest.mark.parametrize("tables, served", [([1, 2], [1, 2]), ([2, 4, 6], [2, 4])])
def test_served(tables, served):
    assert mission.main(Waiter(), tables) == served


def test_comes_home():
    waiter = Waiter()
    mission.main(waiter, [3])
    assert waiter.at == 0.0
    assert waiter.visits[0] == 4.5
