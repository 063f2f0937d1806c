"""Does the puck reach its mark, in time, and stay there?"""

from __future__ import annotations

import math

import policy
import pytest
from pushing import FINGER, GOAL, PUCK, Pushing

WITHIN = 0.008
"""What the policy takes for there, and eight standard deviations of its camera, m."""
IN_TIME = 8.0
"""s."""


@pytest.fixture
def table(mutabot_seed: int) -> Pushing:
    """A table whose puck and camera follow the round's seed."""
    return Pushing(seed=mutabot_seed)


def test_the_puck_is_pushed_to_its_mark(table: Pushing) -> None:
    assert policy.run(table)
    assert math.dist(table.puck, GOAL) < WITHIN


def test_it_takes_no_longer_than_it_must(table: Pushing) -> None:
    policy.run(table)
    assert table.time < IN_TIME


def test_the_finger_ends_clear_of_the_puck(table: Pushing) -> None:
    policy.run(table)
    assert math.dist(table.look().finger, table.puck) > PUCK + FINGER + 0.005


def test_the_puck_stays_flat_on_the_table(table: Pushing) -> None:
    policy.run(table)
    assert abs(table.height - 0.01) < 0.002
