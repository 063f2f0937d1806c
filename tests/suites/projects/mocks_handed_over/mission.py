import asyncio
from functools import partial
from threading import Thread


def shift(arm, places):
    go = arm.move
    go(0.25)
    slowly = partial(arm.move, speed=0.1)
    slowly(x=0.5)
    list(map(arm.move, places))
    words = {"on": arm.light, "off": arm.light}
    words["on"](True)
    getattr(arm, "light")(on=False)


def at_once(arm, pool):
    done = pool.submit(arm.move, 0.75)
    side = Thread(target=arm.light, args=(True,))
    done.result()
    side.start()
    side.join()
    again = arm.light
    later = Thread(target=again, kwargs={"on": False})
    later.start()
    later.join()


class Panel:
    """Knows what its button does."""

    def __init__(self, arm):
        self.arm = arm
        self.on_press = arm.move
        self.on_release = [arm.light]

    def press(self, button):
        button.when_pressed(self.on_press, 1.0)
        self.on_release[0](False)

    def is_moving(self, action):
        return action is self.arm.move or action == self.arm.light


async def together(arm):
    first = asyncio.create_task(arm.place(0.1))
    then = arm.place
    await asyncio.gather(first, then(0.2))


def watch(arm, loop):
    loop.call_soon(arm.move, 0.3)
    loop.call_soon(arm.light, True)
