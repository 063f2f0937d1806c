import asyncio


class Refused(Exception):
    """The arm says no."""


class Arm:
    def __init__(self, low, high):
        self.low, self.high = low, high
        self.at = 0.0
        self.closed = False

    async def extend(self, distance):
        await asyncio.sleep(0)
        if not self.low <= self.at + distance <= self.high:
            raise Refused(f"{self.at + distance:.2f} is out of reach")
        self.at += distance

    async def retract(self, distance):
        await asyncio.sleep(0)
        self.at -= distance

    async def grip(self, closed):
        self.closed = closed
