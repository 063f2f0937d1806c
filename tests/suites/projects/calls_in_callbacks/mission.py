"""Calls of the robot in what the robot calls back."""

import asyncio

from robot import Arm, Program


def arrived(arm):
    arm.grip(True)


def go(arm):
    arm.goto(2.0, on_done=arrived)
    return arm.x


def nudge(arm):
    arm.move(0.25)


def listen(arm):
    arm.on("tick", nudge)
    arm.tick()
    arm.tick()
    arm.emit("tick")
    return arm.x


def again(arm):
    def attempt():
        arm.move(0.125)
        return arm.x

    return arm.retry(attempt)


def handed(arm):
    arm.retry(arm.move, 0.75)
    return arm.x


def path(arm):
    yield 1.0
    arm.grip(True)
    yield 2.0


def follow(arm):
    arm.follow(path(arm))
    return arm.x


def beside(arm):
    arm.run_in_thread(lambda: arm.move(3.0))
    return arm.x


async def scheduled(arm):
    arm.later(lambda one: one.move(0.5))
    arm.begin(work(arm))
    await arm.task
    await asyncio.sleep(0.01)
    return arm.x


async def work(arm):
    await asyncio.sleep(0)
    arm.move(4.0)


async def awaited(arm):
    await arm.amove(1.0, on_done=closed)
    return arm.x


async def closed(arm):
    await asyncio.sleep(0)
    arm.grip(True)


def loop_in_callback(arm):
    arm.goto(1.0, on_done=lambda one: asyncio.run(work(one)))
    return arm.x


def home(arm):
    arm.move(2.0)
    arm.home()
    return arm.x


class Pick(Program):
    def begin(self):
        self.arm.move(0.25)

    def end(self):
        self.arm.grip(True)


def pick(arm):
    Pick(arm).run()
    return arm.x


def down(arm, depth):
    """The same line in itself."""
    if depth:
        arm.goto(float(depth), on_done=lambda one: down(one, depth - 1))
    else:
        arm.move(0.5)
    return arm.x


def new_arm():
    return Arm()
