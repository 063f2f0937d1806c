"""OPC UA: asyncua's client, and its own server as the controller of a lift."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from tests.packages.hardware.vendors.controller import ADDRESS, Controller, Vendor

NODES = ("Lift.Height", "Lift.Speed", "Lift.Other")


@contextmanager
def serve() -> Iterator[Controller]:
    from asyncua import ua  # noqa: PLC0415  # it may be missing
    from asyncua.common.callback import CallbackType  # noqa: PLC0415
    from asyncua.sync import Server  # noqa: PLC0415

    logging.getLogger("asyncua").setLevel(logging.ERROR)
    controller = Controller(f"opc.tcp://{ADDRESS}:4840/cell")

    def note(event: Any, service: Any) -> None:
        if event.is_external:
            for node in event.request_params.NodesToWrite:
                controller.note(f"write {node.NodeId.Identifier}", float(node.Value.Value.Value))

    server = Server()
    server.set_endpoint(controller.address)
    server.register_namespace("cell")
    lift = server.nodes.objects.add_object(ua.NodeId("Lift", 2), "2:Lift")
    for name in NODES:
        lift.add_variable(ua.NodeId(name, 2), f"2:{name}", 0.0).set_writable()
    server.aio_obj.subscribe_server_callback(CallbackType.PreWrite, note)
    server.start()
    try:
        yield controller
    finally:
        server.stop()


OPCUA = Vendor(
    packages=("asyncua",),
    serve=serve,
    program="""
        async def lift(client, height, speed):
            await client.get_node("ns=2;s=Lift.Speed").write_value(speed)
            await client.get_node("ns=2;s=Lift.Height").write_value(height - 0.1)
        """,
    tests="""
        import asyncio
        import logging
        import os

        import program
        from asyncua import Client

        logging.getLogger("asyncua").setLevel(logging.ERROR)

        def test_it_is_lifted():
            async def run():
                async with Client(os.environ["CONTROLLER"]) as client:
                    await program.lift(client, 0.45, 0.08)
                    return await client.get_node("ns=2;s=Lift.Height").read_value()

            assert asyncio.run(run()) == 0.35
        """,
    vocabulary="""
        [[operation]]
        call = "asyncua.common.node:Node.write_value"
        message = "self"
        patterns = [
          { text = "ns=2;s=Lift.Height", arguments.value = { kind = "translation", axis = "z", unit = "m", mode = "to" } },
          { text = "ns=2;s=Lift.Speed", arguments.value = { kind = "speed", unit = "m/s", range = [0, 0.25] } },
        ]
        """,  # noqa: E501
    guard="""
        [guard]
        box = [{ z = [0.1, 0.41] }]
        limit = [{ kind = "speed", max = 0.1, unit = "m/s" }]
        """,
    moving="write Lift.Height",
    least=(0.1,),
    greatest=(0.41,),
    operation="asyncua.common.node:Node.write_value",
    unreadable='await client.get_node("ns=2;s=Lift.Other").write_value(0.3)',
    said="it is none of the commands that the vocabulary describes",
)
