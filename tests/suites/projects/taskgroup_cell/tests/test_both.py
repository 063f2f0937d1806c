import asyncio

import mission
import pytest
from robot import Arm


@pytest.fixture
def arms():
    return Arm(-0.1, 1.0), Arm(-1.0, 0.1)


def test_both_grip(arms):
    asyncio.run(mission.both(*arms))
    assert arms[0].closed
    assert arms[1].closed


def test_left_retracts(arms):
    left, right = arms
    asyncio.run(mission.both(left, right))
    assert left.at == pytest.approx(0.5)


def test_a_narrow_cell():
    with pytest.raises(ExceptionGroup):
        asyncio.run(mission.both(Arm(-0.5, 0.5), Arm(-0.5, 0.5)))
