import random

import mission
import pytest
from robot import Arm, Bin, Scanner


@pytest.mark.parametrize("seed", [1, 2, 5])
def test_holds_a_part(seed):
    bin = Bin(seed)
    arm = Arm(bin)
    assert mission.pick_from_bin(arm, Scanner(bin), tries=8) > 0
    assert abs(arm.x - bin.part) < 0.015


def test_seeded_global_generator():
    random.seed(3)
    bin = Bin(random.randrange(10))
    assert mission.pick_from_bin(Arm(bin), Scanner(bin), tries=8)
