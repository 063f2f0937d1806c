import asyncio

import mission
from robot import Arm

LOOP = asyncio.new_event_loop()
ARM = Arm()


def test_pick():
    LOOP.run_until_complete(mission.pick(ARM))


def test_height():
    assert ARM.z == 0.15


def test_what_was_planned():
    LOOP.run_until_complete(asyncio.sleep(0.02))
    assert ARM.angle == 30.0
    LOOP.close()
