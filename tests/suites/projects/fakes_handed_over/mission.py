import asyncio
import copy
import pickle
import weakref
from functools import partial
from threading import Thread

from robot import beep


def shift(arm, places):
    go = arm.move
    go(0.25)
    slowly = partial(arm.move, speed=0.1)
    slowly(0.5)
    for step in map(arm.move, places):
        assert step is None
    words = {"on": arm.light, "off": arm.light}
    copy.deepcopy({"of": 1.0, "go": words["on"]})
    words["on"](True)
    getattr(arm, words["off"].__name__)(False)


def at_once(arm, pool):
    done = pool.submit(arm.move, 0.75)
    again = arm.light
    later = Thread(target=again, kwargs={"on": False})
    done.result()
    later.start()
    later.join()


def signal(pool):
    say = beep
    say(440.0)
    pool.submit(beep, 880.0).result()


class Button:
    """Presses are told to who listens, if it is still there."""

    def __init__(self, arm):
        self.arm = arm
        self.listener = weakref.WeakMethod(arm.light)
        self.name = arm.light.__name__

    def press(self):
        self.listener()
        action = self.arm.light
        action(True)
        return pickle.loads(pickle.dumps(self.arm.move)).__name__


async def together(arm):
    first = asyncio.create_task(arm.place(0.1))
    then = arm.place
    assert asyncio.iscoroutinefunction(then)
    await asyncio.gather(first, then(0.2))
