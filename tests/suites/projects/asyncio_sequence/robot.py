import asyncio


class Waiter:
    def __init__(self, load=2):
        self.at = 0.0
        self.load = load
        self.visits = []

    async def go(self, metres):
        await asyncio.sleep(0)
        self.at = metres
        self.visits.append(metres)

    async def weigh(self):
        return float(self.load)

    async def put_down(self):
        await asyncio.sleep(0)
        self.load -= 1
