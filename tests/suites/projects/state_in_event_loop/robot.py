import asyncio


class Arm:
    def __init__(self):
        self.z = 0.0
        self.angle = 0.0

    async def lift(self, dz):
        await asyncio.sleep(0)
        self.z = round(self.z + dz, 6)

    def turn(self, angle):
        asyncio.get_running_loop().call_later(0.01, self._turned, angle)

    def _turned(self, angle):
        self.angle += angle
