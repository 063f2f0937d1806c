"""UFACTORY's controller: the private Modbus TCP that xarm-python-sdk speaks. Its arm is there at once."""

from __future__ import annotations

import socket
import struct
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import IntEnum

from tests.packages.hardware.vendors.controller import ADDRESS, Controller, Vendor, exactly, listening

#: where the state is reported; the port for control, 502, is the system's, so that another one is used
REPORT = 30001
#: registers of the protocol that move the arm
MOTIONS = {21: "move_line", 22: "move_lineb", 23: "move_joint", 25: "move_home", 28: "move_line_tool"}
_VERSION_TEXT = b"6,6,XI1302060001,AC1302060001,v1.11.0"


class _Register(IntEnum):
    """Some of those that are read."""

    HEARTBEAT, VERSION, SERIAL, STATE, POSE = 0, 1, 2, 13, 41


@dataclass
class XarmController(Controller):
    """The controller; ``pose``: of its tool, mm and rad."""

    pose: tuple[float, ...] = field(default=(300.0, 0.0, 400.0, 3.14, 0.0, 0.0))

    def control(self, connection: socket.socket) -> None:
        """Answer requests: transaction, protocol, length, register, and data."""
        while True:
            transaction, protocol, length = struct.unpack("!HHH", exactly(connection, 6))
            register, *data = exactly(connection, length)
            if register == _Register.HEARTBEAT:
                continue
            answer = b"\0" + self._answer(register, bytes(data))
            connection.sendall(
                struct.pack("!HHHB", transaction, protocol, len(answer) + 1, register) + answer
            )

    def report(self, connection: socket.socket) -> None:
        """Report the state again and again: a size, state and mode, joints, pose, torques, and settings."""
        while True:
            parts = struct.pack("!IBH", 145, 2, 0) + struct.pack("<20f", *[0.0] * 7, *self.pose, *[0.0] * 7)
            connection.sendall(parts.ljust(145, b"\0"))
            time.sleep(0.02)

    def _answer(self, register: int, data: bytes) -> bytes:
        match register:
            case _Register.VERSION | _Register.SERIAL:
                return _VERSION_TEXT.ljust(40, b"\0")
            case _Register.STATE:
                return b"\x02"  # it is ready
            case _Register.POSE:
                return struct.pack("<6f", *self.pose)
        if register in MOTIONS:
            numbers = struct.unpack("<6f", data[:24])
            self.note(MOTIONS[register], *numbers)
            self.pose = numbers
        return bytes(40)


@contextmanager
def serve() -> Iterator[Controller]:
    controller = XarmController()
    with listening(controller.control, controller.report, ports=(0, REPORT)) as ports:
        controller.address = f"{ADDRESS}:{ports[0]}"
        yield controller


XARM = Vendor(
    packages=("xarm",),
    serve=serve,
    program="""
        def place(arm, x, y, z):
            arm.set_position(x, -y, z + 100.0, 180.0, 0.0, 0.0, speed=50.0)
        """,
    tests="""
        import os

        import program
        import pytest
        from xarm.core.config.x_config import XCONF
        from xarm.wrapper import XArmAPI

        def test_it_is_placed():
            host, _, port = os.environ["CONTROLLER"].partition(":")
            XCONF.SocketConf.TCP_CONTROL_PORT = int(port)
            arm = XArmAPI(host, report_type="normal")
            try:
                arm.motion_enable(enable=True)
                arm.set_mode(0)
                arm.set_state(0)
                program.place(arm, 400.0, 250.0, 150.0)
                code, pose = arm.get_position()
                assert code == 0
                assert pose == pytest.approx([400.0, -250.0, 250.0, 180.0, 0.0, 0.0], abs=0.01)
            finally:
                arm.disconnect()
        """,
    vocabulary="""
        [[operation]]
        call = "xarm.wrapper.xarm_api:XArmAPI.set_state"
        arguments.state = { kind = "count" }
        """,
    shipped=("xarm",),
    guard="""
        [guard]
        box = [{ x = [0.2, 0.5], y = [-0.3, 0.3], z = [0.1, 0.6], frame = "base" }]
        """,
    moving="move_line",
    least=(200.0, -300.0, 100.0, -9.0, -9.0, -9.0),
    greatest=(500.0, 300.0, 600.0, 9.0, 9.0, 9.0),
    operation="xarm.wrapper.xarm_api:XArmAPI.set_position",
    unreadable="arm.move_circle([900.0, 0.0, 0.0, 180.0, 0.0, 0.0], [0.0, 0.0, 900.0, 180.0, 0.0, 0.0], 50)",
    said="the vocabulary describes none of its arguments",
)
