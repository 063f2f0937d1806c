"""Modbus TCP: pymodbus' client, and its own server as the controller of a lift."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from tests.packages.hardware.vendors.controller import ADDRESS, Controller, Vendor

#: holding registers
HEIGHT, SPEED, OTHER, DONE = 100, 101, 110, 120
WRITES = {5: "coil", 6: "register", 15: "coils", 16: "registers"}


@contextmanager
def serve() -> Iterator[Controller]:
    from pymodbus.server import ModbusTcpServer  # noqa: PLC0415  # it may be missing
    from pymodbus.simulator import DataType, SimData, SimDevice  # noqa: PLC0415

    controller = Controller()
    is_ready, loop = threading.Event(), asyncio.new_event_loop()

    async def note(
        function: int, start: int, address: int, count: int, now: list[int], asked: list[int] | None
    ) -> None:
        if asked is not None:
            controller.note(f"{WRITES[function]} {address}", *map(float, asked))

    async def run() -> None:
        block = [SimData(HEIGHT, values=0, count=60, datatype=DataType.REGISTERS)]
        server = ModbusTcpServer(SimDevice(id=1, simdata=block, action=note), address=(ADDRESS, 0))
        await server.serve_forever(background=True)
        controller.address = f"{ADDRESS}:{server.transport.sockets[0].getsockname()[1]}"
        is_ready.set()
        await over.wait()
        await server.shutdown()

    over = asyncio.Event()
    thread = threading.Thread(target=loop.run_until_complete, args=(run(),))
    thread.start()
    assert is_ready.wait(30.0)
    try:
        yield controller
    finally:
        loop.call_soon_threadsafe(over.set)
        thread.join()
        loop.close()


MODBUS = Vendor(
    packages=("pymodbus",),
    serve=serve,
    program="""
        def lift(client, height, speed):
            client.write_register(101, speed, device_id=1)
            client.write_register(100, height - 50, device_id=1)

        def read(client):
            return client.read_holding_registers(100, count=1, device_id=1).registers[0]
        """,
    tests="""
        import os

        import program
        from pymodbus.client import ModbusTcpClient

        def test_it_is_lifted():
            host, _, port = os.environ["CONTROLLER"].partition(":")
            with ModbusTcpClient(host, port=int(port)) as client:
                program.lift(client, 450, 80)
                assert program.read(client) == 400
        """,
    vocabulary="""
        [[operation]]
        call = "pymodbus.client.mixin:ModbusClientMixin.write_register"
        message = "address"
        patterns = [
          { text = "100", arguments.value = { kind = "translation", axis = "z", unit = "mm", mode = "to" } },
          { text = "101", arguments.value = { kind = "speed", unit = "mm/s", range = [0, 250] } },
        ]
        """,
    guard="""
        [guard]
        box = [{ z = [0.1, 0.41] }]
        limit = [{ kind = "speed", max = 0.1, unit = "m/s" }]
        """,
    moving="register 100",
    least=(100.0,),
    greatest=(410.0,),
    operation="pymodbus.client.mixin:ModbusClientMixin.write_register",
    unreadable="client.write_register(110, 7, device_id=1)",
    said="it is none of the commands that the vocabulary describes",
)
