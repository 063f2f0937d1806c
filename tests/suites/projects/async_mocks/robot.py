import asyncio


class Arm:
    def __init__(self, host):
        self.host = host

    async def move_by(self, dx):
        await asyncio.open_connection(self.host, 30001)

    async def position(self):
        await asyncio.open_connection(self.host, 30001)

    async def stop(self):
        await asyncio.open_connection(self.host, 30001)
