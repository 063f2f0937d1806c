import logging

import mission
from robot import Arm


def test_pick_runs():
    mission.pick(Arm())


def test_level():
    assert logging.getLogger("arm").level == 15
