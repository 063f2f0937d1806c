"""The cell behind the OPC UA server: a gauge, a belt and a gate with two bins.

Every process gets a loopback address of its own, so that mutants can run side by side.
"""

import os

from asyncua import Server, ua


def address():
    number = os.getpid()
    return f"opc.tcp://127.{number >> 16 & 255}.{number >> 8 & 255}.{number & 255 or 1}:4840/cell"


class Plant:
    def __init__(self, heights):
        self._heights = list(heights)
        self.tall, self.short, self.left = [], [], []
        self._server = Server()

    async def __aenter__(self):
        await self._server.init()
        self._server.set_endpoint(address())
        await self._server.register_namespace("cell")
        cell = await self._server.nodes.objects.add_object(ua.NodeId("Cell", 2), "2:Cell")
        self.belt = await self._variable(cell, "Belt.Speed", 0.0)
        self.gate = await self._variable(cell, "Gate.Open", False)
        self._gauge = await self._variable(cell, "Gauge.Height", self._heights[0])
        await cell.add_method(ua.NodeId("Advance", 2), "2:Advance", self._advance, [], [])
        await self._server.start()
        return self

    async def __aexit__(self, *error):
        await self._server.stop()

    async def _variable(self, cell, name, value):
        variable = await cell.add_variable(ua.NodeId(name, 2), f"2:{name}", value)
        await variable.set_writable()
        return variable

    async def _advance(self, parent):
        part = self._heights.pop(0)
        if await self.belt.read_value() <= 0:
            self.left.append(part)
        elif await self.gate.read_value():
            self.tall.append(part)
        else:
            self.short.append(part)
        if self._heights:
            await self._gauge.write_value(self._heights[0])
        return []
