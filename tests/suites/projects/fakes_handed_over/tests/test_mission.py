import asyncio
import threading
from concurrent.futures import ThreadPoolExecutor

import mission
import pytest
from robot import Arm


class FakeArm(Arm):
    def __init__(self):
        self.log, self.threads = [], []

    def move(self, x, speed=1.0):
        self.log.append((x, speed))
        self.threads.append(threading.current_thread() is threading.main_thread())

    def light(self, on):
        self.log.append(on)

    async def place(self, x):
        self.log.append(x)

    def __deepcopy__(self, known):
        return self


@pytest.fixture
def pool():
    with ThreadPoolExecutor(1) as made:
        yield made


def test_it_goes_everywhere():
    arm = FakeArm()
    mission.shift(arm, [0.1, 0.2])
    assert arm.log == [(0.25, 1.0), (0.5, 0.1), (0.1, 1.0), (0.2, 1.0), True, False]


def test_all_at_once(pool):
    arm = FakeArm()
    mission.at_once(arm, pool)
    assert arm.log[0] == (0.75, 1.0)
    assert arm.threads == [False]


def test_it_goes_dark_at_last(pool):
    arm = FakeArm()
    mission.at_once(arm, pool)
    assert arm.log[-1] is False


def test_it_signals(pool, monkeypatch):
    told = []
    monkeypatch.setattr(mission, "beep", lambda pitch: told.append(pitch))
    mission.signal(pool)
    assert told == [440.0, 880.0]


def test_the_button():
    arm = FakeArm()
    button = mission.Button(arm)
    assert button.press() == "move"
    assert (button.name, arm.log) == ("light", [True])


def test_together():
    arm = FakeArm()
    asyncio.run(mission.together(arm))
    assert sorted(arm.log) == [0.1, 0.2]
